// SPDX-License-Identifier: Apache-2.0
#include "math/spherical_harmonics.h"

#include <cmath>

#include "math/spherical_harmonics-inl.h"

namespace ssdo {

std::array<float, kShCount> sh_basis(const glm::vec3& d) {
  std::array<float, kShCount> basis;
  HWY_NAMESPACE::for_each_sh_polynomial<0, kShOrder>(
      d.x, d.y, d.z, [](float value) { return value; },
      [&](int i, float value) { basis[std::size_t(i)] = kShConstants[std::size_t(i)] * value; });
  return basis;
}

/// Funk and Hecke: a lobe k(cos) multiplies band l by 2 pi times the integral of k P_l. Three
/// points of Gauss and Legendre are exact for a degree of 5, which (x - edge) P_4 has.
std::array<double, kShOrder + 1> sh_lobe_factors(double edge) {
  std::array<double, kShOrder + 1> factors{};
  const double middle = (1 + edge) / 2, half = (1 - edge) / 2;
  for (const double node : {-std::sqrt(0.6), 0.0, std::sqrt(0.6)}) {
    const double x = middle + half * node;
    const double weight = (node == 0 ? 8.0 : 5.0) / 18 * (x - edge) / half;
    double previous = 0, legendre = 1;
    for (int l = 0; l <= kShOrder; ++l) {
      factors[l] += weight * legendre;
      const double next = ((2 * l + 1) * x * legendre - l * previous) / (l + 1);
      previous = legendre;
      legendre = next;
    }
  }
  return factors;
}

}  // namespace ssdo
