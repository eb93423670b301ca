// SPDX-License-Identifier: Apache-2.0
#include "math/spherical_harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

namespace ssdo::test::spherical_harmonics_test {
namespace {

constexpr double kPi = glm::pi<double>();

/// Midpoints of equal areas, rows in z and columns in azimuth; all have the weight `omega`.
template <class Visit>
void for_each_direction(int rows, const Visit& visit) {
  const double omega = 4 * kPi / (2.0 * rows * rows);
  for (int i = 0; i < rows; ++i) {
    const double z = 1 - (2 * i + 1.0) / rows, across = std::sqrt(1 - z * z);
    for (int j = 0; j < 2 * rows; ++j) {
      const double azimuth = kPi * (j + 0.5) / rows;
      visit(glm::vec3(across * std::cos(azimuth), across * std::sin(azimuth), z), omega);
    }
  }
}

TEST(SphericalHarmonics, AreOrthonormal) {
  double products[kShCount][kShCount] = {};
  for_each_direction(400, [&](const glm::vec3& d, double omega) {
    const auto basis = sh_basis(d);
    for (int i = 0; i < kShCount; ++i) {
      for (int j = 0; j < kShCount; ++j) products[i][j] += omega * basis[i] * basis[j];
    }
  });
  for (int i = 0; i < kShCount; ++i) {
    for (int j = 0; j < kShCount; ++j) EXPECT_NEAR(products[i][j], i == j, 3e-4) << i << " " << j;
  }
}

TEST(SphericalHarmonics, LieInTheirOrder) {
  // Bands are eigenspaces of inversion; m changes its sign's function under y -> -y.
  const glm::vec3 d = glm::normalize(glm::vec3(0.3f, -0.5f, 0.8f));
  const auto here = sh_basis(d), opposite = sh_basis(-d), mirrored = sh_basis({d.x, -d.y, d.z});
  for (int l = 0; l <= kShOrder; ++l) {
    for (int m = -l; m <= l; ++m) {
      const int i = l * l + l + m;
      EXPECT_NEAR(opposite[i], l % 2 == 0 ? here[i] : -here[i], 1e-6) << l << " " << m;
      EXPECT_NEAR(mirrored[i], m < 0 ? -here[i] : here[i], 1e-6) << l << " " << m;
    }
  }
}

TEST(SphericalHarmonics, OneBandHasItsIrradianceInClosedForm) {
  const glm::vec3 n = glm::normalize(glm::vec3(0.4f, 0.7f, -0.6f));
  double sums[kShCount] = {};
  for_each_direction(400, [&](const glm::vec3& d, double omega) {
    const auto basis = sh_basis(d);
    const double cosine = std::max(0.0f, glm::dot(n, d));
    for (int i = 0; i < kShCount; ++i) sums[i] += omega * cosine * basis[i] / kPi;
  });
  const auto basis = sh_basis(n);
  for (int l = 0; l <= kShOrder; ++l) {
    for (int i = l * l; i < sh_count(l); ++i) {
      EXPECT_NEAR(sums[i], kCosineFactors[l] * basis[i], 1e-4) << i;
    }
  }
}

TEST(SphericalHarmonics, LobesHaveTheirFactors) {
  const auto cosine = sh_lobe_factors(0);
  for (int l = 0; l <= kShOrder; ++l) EXPECT_NEAR(cosine[l], kCosineFactors[l], 1e-7) << l;
  // 1 + cos is made of the bands 0 and 1; the narrowest lobe keeps everything.
  const auto widest = sh_lobe_factors(-1), narrowest = sh_lobe_factors(1 - 1e-9);
  EXPECT_NEAR(widest[1], 1.0 / 3, 1e-12);
  for (int l = 2; l <= kShOrder; ++l) EXPECT_NEAR(widest[l], 0, 1e-12) << l;
  for (int l = 0; l <= kShOrder; ++l) EXPECT_NEAR(narrowest[l], 1, 1e-6) << l;
}

}  // namespace
}  // namespace ssdo::test::spherical_harmonics_test
