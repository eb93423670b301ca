// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <string>

#include "math/plane.h"
#include "scene/surfel.h"

namespace ssdo {

/// The unit normal of the surface through pixel (x, y), from its neighbours, turned to the viewer,
/// who looks along `view` from the surface. Along each axis the shorter of the two one-sided
/// differences is used, which stays on the pixel's own side of an edge. Zero where the neighbours
/// span no plane.
glm::vec3 gradient_normal(const Plane<Surfel>& surfels, int x, int y, const glm::vec3& view);

/// How the stored normals are brought to camera space.
struct NormalSpace {
  glm::mat3 to_camera{1.0f};
  std::string name;
  double agreement = 0;  ///< median cosine with the gradient normals
};

/// Decides between the space of P (`rotation` leads from it to camera space) and camera space with
/// the usual flips of axes by which agrees best with the gradient of P.
NormalSpace find_normal_space(const Plane<glm::vec3>& stored, const Plane<Surfel>& surfels,
                              const glm::mat3& rotation, bool orthographic);

/// Unit direction from a camera-space point to the viewer.
glm::vec3 direction_to_viewer(const glm::vec3& p, bool orthographic);

}  // namespace ssdo
