// SPDX-License-Identifier: Apache-2.0
//
// Compiled once for every instruction set.
#include "estimators/specular/mirror_model.h"

#include <glm/common.hpp>
#include <vector>

#include "math/sobol.h"
#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/specular/mirror_model.cpp"
#include <hwy/foreach_target.h>

#include "estimators/specular/facets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void reflectances_of_row(float roughness, const glm::vec2* points, int count, glm::vec2* nodes) {
  constexpr int kCosines = Reflectances::kCosines;
  static_assert(kCosines % kLanes == 0);
  const std::vector<FacetPoint> at(points, points + count);
  for (int first = 0; first < kCosines; first += kLanes) {
    const V root = iota(float(first)) * set(1.0f / (kCosines - 1)), cosine = root * root,
            zero = set(0), sine = hn::Sqrt(hn::Max(set(1) - cosine * cosine, zero));
    const MirrorFrame frame({zero, zero, set(1)}, {sine, zero, cosine}, set(roughness));
    V even = zero, rises = zero;
    for (int k = 0; k < count; ++k) {
      const FacetRays ray = frame.rays(at[std::size_t(k)]);
      const V rise = fresnel_rise(ray.facing) * ray.share;
      even = even + (ray.share - rise), rises = rises + rise;
    }
    const V scale = set(1 / float(count));
    alignas(64) float x[kLanes], y[kLanes];
    store(even * scale, x), store(rises * scale, y);
    for (int lane = 0; lane < kLanes; ++lane) nodes[first + lane] = {x[lane], y[lane]};
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(reflectances_of_row);

namespace {

/// Sobol's points of each node, in one of the two halves of the square that mirror each other.
constexpr int kPoints = 4096;

/// Fresnel's equations for light along the normal.
float f0_of(double index_of_refraction) {
  const double root = (index_of_refraction - 1) / (index_of_refraction + 1);
  return float(root * root);
}

}  // namespace

Reflectances::Reflectances() : nodes_(kCosines, kRoughnesses) {
  std::vector<glm::vec2> points;
  for (int s = 0; s < kPoints; ++s) {
    const glm::vec2 u = sobol_point(std::uint32_t(s), 0);
    points.emplace_back(u.x, 0.5f * u.y - 0.25f);
  }
  for_each_row(kRoughnesses, [&](int y) {
    HWY_DYNAMIC_DISPATCH(reflectances_of_row)
    (float(y) / (kRoughnesses - 1), points.data(), kPoints, &nodes_(0, y));
  });
}

glm::vec2 Reflectances::operator()(float cosine, float roughness) const {
  const float x = std::sqrt(std::clamp(cosine, 0.0f, 1.0f)) * (kCosines - 1),
              y = std::clamp(roughness, 0.0f, 1.0f) * (kRoughnesses - 1);
  const int x0 = std::min(int(x), kCosines - 2), y0 = std::min(int(y), kRoughnesses - 2);
  const float fx = x - float(x0), fy = y - float(y0);
  return glm::mix(glm::mix(nodes_(x0, y0), nodes_(x0 + 1, y0), fx),
                  glm::mix(nodes_(x0, y0 + 1), nodes_(x0 + 1, y0 + 1), fx), fy);
}

MirrorModel::MirrorModel(const Scene& scene, const Request& request)
    : roughness(float(request.parameters.at("roughness"))),
      f0(f0_of(request.parameters.at("ior"))),
      sky(scene.light.sky, scene.geometry.world_to_camera) {}

}  // namespace ssdo
#endif
