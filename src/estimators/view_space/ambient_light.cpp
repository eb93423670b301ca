// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/ambient_light.h"

#include "estimators/view_space/view_planes.h"
#include "parallel/tiles.h"

namespace ssdo {

Plane<glm::vec3> ambient_light(const Scene& scene, const Plane<float>& ao,
                               const Plane<glm::vec3>* facing) {
  Plane<glm::vec3> direct(ao.width, ao.height, glm::vec3(0));
  for_each_row(ao.height, [&](int y) {
    for (int x = 0; x < ao.width; ++x) {
      const std::size_t i = ao.index(x, y);
      const Surfel& s = scene.geometry.surfaces[i];
      if (!s.is_usable()) continue;
      const bool bent = facing && (*facing)[i] != glm::vec3(0);
      const glm::vec3 normal = bent ? (*facing)[i] : s.normal;
      direct[i] = ao[i] * scene.light.unoccluded(s.position, normal);
    }
  });
  return direct;
}

}  // namespace ssdo
