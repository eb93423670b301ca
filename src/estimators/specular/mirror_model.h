// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "estimators/estimator.h"
#include "estimators/specular/mirror_map.h"
#include "math/plane.h"
#include "scene/scene.h"

namespace ssdo {

/// How much of an even light a rough surface mirrors, by the cosine to the viewer and the
/// roughness: F0 x + y, the two sums of Karis 2013, Real Shading in Unreal Engine 4.
class Reflectances {
 public:
  /// Nodes by the square root of the cosine, which are close where the surface is seen edge-on, and
  /// by roughness.
  static constexpr int kCosines = 64, kRoughnesses = 33;

  Reflectances();

  glm::vec2 operator()(float cosine, float roughness) const;
  const float* data() const { return &nodes_[0].x; }

 private:
  Plane<glm::vec2> nodes_;
};

/// What specular light is computed with.
struct MirrorModel {
  float roughness, f0;  ///< where the scene has no layers of them
  MirrorMap sky;        ///< the light without its sources
  Reflectances reflectances;

  /// `request` has the parameters roughness and ior.
  MirrorModel(const Scene& scene, const Request& request);

  float roughness_at(const Scene& scene, std::size_t pixel) const {
    return scene.roughness.empty() ? roughness : scene.roughness[pixel];
  }
  glm::vec3 f0_at(const Scene& scene, std::size_t pixel) const {
    return scene.specular_color.empty() ? glm::vec3(f0) : glm::vec3(scene.specular_color[pixel]);
  }
};

}  // namespace ssdo
