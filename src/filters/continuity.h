// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "math/half_color.h"
#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// A frame of a sequence as the next one remembers it.
struct FrameSurfaces {
  const Geometry& geometry;        ///< must know the world
  const Plane<HalfColor>& albedo;  ///< empty where there is none
};

/// How much of what each of two frames shows is also in the other.
struct Continuity {
  double met = 0;   ///< pixels whose point the other camera looked at, in either direction
  double kept = 0;  ///< those that show the same surface there, with the same albedo

  /// Whether the frames belong to two shots.
  bool is_cut() const;
};

/// Compares every fourth pixel in a row and in a column. Points that are new in the picture, or
/// that something else may have hidden, do not count. `motion` is that of temporal.h; frames are
/// compared without and with it, and the result is that with more kept.
Continuity compare_frames(const FrameSurfaces& before, const FrameSurfaces& now,
                          const Plane<glm::vec2>& motion = {});

/// Motion of surfaces that stand still, by a layer and by the cameras.
class MotionRatios {
 public:
  /// In pixels to the frame before.
  void add(const glm::dvec2& by_layer, const glm::dvec2& by_cameras);

  /// Whether the layer is off by 30 % in the median, along an axis in which the cameras move more
  /// than a quarter of the surfaces. Cameras that rest contradict nothing.
  bool contradict() const;

 private:
  std::size_t surfaces_ = 0;
  std::vector<double> factors_[2];  ///< along each axis, of the layer over the cameras
};

/// Whether motion seems to have other units or signs than accumulate takes, by MotionRatios of all
/// surfaces.
bool contradicts_cameras(const Geometry& before, const Geometry& geometry,
                         const Plane<glm::vec2>& motion);

}  // namespace ssdo
