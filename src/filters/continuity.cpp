// SPDX-License-Identifier: Apache-2.0
//
// Whether a frame continues the shot of the frame before. Pixels are reprojected to the other
// camera. A pixel is evidence for one shot if that camera saw the same surface there with the same
// albedo, and against it if the albedo differs or the camera looked through the surface. It is a
// cut if less than half of the evidence is for one shot.
//
//   same albedo: within the range of the pixels around p', widened by 0.05 + 1/8 of its upper end
//
// A range instead of a mean, because a texture of single pixels is sampled elsewhere when the
// camera moves.
#include "filters/continuity.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "filters/reprojection.h"

namespace ssdo {
namespace {

constexpr int kEvery = 4;  ///< every 4th pixel of every 4th row is reprojected

// A cut: the least share of the evidence that is for one shot, and the fewest pixels to decide by.
constexpr double kLeastKept = 0.5, kLeastPixels = 16;

// Motion against cameras: ignore camera motion below 0.1 px; flag a median ratio off by 30 %.
constexpr double kLeastMove = 0.1, kMostDifference = 0.3;

bool is_like(const glm::vec3& now, const Plane<HalfColor>& before, const PixelsBefore& at) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (int k = 0; k < at.count; ++k) {
    const glm::vec3 beside = before[at.pixel[k]];
    low = glm::min(low, beside), high = glm::max(high, beside);
  }
  for (int c = 0; c < 3; ++c) {
    const float margin = 0.05f + high[c] / 8;
    if (!(now[c] >= low[c] - margin && now[c] <= high[c] + margin)) return false;
  }
  return true;
}

/// Counts the evidence of the pixels of `now`.
void add_pixels(Continuity& sum, const FrameSurfaces& before, const FrameSurfaces& now,
                const Plane<glm::vec2>& motion) {
  const Reprojection reprojection(before.geometry, now.geometry);
  const bool colored = !before.albedo.empty() && !now.albedo.empty();
  const Surfaces& surfaces = now.geometry.surfaces;
  for (int y = 0; y < surfaces.height; y += kEvery) {
    for (int x = 0; x < surfaces.width; x += kEvery) {
      const std::size_t i = surfaces.index(x, y);
      if (!now.geometry.is_surface(i)) continue;
      const glm::dvec2 from_motion =
          motion.empty() ? glm::dvec2(NAN) : centre_of(now.geometry, x, y) + glm::dvec2(motion[i]);
      const PixelsBefore at = reprojection.find(surfaces[i], from_motion);
      if (at.sight == SeenBefore::nothing) continue;
      sum.met += 1;
      if (at.sight == SeenBefore::same && (!colored || is_like(now.albedo[i], before.albedo, at)))
        sum.kept += 1;
    }
  }
}

}  // namespace

bool Continuity::is_cut() const { return met >= kLeastPixels && kept < kLeastKept * met; }

Continuity compare_frames(const FrameSurfaces& before, const FrameSurfaces& now,
                          const Plane<glm::vec2>& motion) {
  Continuity still, moving;
  add_pixels(still, before, now, {});
  add_pixels(still, now, before, {});
  if (motion.empty()) return still;
  add_pixels(moving, before, now, motion);  // which leads to the frame before, not from it
  return moving.kept * still.met > still.kept * moving.met ? moving : still;
}

void MotionRatios::add(const glm::dvec2& by_layer, const glm::dvec2& by_cameras) {
  surfaces_ += 1;
  for (int axis = 0; axis < 2; ++axis) {
    const double factor = by_layer[axis] / by_cameras[axis];
    if (std::abs(by_cameras[axis]) > kLeastMove && std::isfinite(factor))
      factors_[axis].push_back(factor);
  }
}

bool MotionRatios::contradict() const {
  return std::ranges::any_of(factors_, [&](std::vector<double> of_axis) {
    if (of_axis.size() <= surfaces_ / 4) return false;
    const auto middle = of_axis.begin() + std::ptrdiff_t(of_axis.size() / 2);
    std::nth_element(of_axis.begin(), middle, of_axis.end());
    return std::abs(*middle - 1) > kMostDifference;
  });
}

bool contradicts_cameras(const Geometry& before, const Geometry& geometry,
                         const Plane<glm::vec2>& motion) {
  if (!before.world_known || !geometry.world_known) return false;
  const Reprojection reprojection(before, geometry);
  MotionRatios ratios;
  for (int y = 0; y < geometry.surfaces.height; y += kEvery) {
    for (int x = 0; x < geometry.surfaces.width; x += kEvery) {
      const std::size_t i = geometry.surfaces.index(x, y);
      if (!geometry.is_surface(i)) continue;
      ratios.add(glm::dvec2(motion[i]),
                 reprojection.place(geometry.surfaces[i].position) - centre_of(geometry, x, y));
    }
  }
  return ratios.contradict();
}

}  // namespace ssdo
