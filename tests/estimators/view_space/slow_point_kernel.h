// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/view_space/point_kernel.h"

namespace ssdo::test {

/// The loop of the sources in double, number by number: a direction from a box of 2 x 2 x 1; its
/// length lerp(least, 1, (i / count)^2), in one of them after a random factor.
inline std::vector<glm::dvec3> slow_point_kernel(int count, double least, bool random_factor,
                                                 unsigned seed) {
  RandomNumbers random(seed);
  std::vector<glm::dvec3> kernel;
  for (int i = 0; i < count; ++i) {
    glm::dvec3 sample;
    sample.x = double(random()) * 2 - 1;
    sample.y = double(random()) * 2 - 1;
    sample.z = double(random());
    sample = glm::normalize(sample);
    if (random_factor) sample *= double(random());
    double scale = double(i) / count;
    scale = least + scale * scale * (1 - least);
    kernel.push_back(sample * scale);
  }
  return kernel;
}

}  // namespace ssdo::test
