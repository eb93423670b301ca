// SPDX-License-Identifier: Apache-2.0
#include "support/deep_elements.h"

namespace ssdo::test {

DeepPixels merged(const std::vector<Surface>& elements, const Camera& camera,
                  const Window& window) {
  DeepPixels pixels(window);
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
      for (const Surface& element : elements) {
        const auto hit = element(ray);
        if (!hit) continue;
        const float depth = float(-camera.to_camera(ray.origin + hit->distance * ray.direction).z);
        pixels.at(x, y).push_back({depth, depth, 1});
      }
    }
  }
  return pixels;
}

}  // namespace ssdo::test
