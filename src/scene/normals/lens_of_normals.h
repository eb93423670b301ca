// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/geometry.h"

namespace ssdo {

/// A lens under which the normals agree with the surfaces of a planar depth.
struct LensOfNormals {
  double focal_ratio = 1;            ///< its focal length over that of the geometry's camera
  double miss_before = 0, miss = 0;  ///< median angles from the normals, in degrees
};

/// The lens that the normals suggest in place of that of `geometry`, whose positions were made from
/// a planar depth; nothing where that lens is right, or none is clearly better. `stored` are the
/// normals in any space that is turned against the camera's.
std::optional<LensOfNormals> find_lens_of_normals(const Plane<glm::vec3>& stored,
                                                  const Geometry& geometry);

}  // namespace ssdo
