// SPDX-License-Identifier: Apache-2.0
//
// What the frames of a shot have found of a point, taken together.
//
// Light at a point of a surface does not depend on the camera, but what a frame takes for it does:
// each guesses what it does not show, from what it shows. Frames before and after show other parts
// of the scene, and their guesses err in other ways. So a frame takes the mean,
//
//   value(p) = (own(p) + sum over others of w s(p')) / (1 + sum of w)
//
// s(p') is what another frame has found at the point that p shows, the bilinear average of the
// pixels around it that show the same surface (filters/reprojection.h). All frames count alike, so
// that one that comes into reach, or leaves it, changes the mean least. Averaged are shares of
// direct light, not light: shading by the normal stays that of the frame, and so does the light.
// Bounce is averaged as it is.
//
// What is known is not the same at all times: things move, and light with them. w is less where
// what stands in one of both frames, but not in the other, hides light from p
// (filters/shot/moved.h): for a source if it may throw its shadow there, for all other light by the
// form factor. Lamps in the picture are switched: of the light that surfaces send, another frame
// counts by
//
//   sum of min(L, L') / sum of max(L, L')
//
// over points that both show, L and L' what these radiate there.
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
#include <glm/matrix.hpp>
#include <optional>
#include <type_traits>

#include "filters/reprojection.h"
#include "filters/shot/moved.h"
#include "filters/shot/saying.h"
#include "math/luminance.h"
#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shot/fusion.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

/// The mean of a pixel, `stride` channels, in the units of `own`.
void mean_of_pixel(const std::uint16_t* own, int stride, const Saying* sayings, int count,
                   const SeenPixel* taps, float* mean) {
  const Channels d;
  for (int c = 0; c < stride; c += int(hn::Lanes(d))) {
    const auto base = load_half(own + c);
    auto sum = hn::Zero(d), all = hn::Set(d, 1);
    for (int k = 0; k < count; ++k) {
      const Saying& saying = sayings[k];
      const auto unit = hn::LoadU(d, saying.units + c);
      // Differences, so that what is constant stays as it is.
      auto change = hn::Zero(d);
      for (int t = saying.first; t < saying.first + saying.count; ++t) {
        const auto value = load_half(saying.values + std::size_t(taps[t].pixel) * stride + c);
        change = hn::MulAdd(hn::Set(d, taps[t].weight), hn::MulSub(value, unit, base), change);
      }
      const auto weight = hn::LoadU(d, saying.weights + c);
      sum = hn::MulAdd(weight, change, sum);
      all = hn::Add(all, weight);
    }
    hn::StoreU(hn::Add(base, hn::Div(sum, all)), d, mean + c);
  }
}

/// Half numbers of `count` values, a multiple of Findings::kGroup.
void to_half(const float* values, int count, std::uint16_t* half) {
  const Channels d;
  const hn::Rebind<std::uint16_t, Channels> bits;
  const auto most = hn::Set(d, 65504.0f);
  for (int c = 0; c < count; c += int(hn::Lanes(d))) {
    const auto value = hn::Min(hn::Max(hn::LoadU(d, values + c), hn::Neg(most)), most);
    hn::StoreU(hn::BitCast(bits, hn::DemoteTo(Halves(), value)), bits, half + c);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(mean_of_pixel);
HWY_EXPORT(to_half);

namespace {

/// `v` turned as the unit vector `a` is turned to the unit vector `b` by the shortest way, as
/// find_shares() turns bent normals.
glm::vec3 turned(const glm::vec3& v, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 both = a + b;
  return v - glm::dot(both, v) / std::max(1 + glm::dot(a, b), 1e-6f) * both +
         2 * glm::dot(a, v) * b;
}

const glm::vec3 kAxis(0, 0, 1);

/// Points across a frame, about, that are asked for their radiance.
constexpr int kPointsOfGlow = 480;

/// From the deviation of a bent normal from N, as find_shares() leaves it, to world space.
glm::vec3 to_world(const glm::vec3& deviation, const glm::vec3& normal,
                   const glm::mat3& to_camera) {
  return glm::transpose(to_camera) * turned(deviation, kAxis, normal);
}

glm::vec3 from_world(const glm::vec3& bent, const glm::vec3& normal, const glm::mat3& to_camera) {
  return turned(to_camera * bent, normal, kAxis);
}

glm::mat3 rotation_of(const Geometry& geometry) { return glm::mat3(geometry.camera.rotation); }

template <class T>
constexpr int channels_of() {
  return std::is_same_v<T, float> ? 1 : 3;
}

bool same_planes(const Findings& a, const Findings& b) {
  return std::ranges::equal(a.planes, b.planes, [](const FoundPlane& one, const FoundPlane& other) {
    return one.channels == other.channels && one.source == other.source;
  });
}

/// How much of the radiance of the points that both show is the same.
float same_glow(const Findings& own, const Findings& other, const Reprojection& reprojection) {
  if (own.glow.empty() && other.glow.empty()) return 1;
  const Plane<Surfel>& surfel = own.geometry->surfel;
  const int stride = std::max(1, surfel.width / kPointsOfGlow);
  double same = 0, all = 0;
  for (int y = 0; y < surfel.height; y += stride) {
    for (int x = 0; x < surfel.width; x += stride) {
      if (!surfel(x, y).is_surface()) continue;
      const PixelsBefore at = reprojection.find(surfel(x, y), glm::dvec2(NAN));
      if (at.count == 0) continue;
      const float here = own.glow.empty() ? 0 : own.glow(x, y);
      float there = 0;
      for (int k = 0; k < at.count && !other.glow.empty(); ++k)
        there += at.weight[k] * other.glow[at.pixel[k]];
      same += double(std::min(here, there)), all += double(std::max(here, there));
    }
  }
  return all > 0 ? float(same / all) : 1;
}

/// Another frame that says something.
struct Speaker {
  const Findings& findings;
  Reprojection reprojection;
  std::optional<MovedWeights> moved;  ///< where something has moved
  std::vector<float> weights;         ///< by channel, where nothing has
  std::vector<float> units;           ///< Saying::units
};

/// What each channel is of.
std::vector<int> sources_of(const Findings& findings) {
  std::vector<int> sources;
  for (const FoundPlane& plane : findings.planes)
    sources.insert(sources.end(), std::size_t(plane.channels), plane.source);
  sources.resize(std::size_t(findings.stride), FoundPlane::kOfAll);
  return sources;
}

std::vector<Speaker> speakers_of(const Findings& own, const std::vector<const Findings*>& others,
                                 const Light& light) {
  std::vector<Speaker> speakers;
  if (!own.geometry->world_known || own.stride == 0) return speakers;
  for (const Findings* other : others) {
    if (!other->geometry->world_known || !same_planes(own, *other)) continue;
    const std::vector<MovedPiece> pieces = find_moved(*own.geometry, *other->geometry);
    std::optional<MovedWeights> moved;
    if (!pieces.empty()) moved.emplace(*own.geometry, pieces, light);
    const Reprojection reprojection(*other->geometry, *own.geometry);
    const float glow = same_glow(own, *other, reprojection);
    std::vector<float> weights, units;
    for (const int source : sources_of(own))
      weights.push_back(source == FoundPlane::kOfSenders ? glow : 1);
    for (std::size_t c = 0; c < own.unit.size(); ++c) units.push_back(other->unit[c] / own.unit[c]);
    speakers.push_back(
        {*other, reprojection, std::move(moved), std::move(weights), std::move(units)});
  }
  return speakers;
}

/// Takes the mean of one row after the other.
class RowOfMeans {
 public:
  RowOfMeans(const Findings& own, const std::vector<Speaker>& speakers)
      : own_(own),
        speakers_(speakers),
        sources_(sources_of(own)),
        weights_(speakers.size() * std::size_t(own.stride)),
        taps_(4 * speakers.size()),
        sayings_(speakers.size()) {}

  /// `mean` has own.stride values.
  void pixel(int x, int y, float* mean) {
    const Geometry& geometry = *own_.geometry;
    const std::size_t i = geometry.surfel.index(x, y);
    int count = 0, taps = 0;
    if (geometry.is_surface(i)) {
      for (std::size_t k = 0; k < speakers_.size(); ++k) {
        const Speaker& speaker = speakers_[k];
        const PixelsBefore at = speaker.reprojection.find(geometry.surfel[i], glm::dvec2(NAN));
        if (at.count == 0) continue;
        sayings_[std::size_t(count++)] = {speaker.findings.values.data(), weights_of(k, x, y),
                                          speaker.units.data(), taps, at.count};
        for (int t = 0; t < at.count; ++t)
          taps_[std::size_t(taps++)] = {std::uint32_t(at.pixel[t]), at.weight[t]};
      }
    }
    HWY_DYNAMIC_DISPATCH(mean_of_pixel)
    (&own_.values[i * std::size_t(own_.stride)], own_.stride, sayings_.data(), count, taps_.data(),
     mean);
    for (std::size_t c = 0; c < own_.unit.size(); ++c) mean[c] *= own_.unit[c];
  }

 private:
  const float* weights_of(std::size_t k, int x, int y) {
    const Speaker& speaker = speakers_[k];
    if (!speaker.moved) return speaker.weights.data();
    float* weights = &weights_[k * sources_.size()];
    for (std::size_t c = 0; c < sources_.size(); ++c)
      weights[c] = speaker.weights[c] * speaker.moved->at(sources_[c], x, y);
    return weights;
  }

  const Findings& own_;
  const std::vector<Speaker>& speakers_;
  const std::vector<int> sources_;  ///< by channel
  std::vector<float> weights_;
  std::vector<SeenPixel> taps_;
  std::vector<Saying> sayings_;
};

/// Filters keep the light of small bright senders apart; not every frame shows some.
void join_emitted(Plane<glm::vec3>& bounce, Plane<glm::vec3>& emitted) {
  for (std::size_t i = 0; i < emitted.size(); ++i) bounce[i] += emitted[i];
  emitted = {};
}

/// A power of two near the mean size of the values of a plane.
template <class T>
float unit_of(const Plane<T>& plane) {
  double sum = 0;
  for (const T& value : plane.pixels) {
    if constexpr (std::is_same_v<T, float>)
      sum += double(std::abs(value));
    else
      sum += double(std::abs(value.x) + std::abs(value.y) + std::abs(value.z)) / 3;
  }
  const double mean = plane.empty() ? 0 : sum / double(plane.size());
  return mean > 0 && std::isfinite(mean) ? float(std::exp2(std::round(std::log2(mean)))) : 1;
}

void store(float value, float* to) { *to = value; }
void store(const glm::vec3& value, float* to) { std::copy_n(&value.x, 3, to); }

void load(const float* from, float& value) { value = *from; }
void load(const float* from, glm::vec3& value) { value = {from[0], from[1], from[2]}; }

}  // namespace

Findings take_findings(Products& products, Geometry geometry, const Plane<glm::vec3>& radiance) {
  join_emitted(products.bounce, products.shares.emitted);
  for (LightProducts& light : products.lights) join_emitted(light.bounce, light.emitted);
  Findings out;
  for (const glm::vec3& color : radiance.pixels) out.glow.pixels.push_back(luminance(color));
  out.glow.width = radiance.width, out.glow.height = radiance.height;
  int channels = 0;
  for_each_found(
      [&](auto& plane, int source, bool bends) {
        using T = std::decay_t<decltype(plane[0])>;
        const int count = plane.empty() ? 0 : channels_of<T>();
        out.planes.push_back({count, source, bends});
        out.unit.insert(out.unit.end(), std::size_t(count), unit_of(plane));
        channels += count;
      },
      products);
  out.stride = (channels + Findings::kGroup - 1) / Findings::kGroup * Findings::kGroup;
  out.unit.resize(std::size_t(out.stride), 1);
  const Plane<Surfel>& surfel = geometry.surfel;
  const glm::mat3 to_camera = rotation_of(geometry);
  out.values.resize(surfel.size() * std::size_t(out.stride));
  for_each_row(channels > 0 ? surfel.height : 0, [&](int y) {
    std::vector<float> row(std::size_t(surfel.width) * std::size_t(out.stride));
    int first = 0;
    for_each_found(
        [&](auto& plane, int, bool bends) {
          using T = std::decay_t<decltype(plane[0])>;
          if (plane.empty()) return;
          for (int x = 0; x < surfel.width; ++x) {
            T value = plane(x, y);
            if constexpr (std::is_same_v<T, glm::vec3>) {
              const Surfel& s = surfel(x, y);
              if (bends && s.is_surface()) value = to_world(value, s.normal, to_camera);
            }
            const auto channel = std::size_t(first);
            store(value / out.unit[channel],
                  &row[std::size_t(x) * std::size_t(out.stride) + channel]);
          }
          first += channels_of<T>();
        },
        products);
    HWY_DYNAMIC_DISPATCH(to_half)
    (row.data(), int(row.size()), &out.values[surfel.index(0, y) * std::size_t(out.stride)]);
  });
  for_each_found([](auto& plane, int, bool) { plane = {}; }, products);
  out.geometry = std::make_shared<const Geometry>(std::move(geometry));
  return out;
}

void fuse(const Findings& own, const std::vector<const Findings*>& others, const Light& light,
          Products& products) {
  const Plane<Surfel>& surfel = own.geometry->surfel;
  std::size_t number = 0;
  for_each_found(
      [&](auto& plane, int, bool) {
        using T = std::decay_t<decltype(plane[0])>;
        if (own.planes[number++].channels > 0) plane = Plane<T>(surfel.width, surfel.height);
      },
      products);
  const std::vector<Speaker> speakers = speakers_of(own, others, light);
  const glm::mat3 to_camera = rotation_of(*own.geometry);
  for_each_row(own.stride > 0 ? surfel.height : 0, [&](int y) {
    RowOfMeans means(own, speakers);
    std::vector<float> mean(std::size_t(own.stride));
    for (int x = 0; x < surfel.width; ++x) {
      means.pixel(x, y, mean.data());
      std::size_t plane_number = 0;
      const float* from = mean.data();
      for_each_found(
          [&](auto& plane, int, bool) {
            const FoundPlane& found = own.planes[plane_number++];
            if (found.channels == 0) return;
            auto& value = plane(x, y);
            load(from, value);
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, glm::vec3>) {
              const Surfel& s = surfel(x, y);
              if (found.bends && s.is_surface()) value = from_world(value, s.normal, to_camera);
            }
            from += found.channels;
          },
          products);
    }
  });
}

}  // namespace ssdo
#endif
