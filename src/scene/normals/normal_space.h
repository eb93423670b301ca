// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "math/plane.h"
#include "scene/surfaces.h"

namespace ssdo {

/// How the stored normals are brought to camera space.
struct NormalSpace {
  glm::mat3 to_camera{1.0f};
  std::string name;
  std::size_t smooth_pixels = 0;  ///< around which P is smooth: N is compared with P there
  double share = 0;               ///< of them, where N and the gradient are within 53 degrees
  double close_share = 0;         ///< the same within 25 degrees
  double turning_share = 0;       ///< the same, where N is not the prevailing one
  double mean_cosine = 0;         ///< between N and the gradient, over them, without their signs
  bool is_own = false;            ///< of none of the spaces that were given

  /// Whether N agrees with P about everywhere, or closely in most of the frame, whatever other
  /// objects of it do, such as leaves that are lit as a crown.
  bool is_known() const {
    return smooth_pixels >= kFewestSmoothPixels &&
           (share >= kLeastShare ||
            (close_share >= kLeastCloseShare && turning_share >= kLeastTurningShare));
  }

  /// normal_space.cpp has what right and wrong normals reach.
  static constexpr double kLeastShare = 0.95, kLeastCloseShare = 0.5, kLeastTurningShare = 0.01;
  static constexpr std::size_t kFewestSmoothPixels = 16;  ///< below, nothing is known
};

/// A space that normals may be stored in, and the rotation from it to camera space.
struct NamedRotation {
  glm::mat3 to_camera;
  std::string name;
};

/// Decides in which of `spaces` and by which axes the normals are stored, of any order and sign: in
/// the first space with its axes unchanged, unless another choice is known and agrees clearly
/// better with the gradient of P where P is smooth. Leaves whose normals all point up agree with no
/// axes, and with many by chance. Spaces that differ by a few degrees are told apart where normals
/// are no rougher than that. Normals that agree with no space, but with P once they are turned by
/// one rotation, have a space of their own. `of_shot` is the name of the space in other frames of
/// the sequence, which may have more text after it: it takes the place of the first space, for a
/// frame that cannot decide by itself.
NormalSpace find_normal_space(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                              const std::vector<NamedRotation>& spaces, bool orthographic,
                              const std::string& of_shot = "");

/// How far the stored normals agree with the gradient of P if they are in `space`, with its axes.
NormalSpace measure_normal_space(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                                 const NamedRotation& space, bool orthographic);

}  // namespace ssdo
