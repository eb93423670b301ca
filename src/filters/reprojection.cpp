// SPDX-License-Identifier: Apache-2.0
//
// temporal.cpp derives the tests.
#include "filters/reprojection.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ssdo {
namespace {

constexpr double kSlant = 2;  ///< length of a motion over the part of it across the view

bool shows_same(const Surfel& q, const glm::dvec3& p, const glm::dvec3& normal, double limit) {
  const glm::dvec3 away = glm::dvec3(q.position) - p, other(q.normal);
  limit += q.rounding;
  return glm::dot(normal, other) >= Reprojection::kSameNormal &&
         std::abs(glm::dot(normal, away)) <= limit && std::abs(glm::dot(other, away)) <= limit;
}

}  // namespace

Reprojection::Reprojection(const Geometry& before, const Geometry& now)
    : before_(before),
      change_(now.camera, before.camera),
      pixel_size_(1 / before.camera.fx, 1 / before.camera.fy) {}

PixelsBefore Reprojection::find(const Surfel& surfel, const glm::dvec2& from_motion) const {
  PixelsBefore found;
  const glm::dvec3 p = change_.position(surfel.position);
  const glm::dvec2 still = place(surfel.position);
  const bool moves = std::isfinite(from_motion.x) && std::isfinite(from_motion.y);
  const double scale = before_.camera.orthographic ? 1.0 : -p.z,
               way =
                   moves ? kSlant * scale * glm::length((from_motion - still) * pixel_size_) : 0.0,
               limit = 0.5 * scale * pixel_size_.x + surfel.rounding + way;
  const glm::dvec2 at =
      (moves ? from_motion : still) - glm::dvec2(before_.window.x0 + 0.5, before_.window.y0 + 0.5);
  const double left = std::floor(at.x), top = std::floor(at.y);
  const int width = before_.surfaces.width, height = before_.surfaces.height;
  if (!(left >= -1 && left < width && top >= -1 && top < height)) return found;
  const glm::dvec3 normal = change_.direction(surfel.normal);
  double sum = 0;
  bool through = true;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner % 2, dy = corner / 2, x = int(left) + dx, y = int(top) + dy;
    const double across = at.x - left, down = at.y - top,
                 weight = (dx ? across : 1 - across) * (dy ? down : 1 - down);
    if (x < 0 || y < 0 || x >= width || y >= height) continue;
    const std::size_t i = before_.surfaces.index(x, y);
    if (!before_.is_surface(i)) continue;
    const Surfel& q = before_.surfaces[i];
    through = through && double(q.position.z) < p.z - kBehind * std::abs(p.z) - way;
    if (!shows_same(q, p, normal, limit)) continue;
    found.pixel[found.count] = i;
    found.weight[found.count++] = float(weight);
    sum += weight;
  }
  if (sum < kLeastShare) found.count = 0;
  for (int k = 0; k < found.count; ++k) found.weight[k] /= float(sum);
  found.sight = found.count > 0 ? SeenBefore::same
                : through       ? SeenBefore::through
                                : SeenBefore::nothing;
  return found;
}

}  // namespace ssdo
