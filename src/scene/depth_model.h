// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "math/plane.h"

namespace ssdo {

/// What a depth layer measures. Distances are in scene units.
enum class DepthKind { planar, ray, inverse, normalized };

/// Checks a depth layer against P without knowing the camera: planar depth is an affine
/// function of P whose gradient is the unit vector along the axis; the square of a distance from
/// the camera is |P|^2 and an affine function.
class DepthModel {
 public:
  static constexpr std::size_t kFewestPixels = 4;  ///< with both P and depth; fewer decide nothing

  /// Fits both kinds to the pixels of `counts`, whose depths are positive, and takes the better
  /// one. Nothing where neither is right for most of them, that is, where the depth contradicts P:
  /// remapped, in another unit, of another frame; or where there are fewer than kFewestPixels.
  /// `position_step` is the relative rounding of P.
  static std::optional<DepthModel> fit(const Plane<glm::vec3>& positions, const Plane<float>& depth,
                                       const Plane<unsigned char>& counts, float position_step);

  /// The same for planar depths, whose unit may differ from that of P.
  static std::optional<DepthModel> fit_in_any_unit(const Plane<glm::vec3>& positions,
                                                   const Plane<float>& depth,
                                                   const Plane<unsigned char>& counts,
                                                   float position_step);

  DepthKind kind() const { return kind_; }  ///< planar or ray

  /// Change of depth per unit of P along its gradient: 1 where both have the same unit.
  double length_of_unit() const;

  /// Whether a pixel's depth is what its P says, to 5 % and the rounding of P.
  bool agrees(const glm::vec3& position, float depth) const;

 private:
  double depth_of(const glm::dvec3& from_centre) const;

  class Fit;

  DepthKind kind_ = DepthKind::planar;
  glm::dvec3 centre_{0};
  glm::dvec4 affine_{0};  ///< of P - centre, and the constant
  double position_step_ = 0;
};

}  // namespace ssdo
