// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/border_extents.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// How much farther than seen a surface goes on at most, over the length that is seen: sideways,
/// and up or down. Share of the sun on sunlit floors of 18 views of an open set with 1, 0.5 and 0.3
/// upward: 0.89, 0.94 and 0.96 (truth 1). Sideways 1, 2 and 4 differ by less. A level surface, such
/// as a ceiling, has no height: it is as likely to be as deep as it is seen wide.
constexpr float kMostAside = 2, kMostUp = 0.3f;

/// The same of a surface that is seen to end at least kEndMargin diagonals of the frame before the
/// border, over what it is for others.
constexpr float kEndShare = 0.05f, kEndMargin = 0.1f;

/// A point is on a tangent plane that it is no farther from than this share of the way to it, or
/// this many pixels of its depth.
constexpr float kPlaneShare = 0.02f, kPlanePx = 0.75f;

/// What looks elsewhere by more than this cosine is not of the same surface, as the floor at the
/// foot of a wall.
constexpr float kSameWay = 0.7f;

/// A surface ends where others are seen behind its plane for so many pixels and a share of those
/// over which it was seen: windows and gaps between houses are no ends. Behind what stands before
/// it, it goes on if it is seen again before it would be twice as long, or this share of its depth.
constexpr float kGapPx = 3, kGapShare = 0.15f, kHiddenShare = 0.15f;

/// A walk across the frame looks at about this many pixels: of larger frames some are skipped. So
/// many others start from each walk, at right angles, to both sides.
constexpr int kMostPixels = 128, kWalksAcross = 3;

constexpr glm::ivec2 kWays[4] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

/// Where a walk over the frame has last met the surface.
struct Run {
  glm::vec3 to{0};  ///< from the pixel at the border
  int px = 0;       ///< walked
  float cut = 1;    ///< 0..1: 1 where the border or something before it hides where it ends
};

/// The surface of one pixel at the border.
class CutSurface {
 public:
  CutSurface(const MarchScene& scene, const glm::ivec2& at, std::ptrdiff_t border_index)
      : scene_(scene), at_(at), start_(position(at)) {
    for (int c = 0; c < 3; ++c) normal_[c] = scene.border_normal[c][std::size_t(border_index)];
  }

  BorderExtent extent(const glm::vec3& up, float radius) const {
    const glm::vec3 axis = glm::cross(up, normal_) + kAxisOfLevelPlanes,
                    right = glm::normalize(axis - glm::dot(axis, normal_) * normal_),
                    uphill = glm::cross(normal_, right);
    const glm::vec3 axes[4] = {right, -right, uphill, -uphill};
    BorderExtent extent;
    float cut[4] = {1, 1, 1, 1};
    const auto add = [&](const Run& run) {
      for (int k = 0; k < 4; ++k) {
        const float seen = glm::dot(run.to, axes[k]);
        if (seen > extent.seen[k]) extent.seen[k] = seen, cut[k] = run.cut;
      }
    };
    for (const glm::ivec2& way : kWays) {
      const Run run = walk(at_, way, radius);
      add(run);
      for (int k = 1; k <= kWalksAcross && run.px > 0; ++k) {
        const glm::ivec2 from = at_ + way * (run.px * k / kWalksAcross), across(way.y, way.x);
        add(walk(from, across, radius));
        add(walk(from, -across, radius));
      }
    }
    const float level = 1 - std::abs(glm::dot(uphill, up)), wide = extent.seen[0] + extent.seen[1],
                high = extent.seen[2] + extent.seen[3],
                most[2] = {kMostAside * std::max(wide, level * high),
                           glm::mix(kMostUp * high, kMostAside * std::max(wide, high), level)};
    for (int k = 0; k < 4; ++k) {
      const float share = kEndShare + (1 - kEndShare) * cut[k];
      extent.most[k] = std::max(most[k / 2] * share, footprint(-start_.z));
    }
    return extent;
  }

 private:
  float footprint(float depth) const {
    return (scene_.orthographic ? 1 : depth) / std::min(scene_.fx, scene_.fy);
  }

  glm::vec3 position(const glm::ivec2& at) const {
    const float depth = scene_.depth()[scene_.layout.index(at.x, at.y)];
    return {ray_slope(scene_, at.x, at.y) * (scene_.orthographic ? 1 : depth), -depth};
  }

  /// From a pixel on, in the direction `way`.
  Run walk(const glm::ivec2& from, const glm::ivec2& way, float radius) const {
    const int w = scene_.layout.width(), h = scene_.layout.height();
    const int size = way.x != 0 ? scene_.frame_width : scene_.frame_height,
              step = std::max(1, size / kMostPixels),
              to_border = way.x != 0 ? (way.x > 0 ? w - 1 - from.x : from.x)
                                     : (way.y > 0 ? h - 1 - from.y : from.y);
    Run run;
    float reaches = 2 * glm::length(position(from) - start_) + kHiddenShare * -start_.z;
    int gap = 0;
    for (int px = step; px <= to_border; px += step) {
      const glm::ivec2 at = from + way * px;
      const glm::vec3 there = position(at), to = there - start_;
      const float above = glm::dot(to, normal_), length = glm::length(to),
                  tolerance = kPlaneShare * length + kPlanePx * footprint(-there.z);
      if (length > radius) return run;
      if (above > tolerance) continue;
      if (above >= -tolerance && length <= reaches) {
        if (glm::dot(tangent_normal(scene_, at.x, at.y), normal_) < kSameWay) continue;
        run.to = to, run.px = px;
        reaches = std::max(reaches, 2 * length);
        gap = 0;
        continue;
      }
      gap += step;
      if (float(gap) < kGapPx + kGapShare * float(run.px)) continue;
      const float margin_px =
          kEndMargin * std::hypot(float(scene_.frame_width), float(scene_.frame_height));
      // Some rows of a frame, as are read for a radius, do not tell how far its border is.
      const bool may_be_part = way.y != 0 && std::isfinite(radius);
      run.cut = may_be_part ? 0.0f : 1 - std::min(1.0f, float(to_border - run.px) / margin_px);
      return run;
    }
    return run;
  }

  const MarchScene& scene_;
  const glm::ivec2 at_;
  const glm::vec3 start_;
  glm::vec3 normal_{0};
};

}  // namespace

CutSurfaces find_cut_surfaces(const MarchScene& scene, const glm::vec3& up, float radius) {
  const int w = scene.layout.width(), h = scene.layout.height();
  CutSurfaces cut{up, std::vector<BorderExtent>(scene.border.size())};
  const auto find = [&](int x, int y, std::ptrdiff_t index) {
    if (!scene.shows_surface(scene.layout.index(x, y))) return;
    cut.extents[std::size_t(index)] = CutSurface(scene, {x, y}, index).extent(up, radius);
  };
  for_each_row(w, [&](int x) {
    for (const bool last : {false, true}) find(x, last ? h - 1 : 0, scene.border.in_row(last, x));
  });
  for_each_row(h, [&](int y) {
    for (const bool last : {false, true})
      find(last ? w - 1 : 0, y, scene.border.in_column(last, y));
  });
  return cut;
}

}  // namespace ssdo
