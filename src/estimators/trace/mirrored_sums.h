// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "estimators/microfacets.h"

namespace ssdo {

/// What a surface with this F0 mirrors, ray by ray: see bitmask/rays/reflection.cpp.
struct MirroredSums {
  glm::vec3 f0{0};
  float open = 0, all = 0;
  glm::vec3 open_sky{0}, sky{0}, met{0}, weights{0};

  void add_ray(const FacetSample& sample, bool is_open) {
    all += sample.share;
    if (is_open) open += sample.share;
  }

  /// `radiance`: of the sky in the direction of the ray; `sent`: of a surface that blocks it.
  void add_light(const FacetSample& sample, const glm::vec3& viewer, bool is_open,
                 const glm::vec3& radiance, const glm::vec3& sent) {
    const float rise = fresnel_rise(glm::dot(viewer, sample.facet));
    const glm::vec3 weight = sample.share * (f0 + (1.0f - f0) * rise);
    weights += weight, sky += weight * radiance;
    if (is_open) open_sky += weight * radiance;
    if (!is_open) met += weight * sent;
  }

  float share() const { return all > 0 ? open / all : 1; }
  glm::vec3 share_of_sky() const {
    glm::vec3 shares(share());
    for (int c = 0; c < 3; ++c)
      if (sky[c] > 0) shares[c] = open_sky[c] / sky[c];
    return shares;
  }
  /// The mean radiance of surfaces, 0 where none is met.
  glm::vec3 surfaces() const {
    glm::vec3 mean(0);
    for (int c = 0; c < 3; ++c)
      if (weights[c] > 0) mean[c] = met[c] / weights[c];
    return mean;
  }
};

}  // namespace ssdo
