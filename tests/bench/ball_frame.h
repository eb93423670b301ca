// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <map>
#include <string>

#include "simd/isa.h"
#include "support/analytic_scene.h"

namespace ssdo::bench {

using namespace test;

/// Of the middle of the frame, in scene units.
constexpr float kDepth = 11;

/// 200 spheres on a ground; kept for the next call.
inline const Geometry& frame_of(int width, int height) {
  static std::map<int, Geometry> frames;
  auto [it, added] = frames.try_emplace(width);
  if (!added) return it->second;
  // Rasterised by hand: a list of surfaces would be asked 200 times for each pixel.
  std::vector<std::pair<glm::dvec3, double>> spheres;
  for (int i = 0; i < 200; ++i) {
    const double r = 0.1 + 0.4 * ((i * 37) % 100) / 100.0;
    spheres.push_back(
        {{-6 + 12 * ((i * 61) % 200) / 200.0, -4 + 12 * ((i * 113) % 200) / 200.0, r}, r});
  }
  const Window window{0, 0, width, height};
  const Camera camera = look_at(camera_from_fov(50, window, 1), {0, -10, 5}, {0, 0, 0}, {0, 0, 1});
  const Surface ground = plane({}, {0, 0, 1});
  it->second = geometry_of(
      [&](const Ray& ray) -> std::optional<Hit> {
        auto nearest = ground(ray);
        for (const auto& [centre, radius] : spheres) {
          const glm::dvec3 o = ray.origin - centre;
          const double b = glm::dot(o, ray.direction), c = glm::dot(o, o) - radius * radius;
          if (b * b < c) continue;
          const double t = -b - std::sqrt(b * b - c);
          if (t > 0 && (!nearest || t < nearest->distance))
            nearest = Hit{t, (o + t * ray.direction) / radius};
        }
        return nearest;
      },
      camera, window);
  return it->second;
}

/// Has all vector loops run on an instruction set.
inline void force_isa(const std::string& isa) { choose_isa(isa); }

}  // namespace ssdo::bench
