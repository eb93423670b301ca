// SPDX-License-Identifier: Apache-2.0
#include "estimators/microfacets.h"

#include <gtest/gtest.h>

#include "math/sobol.h"

namespace ssdo::test::microfacets_test {
namespace {

/// The share of an even light that a rough mirror sends on, by the definition of the facets'
/// distribution: the integral of D G / (4 n.v n.l) n.l over the hemisphere, in double.
double reflected_share(double cosine, double alpha) {
  const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
  const double pi = glm::pi<double>();
  const auto smith = [&](double c) {
    return 2 * c / (c + std::sqrt(c * c + alpha * alpha * (1 - c * c)));
  };
  double sum = 0;
  constexpr int kRings = 600, kTurns = 1200;
  for (int i = 0; i < kRings; ++i) {
    const double z = (i + 0.5) / kRings, r = std::sqrt(1 - z * z);
    for (int k = 0; k < kTurns; ++k) {
      const double azimuth = 2 * pi * (k + 0.5) / kTurns;
      const glm::dvec3 l(r * std::cos(azimuth), r * std::sin(azimuth), z);
      const glm::dvec3 h = glm::normalize(l + v);
      const double d = h.z * h.z * (alpha * alpha - 1) + 1, facets = alpha * alpha / (pi * d * d);
      sum += facets * smith(cosine) * smith(z) / (4 * cosine);
    }
  }
  return sum * 2 * pi / (double(kRings) * kTurns);
}

TEST(Microfacets, SamplesSumToTheIntegral) {
  for (const double cosine : {0.15, 0.5, 0.9, 1.0}) {
    for (const double roughness : {0.5, 0.7, 1.0}) {
      const glm::vec3 viewer(float(std::sqrt(1 - cosine * cosine)), 0, float(cosine));
      double sum = 0;
      constexpr int kCount = 1 << 14;
      for (int s = 0; s < kCount; ++s) {
        const FacetSample sample =
            mirror_at_facet(viewer, float(roughness), sobol_point(std::uint32_t(s), 7));
        EXPECT_NEAR(glm::length(sample.to), 1, 1e-4);
        sum += double(sample.share) / kCount;
      }
      EXPECT_NEAR(sum, reflected_share(cosine, roughness * roughness), 0.003)
          << cosine << " " << roughness;
    }
  }
}

TEST(Microfacets, AMirrorMirrors) {
  const glm::vec3 viewer = glm::normalize(glm::vec3(0.6f, 0.3f, 0.5f));
  const FacetSample sample = mirror_at_facet(viewer, 0, {0.3f, 0.4f});
  EXPECT_NEAR(glm::distance(sample.to, {-viewer.x, -viewer.y, viewer.z}), 0, 0.02);
  EXPECT_NEAR(sample.share, 1, 1e-3);
}

}  // namespace
}  // namespace ssdo::test::microfacets_test
