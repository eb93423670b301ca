// SPDX-License-Identifier: Apache-2.0
//
// Combines what the frames of a shot have found at the same point of a surface.
//
// Light at a point of a surface does not depend on the camera, but a frame's estimate of it does:
// each frame guesses what it does not show from what it shows. Frames before and after show other
// parts of the scene, and their guesses err in other ways. So a frame takes the mean,
//
//   value(p) = (own(p) + sum over others of w s(p')) / (1 + sum of w)
//
// s(p') is what another frame has found at the point that p shows, the bilinear average of the
// pixels around it that show the same surface (filters/shot/shot_reprojection.h). All frames count alike, so
// that a frame that comes into reach, or leaves it, changes the mean least. For direct light,
// shares are averaged and not the light, so that the light itself and the shading by normals stay
// those of the frame. Bounce is averaged as it is.
//
// Things move, and light changes with them. w is less where a thing that stands in only one of both
// frames hides light from p (filters/shot/moved_weights.h): for a source if the thing may cast a
// shadow on p, for all other light by its form factor. A surface that moves is looked up where its
// motion layer leads, and its light there is that of its new place (filters/shot/point_tracker.cpp).
// Lamps in the picture are switched on and off: for light that surfaces send, another frame has the
// weight
//
//   sum of min(L, L') / sum of max(L, L')
//
// over points that both frames show; L and L' are what a point radiates in either frame.
//
// Tried and left out: weights by how little of p each frame guesses (RMSE of white ao, K = 8, on
// two shots with moving and still things: 0.073 for 0.067 and 0.119 for 0.117), and surfaces of the
// frames around as known geometry, which costs more than all else here and within the same K frames
// is no nearer to truth (0.091 in the mean of three shots with a learned prior, both ways).
//
// Compiled once for every instruction set.
#include "filters/shot/fusion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>
#include <type_traits>

#include "filters/shot/contributing_frame.h"
#include "filters/shot/shot_reprojection.h"
#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shot/fusion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SSDO_FILTERS_SHOT_SAYING_
#define SSDO_FILTERS_SHOT_SAYING_
namespace ssdo {

/// What another frame says of at most RowOfPoints::kMost points in a row.
struct Contribution {
  const ReprojectedPoints* sights;
  const std::uint16_t* values;  ///< Findings::values
  int row;                      ///< KeptSurfaces::stride()
  const float* units;           ///< by channel, those of the frame over one's own
  const float* weights;         ///< by channel, where nothing has moved
  /// By kind of light, and by point: how much of it counts. Null where nothing has moved.
  const float* moved;
  const float* weights_of_kinds;  ///< `weights` by kind and channel, 0 in those of other kinds
};

/// The kinds of light that a group of channels holds: 0 all that is not of a source, then sources.
using KindsOfGroup = std::span<const std::vector<int>>;

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A group of channels.
using Channels = hn::CappedTag<float, Findings::kGroup>;
using Halves = hn::Rebind<hwy::float16_t, Channels>;

HWY_INLINE hn::Vec<Channels> load_half(const std::uint16_t* values) {
  const hn::Rebind<std::uint16_t, Channels> bits;
  return hn::PromoteTo(Channels(), hn::BitCast(Halves(), hn::LoadU(bits, values)));
}

/// How much of each channel of a group counts at point `i`.
HWY_INLINE hn::Vec<Channels> weights_at(const Contribution& contribution,
                                        const std::vector<int>& kinds, int stride, int i, int c) {
  const Channels d;
  if (!contribution.moved) return hn::LoadU(d, contribution.weights + c);
  auto weight = hn::Zero(d);
  for (const int kind : kinds) {
    const auto of_kind = hn::LoadU(d, contribution.weights_of_kinds + kind * stride + c);
    const auto counts = hn::Set(d, contribution.moved[kind * RowOfPoints::kMost + i]);
    weight = hn::MulAdd(of_kind, counts, weight);
  }
  return weight;
}

/// Adds the values of other frames to the sums of `count` points, `stride` channels each. `own` are
/// the frame's own values; the sums have the same units. `all` are the sums of the weights.
void add_contributions(const std::uint16_t* own, int stride, int count,
                       std::span<const Contribution> contributions, KindsOfGroup kinds, float* sums,
                       float* all) {
  const Channels d;
  for (int i = 0; i < count; ++i) {
    for (int c = 0; c < stride; c += int(hn::Lanes(d))) {
      const std::ptrdiff_t at = std::ptrdiff_t(i) * stride + c;
      const auto base = load_half(own + at);
      auto sum = hn::LoadU(d, sums + at), weights = hn::LoadU(d, all + at);
      for (const Contribution& contribution : contributions) {
        const int pixel = contribution.sights->pixel[i];
        if (pixel < 0) continue;
        const auto unit = hn::LoadU(d, contribution.units + c);
        // Differences are summed, so that constant values stay exactly as they are.
        const std::uint16_t* from = contribution.values + std::ptrdiff_t(pixel) * stride + c;
        const auto tap = [&](int k, const std::uint16_t* value) HWY_ATTR {
          return hn::Mul(hn::Set(d, contribution.sights->weight[k][i]),
                         hn::MulSub(load_half(value), unit, base));
        };
        const std::ptrdiff_t below = std::ptrdiff_t(contribution.row) * stride;
        const auto change = hn::Add(hn::Add(tap(0, from), tap(1, from + stride)),
                                    hn::Add(tap(2, from + below), tap(3, from + below + stride)));
        const auto weight =
            weights_at(contribution, kinds[std::size_t(c) / Findings::kGroup], stride, i, c);
        sum = hn::MulAdd(weight, change, sum);
        weights = hn::Add(weights, weight);
      }
      hn::StoreU(sum, d, sums + at), hn::StoreU(weights, d, all + at);
    }
  }
}

/// The means of `count` values from their sums, in place of these.
void finish_means(const std::uint16_t* own, int count, const float* all, float* sums) {
  const Channels d;
  for (int c = 0; c < count; c += int(hn::Lanes(d))) {
    const auto step = hn::Div(hn::LoadU(d, sums + c), hn::LoadU(d, all + c));
    hn::StoreU(hn::Add(load_half(own + c), step), d, sums + c);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(add_contributions);
HWY_EXPORT(finish_means);

namespace {

/// The kind of light of each channel, as KindsOfGroup has it.
std::vector<int> kinds_of(const Findings& findings) {
  std::vector<int> kinds;
  for (const FoundPlane& plane : findings.planes)
    kinds.insert(kinds.end(), std::size_t(plane.channels), std::max(plane.source + 1, 0));
  kinds.resize(std::size_t(findings.stride), 0);
  return kinds;
}

void load(const float* from, float& value) { value = *from; }
void load(const float* from, glm::vec3& value) { value = {from[0], from[1], from[2]}; }

}  // namespace

/// What a block of points needs for one frame.
struct Fusion::Scratch {
  explicit Scratch(std::size_t kind_count) : kinds(kind_count), moved(2 * kinds * kMost) {
    contributions.reserve(2);
  }
  float* moved_of(std::size_t contribution) { return &moved[contribution * kinds * kMost]; }

  static constexpr std::size_t kMost = RowOfPoints::kMost;
  std::size_t kinds;
  const RowOfPoints* points = nullptr;
  ReprojectedPoints sights[2] = {};
  std::vector<float> moved;
  std::span<const TrackedPoint> followed;  ///< of the row
  std::vector<Contribution> contributions;
};

/// Adds what a frame says of a block of points, at their places at rest and at those to which
/// points were followed.
void Fusion::add_frame(const ContributingFrame& s, const RowOfPixels& row, Scratch& scratch) {
  const Findings& there = s.findings;
  Contribution contribution{
      &scratch.sights[0],       s.arranged.empty() ? there.values.data() : s.arranged.data(),
      there.surfaces.stride(),  s.units.data(),
      s.weights.data(),         nullptr,
      s.weights_of_kinds.data()};
  const auto by_x = [](const TrackedPoint& point) { return point.x; };
  const auto first = std::ranges::lower_bound(scratch.followed, row.x, {}, by_x),
             last = std::ranges::lower_bound(scratch.followed, row.x + row.count, {}, by_x);
  if (s.reprojection.find(*scratch.points, scratch.sights[0])) {
    float* counts = scratch.moved_of(0);
    if (s.moved) {
      for (std::size_t kind = 0; kind < scratch.kinds; ++kind)
        s.moved->row(int(kind) - 1, row, counts + kind * Scratch::kMost);
    } else if (first != last) {
      std::fill_n(counts, scratch.kinds * Scratch::kMost, 1.0f);
    }
    for (auto point = first; point != last; ++point)
      for (std::size_t kind = 0; kind < scratch.kinds; ++kind)
        counts[kind * Scratch::kMost + std::size_t(point->x - row.x)] *= 1 - point->track_weight;
    if (s.moved || first != last) contribution.moved = counts;
    scratch.contributions.push_back(contribution);
  }
  if (first == last) return;
  ReprojectedPoints& sights = scratch.sights[1];
  std::fill_n(sights.pixel, row.count, -1);
  float* counts = scratch.moved_of(1);  // 0 for sources
  float beside[RowOfPoints::kMost];
  std::fill_n(beside, row.count, 1.0f);
  if (s.moved) s.moved->row_of_moving(row, beside);
  for (auto point = first; point != last; ++point) {
    const auto i = std::size_t(point->x - row.x);
    sights.pixel[i] = point->pixel;
    for (int corner = 0; corner < 4; ++corner) sights.weight[corner][i] = point->weight[corner];
    counts[i] = point->track_weight * point->confidence * beside[i];
  }
  contribution.sights = &sights, contribution.moved = counts;
  scratch.contributions.push_back(contribution);
}

Fusion::Fusion(const Findings& own, const Light& light)
    : own_(own), light_(light), followed_(own), kinds_(kinds_of(own)) {
  for (std::size_t c = 0; c < kinds_.size(); c += Findings::kGroup) {
    const auto first = kinds_.begin() + std::ptrdiff_t(c);
    std::vector<int> group(first, first + Findings::kGroup);
    std::ranges::sort(group);
    group.erase(std::unique(group.begin(), group.end()), group.end());
    groups_.push_back(std::move(group));
  }
  const std::size_t count = own.stride > 0 ? own.values.size() : 0;
  sums_.resize(count), all_.resize(count);
  for_each_row(own.stride > 0 ? own.surfaces.window.height() + 2 : 0, [&](int row) {
    const std::size_t of_row = std::size_t(own.surfaces.stride()) * std::size_t(own.stride),
                      first = std::size_t(row) * of_row;
    std::fill_n(&sums_[first], of_row, 0.0f), std::fill_n(&all_[first], of_row, 1.0f);
  });
}

// A whole row is done for one frame before the next, so that memory is read in order.
void Fusion::add(const std::vector<OtherFindings>& others, bool are_last) {
  if (!own_.surfaces.world_known || own_.stride == 0) return;
  const std::vector<ContributingFrame> frames =
      contributing_frames_of(own_, others, light_, kinds_);
  followed_.reach(others);
  const Window& window = own_.surfaces.window;
  for_each_row(window.height(), [&](int y) {
    std::vector<std::vector<TrackedPoint>> followed(others.size());
    followed_.row(y, are_last, followed);
    if (frames.empty()) return;
    std::vector<RowOfPixels> blocks;
    for (int x = 0; x < window.width(); x += RowOfPoints::kMost)
      blocks.push_back({x, y, 1, std::min(RowOfPoints::kMost, window.width() - x)});
    std::vector<RowOfPoints> points(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b)
      load_points(own_.surfaces, blocks[b], points[b]);
    Scratch scratch(light_.sources.size() + 1);
    for (const ContributingFrame& s : frames) {
      scratch.followed = followed[s.other];
      for (std::size_t b = 0; b < blocks.size(); ++b) {
        scratch.points = &points[b];
        scratch.contributions.clear();
        add_frame(s, blocks[b], scratch);
        if (scratch.contributions.empty()) continue;
        const std::size_t first = own_.surfaces.index(blocks[b].x, y) * std::size_t(own_.stride);
        HWY_DYNAMIC_DISPATCH(add_contributions)
        (&own_.values[first], own_.stride, blocks[b].count, scratch.contributions, groups_,
         &sums_[first], &all_[first]);
      }
    }
  });
}

void Fusion::finish(const Geometry& geometry, Products& products) {
  const Surfaces& surfaces = geometry.surfaces;
  std::size_t number = 0;
  for_each_found(
      [&](auto& plane, int, bool) {
        if (own_.planes[number++].channels > 0)
          plane = std::remove_reference_t<decltype(plane)>::like(surfaces);
      },
      products);
  const glm::mat3 to_camera(geometry.camera.rotation);
  const auto stride = std::size_t(own_.stride);
  for_each_row(own_.stride > 0 ? surfaces.height : 0, [&](int y) {
    const std::size_t at = own_.surfaces.index(0, y) * stride;
    float* means = &sums_[at];
    HWY_DYNAMIC_DISPATCH(finish_means)
    (&own_.values[at], surfaces.width * own_.stride, &all_[at], means);
    std::size_t plane_number = 0, channel = 0;
    for_each_found(
        [&](auto& plane, int, bool) {
          const FoundPlane& found = own_.planes[plane_number++];
          for (int x = 0; found.channels > 0 && x < surfaces.width; ++x) {
            auto& value = plane(x, y);
            load(&means[std::size_t(x) * stride + channel], value);
            value *= own_.unit[channel];
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, glm::vec3>) {
              const Surfel& s = surfaces(x, y);
              if (found.is_direction && s.is_surface())
                value = turned(to_camera * value, s.normal, glm::vec3(0, 0, 1));
            }
          }
          channel += std::size_t(found.channels);
        },
        products);
  });
  sums_ = {}, all_ = {};
}

}  // namespace ssdo
#endif
