// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/basis_weights.h"

#include "math/spherical_harmonics.h"

namespace ssdo {

std::vector<float> basis_weights(const Light& light, int order) {
  const int count = sh_count(order);
  std::vector<float> weights(std::size_t(3 * count), 0.0f);
  for (int c = 0; c < 3; ++c) {
    float* channel = &weights[std::size_t(c * count)];
    if (light.order == 0) channel[0] = 1;
    for (int i = 0; light.order > 0 && i < count; ++i)
      channel[i] = kShConstants[std::size_t(i)] * light.coefficients[std::size_t(i)][c];
  }
  return weights;
}

}  // namespace ssdo
