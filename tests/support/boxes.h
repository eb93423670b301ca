// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "support/analytic_scene.h"
#include "support/deep_elements.h"

namespace ssdo::test {

/// A box with faces along the axes.
struct Box {
  glm::dvec3 low, high;

  /// Where a ray enters and leaves it, as distances; enter > leave where it is missed.
  std::pair<double, double> cross(const Ray& ray) const {
    double enter = -1e30, leave = 1e30;
    for (int c = 0; c < 3; ++c) {
      const double a = (low[c] - ray.origin[c]) / ray.direction[c],
                   b = (high[c] - ray.origin[c]) / ray.direction[c];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return {enter, leave};
  }

  /// As seen from outside.
  Surface surface() const {
    return [box = *this](const Ray& ray) -> std::optional<Hit> {
      const auto [enter, leave] = box.cross(ray);
      if (enter > leave || enter < 1e-9) return std::nullopt;
      const glm::dvec3 p = ray.origin + enter * ray.direction;
      Hit hit{enter, glm::dvec3(0)};
      for (int c = 0; c < 3; ++c) {
        if (std::abs(p[c] - box.low[c]) < 1e-9) hit.normal[c] = -1;
        if (std::abs(p[c] - box.high[c]) < 1e-9) hit.normal[c] = 1;
      }
      hit.normal = glm::normalize(hit.normal);
      return hit;
    };
  }
};

/// Adds the stretch of every pixel's ray that is in the box, as an opaque deep sample by planar
/// depth.
inline void add_box(const Box& box, const Camera& camera, DeepPixels& pixels) {
  for (int y = pixels.window.y0; y < pixels.window.y1; ++y) {
    for (int x = pixels.window.x0; x < pixels.window.x1; ++x) {
      const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
      const auto [enter, leave] = box.cross(ray);
      if (enter > leave || enter < 0) continue;
      const auto depth = [&](double t) {
        return float(-camera.to_camera(ray.origin + t * ray.direction).z);
      };
      pixels.at(x, y).push_back({depth(enter), depth(leave), 1});
    }
  }
}

/// A round post around the z axis that stands on the ground.
inline Surface post(double radius, double height) {
  return [=](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec2 o(ray.origin), d(ray.direction);
    const double a = glm::dot(d, d), b = glm::dot(o, d), c = glm::dot(o, o) - radius * radius;
    const double root = b * b - a * c;
    if (root <= 0) return std::nullopt;
    const double t = (-b - std::sqrt(root)) / a, z = ray.origin.z + t * ray.direction.z;
    if (t < 1e-9 || z < 0 || z > height) return std::nullopt;
    return Hit{t, glm::dvec3((o + t * d) / radius, 0)};
  };
}

}  // namespace ssdo::test
