// SPDX-License-Identifier: Apache-2.0
#include "support/average_picture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ssdo::test {

Picture average_picture(const Surface& scene, const Camera& camera, const Window& window, int n,
                        Plane<unsigned char>& averaged) {
  Picture picture = take_picture(scene, camera, window);
  averaged = Plane<unsigned char>(window.width(), window.height());
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      glm::dvec3 position(0), normal(0);
      double nearest = HUGE_VAL, farthest = 0;
      for (int s = 0; s < n * n; ++s) {
        const Ray ray = ray_through(camera, x + (s % n + 0.5) / n, y + (s / n + 0.5) / n);
        const auto hit = scene(ray);
        nearest = std::min(nearest, hit ? hit->distance : HUGE_VAL);
        farthest = std::max(farthest, hit ? hit->distance : HUGE_VAL);
        if (!hit) continue;
        position += (ray.origin + hit->distance * ray.direction) / double(n * n);
        const bool away = glm::dot(hit->normal, ray.direction) > 0;
        normal += (away ? -hit->normal : hit->normal) / double(n * n);
      }
      const std::size_t i = picture.position.index(x - window.x0, y - window.y0);
      averaged[i] = farthest > nearest * 1.02;
      picture.position[i] = glm::vec3(position);
      picture.normal[i] = glm::vec3(normal);
      picture.valid[i] = nearest < HUGE_VAL;
    }
  }
  return picture;
}

}  // namespace ssdo::test
