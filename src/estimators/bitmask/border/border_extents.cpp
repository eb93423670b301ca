// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/border/border_extents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <optional>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// The largest continuation of a surface beyond what is seen of it, over the length that is seen:
/// sideways, and up or down. Share of the sun on sunlit floors of 18 views of an open set with 1,
/// 0.5 and 0.3 upward: 0.89, 0.94 and 0.96 (truth 1). Sideways 1, 2 and 4 differ by less. A level
/// surface, such as a ceiling, has no height: it is as likely to be as deep as it is seen wide.
constexpr float kMostAside = 2, kMostUp = 0.3f;

/// The factor on this continuation for a surface that is seen to end at least kEndMargin diagonals
/// of the frame before the border.
constexpr float kEndShare = 0.05f, kEndMargin = 0.1f;

/// A point is on a tangent plane if it is off by no more than this share of the way to it plus this
/// many pixels at its depth.
constexpr float kPlaneShare = 0.02f, kPlanePx = 0.75f;

/// The least cosine between two normals of one surface: the floor at the foot of a wall is another
/// surface.
constexpr float kSameWay = 0.7f;

/// A surface ends where others are seen behind its plane over more than kGapPx pixels plus
/// kGapShare of the pixels over which it was seen: windows and gaps between houses are no ends.
/// Behind an occluder the surface goes on if it is seen again within kHiddenTimes its length so
/// far, or within kHiddenShare of the frame's diagonal at its depth.
constexpr float kGapPx = 2, kGapShare = 0.1f, kHiddenTimes = 4 / 3.0f, kHiddenShare = 0.1f;

/// All these limits are gradual, because cameras move: the weight falls from 1 at a limit to 0 at
/// kNotAtAll times the limit. With sharp limits, a row of houses, seen past a gap or not, halved
/// the light of a street between two frames.
constexpr float kNotAtAll = 2;

/// A step of a walk is one pixel for every kPixelsPerStep pixels of the way so far, but no more
/// than the frame over kMostSteps. From each walk, kWalksAcross others start at right angles, to
/// both sides.
constexpr int kPixelsPerStep = 8, kMostSteps = 128, kWalksAcross = 3;

/// Pixels along the border form groups: those that show the surface of the first pixel of their
/// group share its walks. Groups are as long as a pixel of a frame with this diagonal.
constexpr float kDetailPx = 512;

constexpr glm::ivec2 kWays[4] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

float diagonal_px(const MarchScene& scene) {
  return std::hypot(float(scene.frame_width), float(scene.frame_height));
}

/// 1 up to a limit, 0 from kNotAtAll times it on.
float within(float value, float limit) {
  return 1 - std::clamp((value / limit - 1) / (kNotAtAll - 1), 0.0f, 1.0f);
}

/// What a walk over the frame has met of the surface.
struct Run {
  glm::vec3 from{0}, to{0};  ///< start, and last meeting with the surface, from the border pixel
  float px = 0;              ///< walked until there
  float cut = 1;             ///< 0..1; 1: the border or an occluder hides the end of the surface
};

/// How far a surface is seen along one axis, and whether it ends there. Some walks that end at
/// about the same place may have seen the end and others not: each has as weight the fourth power
/// of how far it came, so that the result changes smoothly from one walk to another, times the
/// squared cosine between its way and the axis: a walk along the top of a wall says nothing about
/// the height.
class SeenAlong {
 public:
  explicit SeenAlong(const glm::vec3& axis) : axis_(axis) {}

  void add(const Run& run) {
    const double seen = double(glm::dot(run.to, axis_));
    if (!(seen > 0)) return;
    seen_ = std::max(seen_, float(seen));
    const glm::vec3 way = run.to - run.from;
    const double along = double(glm::dot(way, axis_)) / double(glm::length(way));
    if (!(along > 0)) return;
    const double seen2 = seen * seen, weight = seen2 * seen2 * along * along;
    weights_ += weight, cut_ += weight * double(run.cut);
  }

  float seen() const { return seen_; }
  float cut() const { return weights_ > 0 ? float(cut_ / weights_) : 1; }

 private:
  const glm::vec3 axis_;
  float seen_ = 0;
  double weights_ = 0, cut_ = 0;
};

/// The surface of one pixel at the border.
class CutSurface {
 public:
  CutSurface(const MarchScene& scene, const glm::ivec2& at, float radius)
      : scene_(scene),
        at_(at),
        start_(position(at)),
        normal_(tangent_normal(scene, at.x, at.y)),
        radius_(radius),
        reach_px_(reach_px(std::max(scene.fx, scene.fy), scene.orthographic, start_, radius)),
        diagonal_px_(diagonal_px(scene)) {}

  /// The depth and normal, without the extent.
  BorderExtent shown() const { return {-start_.z, normal_}; }

  bool asked(const MayMeetPlane& may_meet) const { return !may_meet || may_meet(start_, normal_); }

  BorderExtent extent(const glm::vec3& up) const {
    const Axes axes = axes_of(up);
    const glm::vec3& uphill = axes[2];
    SeenAlong along[4] = {SeenAlong(axes[0]), SeenAlong(axes[1]), SeenAlong(axes[2]),
                          SeenAlong(axes[3])};
    const auto add = [&](const Run& run) {
      for (SeenAlong& direction : along) direction.add(run);
    };
    for (const glm::ivec2& way : kWays) {
      const Run run = walk(at_, way);
      add(run);
      const int px = int(run.px);
      for (int k = 1; k <= kWalksAcross && px > 0; ++k) {
        const glm::ivec2 from = at_ + way * (px * k / kWalksAcross), across(way.y, way.x);
        if (!scene_.shows_surface(scene_.layout.index(from.x, from.y))) continue;
        add(walk(from, across));
        add(walk(from, -across));
      }
    }
    BorderExtent extent = shown();
    for (int k = 0; k < 4; ++k) extent.seen[k] = along[k].seen();
    const float level = 1 - std::abs(glm::dot(uphill, up)), wide = extent.seen[0] + extent.seen[1],
                high = extent.seen[2] + extent.seen[3],
                most[2] = {kMostAside * std::max(wide, level * high),
                           glm::mix(kMostUp * high, kMostAside * std::max(wide, high), level)};
    for (int k = 0; k < 4; ++k) {
      const float share = kEndShare + (1 - kEndShare) * along[k].cut();
      extent.most[k] = std::max(most[k / 2] * share, footprint(-start_.z));
    }
    return extent;
  }

  /// The extent here, from that of another pixel of the same surface.
  BorderExtent extent_beside(const CutSurface& other, const BorderExtent& known,
                             const glm::vec3& up) const {
    BorderExtent extent = shown();
    const Axes axes = other.axes_of(up);
    for (std::size_t k = 0; k < 4; ++k) {
      extent.seen[k] = std::max(known.seen[k] - glm::dot(axes[k], start_ - other.start_), 0.0f);
      extent.most[k] = known.most[k];
    }
    return extent;
  }

  /// Whether another pixel shows this surface.
  bool is_shown_at(const glm::ivec2& at) const {
    const glm::vec3 there = position(at), to = there - start_;
    return std::abs(glm::dot(to, normal_)) <= tolerance(there, to) && looks_alike(at);
  }

 private:
  /// The axes of BorderExtent, unit vectors.
  using Axes = std::array<glm::vec3, 4>;

  Axes axes_of(const glm::vec3& up) const {
    const glm::vec3 axis = glm::cross(up, normal_) + kAxisOfLevelPlanes,
                    right = glm::normalize(axis - glm::dot(axis, normal_) * normal_),
                    uphill = glm::cross(normal_, right);
    return {right, -right, uphill, -uphill};
  }

  /// How far a point of the surface may seem to be off the plane.
  float tolerance(const glm::vec3& there, const glm::vec3& to) const {
    return kPlaneShare * glm::length(to) + kPlanePx * footprint(-there.z);
  }

  bool looks_alike(const glm::ivec2& at) const {
    return glm::dot(tangent_normal(scene_, at.x, at.y), normal_) >= kSameWay;
  }

  float footprint(float depth) const {
    return (scene_.orthographic ? 1 : depth) / std::min(scene_.fx, scene_.fy);
  }

  glm::vec3 position(const glm::ivec2& at) const {
    const float depth = scene_.depth()[scene_.layout.index(at.x, at.y)];
    return {ray_slope(scene_, at.x, at.y) * (scene_.orthographic ? 1 : depth), -depth};
  }

  /// Pixels from `from` to the border of the frame along `way`, even past the raster.
  int to_border(const glm::ivec2& from, const glm::ivec2& way) const {
    const int x = from.x, y = scene_.frame_y + from.y;
    return way.x != 0 ? (way.x > 0 ? scene_.frame_width - 1 - x : x)
                      : (way.y > 0 ? scene_.frame_height - 1 - y : y);
  }

  /// Follows the surface from a pixel in the direction `way`.
  Run walk(const glm::ivec2& from, const glm::ivec2& way) const {
    const int largest_step =
        std::max(1, (way.x != 0 ? scene_.frame_width : scene_.frame_height) / kMostSteps);
    Run run{position(from) - start_};
    const float at_least =
        kHiddenTimes * glm::length(run.from) + kHiddenShare * diagonal_px_ * footprint(-start_.z);
    // `sure`: the certainty that the walk still meets the same surface; `cut`: Run::cut where it
    // does not; `gap`: pixels since it last met the surface; `last_px` and `last`: where that was.
    float sure = 1, cut = 0, gap = 0, last_px = 0;
    glm::vec3 last(0);
    const auto most_gap = [&] { return kGapPx + kGapShare * run.px; };
    const auto cut_here = [&] {
      const float margin_px = kEndMargin * diagonal_px_;
      return 1 - std::min(1.0f, (float(to_border(from, way)) - run.px) / margin_px);
    };
    for (int px = 1, step = 1; float(px) <= reach_px_; px += step) {
      step = std::clamp(px / kPixelsPerStep, 1, largest_step);
      const glm::ivec2 at = from + way * px;
      if (!scene_.raster().contains(at.x, at.y)) break;
      const bool is_surface = scene_.shows_surface(scene_.layout.index(at.x, at.y));
      if (!is_surface && !scene_.shows_background(at.x, at.y)) continue;
      float same = 0;
      if (is_surface) {
        const glm::vec3 there = position(at), to = there - start_;
        const float above = glm::dot(to, normal_), length = glm::length(to),
                    off = tolerance(there, to);
        if (length > radius_) break;
        if (above > off) continue;
        same = within(-above, off) *
               within(length, std::max(at_least, kHiddenTimes * glm::length(run.to)));
        if (same > 0 && !looks_alike(at)) {
          if (above >= -off) continue;
          same = 0;
        }
        if (same > 0) {
          const float lost = same * (1 - within(gap, most_gap()));
          cut += sure * lost * cut_here();
          sure *= 1 - lost;
          run.to += sure * same * (to - last), last += same * (to - last);
          const float walked = same * (float(px) - last_px);
          run.px += sure * walked, last_px += walked;
        }
      }
      gap = (1 - same) * (gap + float(step));
      if (gap >= kNotAtAll * most_gap()) break;
    }
    const float hidden = within(gap, most_gap());
    run.cut = cut + sure * (hidden + (1 - hidden) * cut_here());
    return run;
  }

  const MarchScene& scene_;
  const glm::ivec2 at_;
  const glm::vec3 start_, normal_;
  const float radius_, reach_px_, diagonal_px_;
};

}  // namespace

CutSurfaces find_cut_surfaces(const MarchScene& scene, const glm::vec3& up, float radius,
                              const MayMeetPlane& may_meet) {
  const int w = scene.layout.width(), h = scene.layout.height(),
            together = std::max(1, int(diagonal_px(scene) / kDetailPx));
  CutSurfaces cut{up, std::vector<BorderExtent>(scene.border.size())};
  // Groups lie alike in the display window, whatever part of it the raster is.
  const auto find_along = [&](int count, int first_in_display, const auto& at, const auto& index) {
    const int phase = (first_in_display % together + together) % together;
    for_each_row((phase + count + together - 1) / together, [&](int group) {
      const int first = group * together - phase;
      std::optional<CutSurface> lead;
      BorderExtent extent_of_lead;
      for (int k = std::max(first, 0); k < std::min(first + together, count); ++k) {
        const glm::ivec2 here = at(k);
        if (!scene.shows_surface(scene.layout.index(here.x, here.y))) continue;
        const CutSurface surface(scene, here, radius);
        BorderExtent& extent = cut.extents[std::size_t(index(k))];
        if (!surface.asked(may_meet)) {
          extent = surface.shown();
        } else if (lead && lead->is_shown_at(here)) {
          extent = surface.extent_beside(*lead, extent_of_lead, up);
        } else {
          extent = surface.extent(up);
          if (k == first) lead.emplace(surface), extent_of_lead = extent;
        }
      }
    });
  };
  for (const bool last : {false, true}) {
    find_along(
        w, scene.first_x, [&](int x) { return glm::ivec2(x, last ? h - 1 : 0); },
        [&](int x) { return scene.border.in_row(last, x); });
    find_along(
        h, scene.first_y, [&](int y) { return glm::ivec2(last ? w - 1 : 0, y); },
        [&](int y) { return scene.border.in_column(last, y); });
  }
  return cut;
}

}  // namespace ssdo
