// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/position_rounding.h"

#include <algorithm>
#include <glm/common.hpp>

namespace ssdo {

double rounding_of_positions(const GBuffer& g) {
  float largest = 0;
  for (std::size_t i = 0; i < g.position.size(); ++i) {
    if (!g.valid[i]) continue;
    const glm::vec3 p = glm::abs(g.position[i]);
    largest = std::max({largest, p.x, p.y, p.z});
  }
  return double(largest) * g.position_step;
}

}  // namespace ssdo
