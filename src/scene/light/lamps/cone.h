// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace ssdo {

/// The angles off its axis into which a lamp sends: all of its light up to `inner`, none from
/// `outer` on, and between them a smooth step of the angle or of its cosine. UsdLux's shaping has
/// the angle, spots of Blender the cosine: `outer` is the cone angle, and `inner` that times
/// 1 - softness.
struct Cone {
  double inner = std::numbers::pi, outer = std::numbers::pi;  ///< radians
  bool by_cosine = false;  ///< whether the step is that of the cosine

  bool is_open() const { return inner >= std::numbers::pi; }

  /// The share of the light that goes in a direction.
  double at(double off_axis) const {
    if (off_axis <= inner) return 1;
    if (off_axis >= outer) return 0;
    const double t =
        by_cosine ? (std::cos(off_axis) - std::cos(outer)) / (std::cos(inner) - std::cos(outer))
                  : (outer - off_axis) / (outer - inner);
    return t * t * (3 - 2 * t);
  }
};

}  // namespace ssdo
