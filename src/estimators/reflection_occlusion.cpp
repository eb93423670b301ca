// SPDX-License-Identifier: Apache-2.0
#include "estimators/reflection_occlusion.h"

#include "estimators/view_planes.h"
#include "parallel/tiles.h"

namespace ssdo {

Plane<float> reflection_occlusion(const EstimateInput& in, const Plane<glm::vec3>& bent,
                                  float roughness) {
  Plane<float> open(bent.width, bent.height, 1.0f);
  for_each_row(open.height, [&](int y) {
    for (int x = 0; x < open.width; ++x) {
      const Surfel& s = in.geometry.surfel(x, y);
      if (!is_usable(s)) continue;
      const glm::vec3 normal(s.normal), seen_along = in.geometry.camera.orthographic
                                                         ? glm::vec3(0, 0, -1)
                                                         : glm::normalize(glm::vec3(s.position));
      open(x, y) = reflection_occlusion(bent(x, y), glm::reflect(seen_along, normal), roughness);
    }
  });
  return open;
}

}  // namespace ssdo
