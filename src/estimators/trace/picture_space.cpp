// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/picture_space.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "scene/surfaces.h"

namespace ssdo {
namespace {

/// Walls of parallel views end so many sizes of the scene below it.
constexpr double kEndless = 1e4;

}  // namespace

PictureSpace::PictureSpace(const Geometry& g)
    : orthographic_(g.camera.orthographic), fx_(g.camera.fx), fy_(g.camera.fy) {
  double logarithms = 0, count = 0, farthest = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (!g.surfaces[i].is_usable()) continue;
    const glm::vec3 p(g.surfaces[i].position);
    logarithms += std::log2(double(-p.z));
    count += 1;
    farthest = std::max(farthest, double(glm::length(p)));
  }
  // Powers of two, so that the heights of a part of the frame differ in their exponents only.
  scale_ = orthographic_ ? fy_ : fy_ * std::exp2(std::round(logarithms / std::max(count, 1.0)));
  endless_ = -kEndless * scale_ * std::exp2(std::ceil(std::log2(std::max(farthest, 1e-30))));
}

glm::vec3 PictureSpace::point(const glm::dvec3& p) const {
  const double w = orthographic_ ? 1.0 : 1.0 / -p.z;
  return glm::dvec3(fx_ * p.x * w, -fy_ * p.y * w, scale_ * (orthographic_ ? p.z : w));
}

glm::vec3 PictureSpace::position(const glm::vec3& q) const {
  const double z = orthographic_ ? q.z / scale_ : -scale_ / q.z, w = orthographic_ ? 1.0 : -z;
  return glm::dvec3(q.x * w / fx_, -q.y * w / fy_, z);
}

PictureSpace::Ray PictureSpace::ray(const glm::dvec3& p, const glm::dvec3& d, double reach) const {
  if (orthographic_)
    return {point(p), glm::dvec3(fx_ * d.x, -fy_ * d.y, scale_ * d.z), float(reach)};
  // p + t d has the depth D + t c and, with s = t / (D + t c), the slope x / D + s (d_x - c x / D)
  // and the inverse depth 1 / D - s c / D.
  const double depth = -p.z, c = -d.z, x = p.x / depth, y = p.y / depth;
  const double at_end = depth + reach * c;
  const double end = std::isinf(reach) ? (c > 0 ? 1 / c : reach)
                     : at_end > 0      ? reach / at_end
                                       : std::numeric_limits<double>::infinity();
  return {point(p), glm::dvec3(fx_ * (d.x - c * x), -fy_ * (d.y - c * y), -scale_ * c / depth),
          float(end)};
}

glm::vec2 PictureSpace::slope(const glm::vec3& p, const glm::vec3& n) const {
  const double towards = orthographic_ ? -double(n.z) : double(glm::dot(n, p));
  return glm::dvec2(scale_ * n.x / (fx_ * towards), -scale_ * n.y / (fy_ * towards));
}

float PictureSpace::height_behind(float h, const glm::vec3& p, float length) const {
  if (orthographic_) return float(std::max(h - scale_ * length, endless_));
  return h / (1 + length / glm::length(p));
}

}  // namespace ssdo
