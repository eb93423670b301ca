// SPDX-License-Identifier: Apache-2.0
//
// Method ssao-fade sample by sample, in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "estimators/ssao_fade.h"
#include "estimators/view_space/point_method_request.h"

namespace ssdo::test {

/// The formula with the defaults, sample by sample, in double. Noise (column, row).
inline double slow_ssao_fade(const Geometry& g, int x, int y, int column, int row, double radius) {
  const Surfel& s = g.surfaces(x, y);
  if (!s.is_surface()) return 1;
  const glm::dvec3 p(s.position), n(s.normal);
  const glm::dvec3 m(fade_noise(0)[std::size_t((row & 3) * 4 + (column & 3))]);
  double sum = 0;
  for (const glm::vec3& v : fade_offsets(0)) {
    const glm::dvec3 offset = glm::dvec3(v) - 2 * glm::dot(glm::dvec3(v), m) * m;
    const double flip = glm::dot(offset, n) < 0 ? -1 : 1;
    const glm::dvec3 q = p + flip * radius * offset;
    double z;
    if (!depth_at(g, q, z)) continue;
    const glm::dvec3 r = g.camera.orthographic ? glm::dvec3(q.x, q.y, z) : q * (z / q.z);
    const double distance = r.z - p.z;
    if (!(distance > 0.1 * radius + s.rounding)) continue;
    const double fade = std::min(std::max((2 * radius - distance) / (1.6 * radius), 0.0), 1.0);
    sum += std::max(glm::dot(n, glm::normalize(r - p)), 0.0) * fade;
  }
  return std::pow(1 - sum / 14, 2.0);
}

/// The pixel of a frame, its upper left one at the display window's, that one of the map at half
/// resolution is evaluated at.
inline glm::ivec2 sampled_pixel(const Geometry& g, int x, int y) {
  return {std::min(2 * x + 1, g.surfaces.width - 1), std::min(2 * y + 1, g.surfaces.height - 1)};
}

/// The map at half resolution, with the defaults.
inline Plane<double> slow_half_map(const Geometry& g, double radius) {
  Plane<double> half((g.surfaces.width + 1) / 2, (g.surfaces.height + 1) / 2);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      const glm::ivec2 pixel = sampled_pixel(g, x, y);
      half(x, y) = slow_ssao_fade(g, pixel.x, pixel.y, x, y, radius);
    }
  }
  return half;
}

/// A pixel of the frame, bilinearly from the map.
inline double slow_bilinear(const Plane<double>& half, int x, int y) {
  const auto at = [&](int i, int j) {
    return half(std::clamp(i, 0, half.width - 1), std::clamp(j, 0, half.height - 1));
  };
  // The place of the pixel's centre among the centres of 2 x 2 pixels.
  const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
  const int i = int(std::floor(u)), j = int(std::floor(v));
  const double a = u - i, b = v - j;
  return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
         b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
}

}  // namespace ssdo::test
