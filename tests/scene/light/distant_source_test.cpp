// SPDX-License-Identifier: Apache-2.0
//
// A concentrated source by itself: where its light lies and what it gives at the horizon.
#include "scene/light/distant_source.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "scene/light/light.h"
#include "scene/light/painted_map.h"
#include "scene/light/take_suns.h"

namespace ssdo::test::distant_source_test {
namespace {

/// The only source of a map that is black around it.
DistantSource only_source(const Environment& map) {
  const SunsAndRest parts = take_suns(map);
  EXPECT_EQ(parts.suns.size(), 1u);
  return parts.suns.at(0);
}

/// Vector sum and second moments of a map's light, over all of it.
struct Moments {
  double light = 0;
  glm::dvec3 mean{0};
  glm::dmat3 squares{0};

  void add(const glm::dvec3& d, double weight) {
    light += weight, mean += weight * d, squares += weight * glm::outerProduct(d, d);
  }
};

/// A source brighter to its right and with a step in it.
glm::vec3 uneven(const glm::vec3& d, const glm::vec3& middle) {
  if (!in_rectangle(d, middle, 24, 14)) return glm::vec3(0);
  const float right = glm::dot(d, glm::normalize(glm::cross({0, 0, 1}, middle)));
  return glm::vec3((right > 0.1f ? 3.0f : 2.0f) + 2 * right);
}

TEST(DistantSource, PointsAreAsDenseAsTheLight) {
  // In the middle of the map, across the date line, near a pole, and turned.
  for (const glm::vec2& at : {glm::vec2(20, 10), glm::vec2(180, -30), glm::vec2(70, 80)}) {
    for (const float turned : {0.0f, 77.0f}) {
      const glm::vec3 middle = direction_of(at.x, at.y);
      const Environment map = paint(
          512, [&](const glm::vec3& d) { return uneven(d, middle); }, 1, turned);
      const DistantSource sun = only_source(map);
      Moments texels, points;
      for (int y = 0; y < 256; ++y) {
        for (int x = 0; x < 512; ++x)
          texels.add(map.texel_direction(x, y), (*map.map())(x, y).x * map.texel_solid_angle(y));
      }
      constexpr int kSide = 256;
      for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 u((float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide);
        const glm::vec3 d = sun.point(u);
        ASSERT_NEAR(glm::length(d), 1, 1e-5);
        points.add(d, 1);
        const glm::ivec2 texel(map.texel_at(d));
        ASSERT_GT((*map.map())(texel.x % 512, texel.y).x, 0) << at.x << " " << texel.x;
      }
      const glm::dvec3 mean = texels.mean / texels.light;
      EXPECT_LT(glm::distance(points.mean / points.light, mean), 1e-4) << at.x << " " << at.y;
      EXPECT_LT(glm::distance(glm::dvec3(sun.direction), glm::normalize(mean)), 1e-5);
      for (int c = 0; c < 3; ++c) {
        EXPECT_LT(glm::distance(points.squares[c] / points.light, texels.squares[c] / texels.light),
                  2e-4)
            << at.x << " " << at.y;
      }
    }
  }
}

TEST(DistantSource, PointsInATexelAreEvenlySpread) {
  const Environment map = paint(64, [](const glm::vec3& d) {
    return glm::vec3(in_disc(d, {1, 0, 0}, 9) ? 1 : 0);
  });
  const DistantSource sun = only_source(map);
  // Four quarters of a texel, of equal solid angle but for the slope of the sine.
  std::array<int, 4> hits{};
  constexpr int kSide = 256;
  for (int i = 0; i < kSide * kSide; ++i) {
    const glm::vec2 at = map.texel_at(
        sun.point({(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide}));
    ++hits[std::size_t(at.x - std::floor(at.x) < 0.5f) +
           2 * std::size_t(at.y - std::floor(at.y) < 0.5f)];
  }
  for (const int n : hits) EXPECT_NEAR(n / double(kSide * kSide), 0.25, 0.005);
}

TEST(DistantSource, ALargeShapeIsCoarsenedByLittle) {
  const glm::vec3 middle = direction_of(170, 20);
  const Environment map =
      paint(4096, [&](const glm::vec3& d) { return glm::vec3(in_disc(d, middle, 20) ? 1 : 0); });
  const DistantSource sun = only_source(map);
  float farthest = 0;
  for (int i = 0; i < 10000; ++i)
    farthest = std::max(
        farthest,
        glm::distance(middle, sun.point({float(i % 100) / 99.5f, float(i / 100) / 99.5f})));
  EXPECT_NEAR(glm::degrees(2 * std::asin(farthest / 2)), 20, 0.36);  // a cell is four rows
}

/// The mean of max(0, n.d) over the disc, as a share of its greatest, by many points in double.
double cosine_of_disc(double radius_degrees, double elevation_degrees) {
  const double radius = glm::radians(radius_degrees), e = glm::radians(elevation_degrees);
  double sum = 0, all = 0;
  constexpr int kRings = 200, kSpokes = 128;
  for (int i = 0; i < kRings; ++i) {
    // Rings of equal solid angle.
    const double c = 1 - (1 - std::cos(radius)) * (i + 0.5) / kRings, s = std::sqrt(1 - c * c);
    for (int k = 0; k < kSpokes; ++k) {
      const double turn = 2 * glm::pi<double>() * (k + 0.5) / kSpokes;
      sum += std::max(0.0, c * std::sin(e) + s * std::cos(turn) * std::cos(e));
      all += c;
    }
  }
  return sum / all;
}

TEST(DistantSource, DiscsCrossTheHorizonGradually) {
  EXPECT_NEAR(cosine_of_disc(4.5, 0), 0.0168, 2e-4);
  EXPECT_NEAR(cosine_of_disc(4.5, 0.5), 0.0214, 2e-4);
  EXPECT_NEAR(cosine_of_disc(4.5, 3), 0.0535, 2e-4);
  double worst = 0;
  for (const float radius : {0.27f, 1.0f, 4.5f, 10.0f, 20.0f}) {
    for (const glm::vec3& middle : {direction_of(33, 12), direction_of(100, 88)}) {
      const DistantSource sun = only_source(paint(
          1024, [&](const glm::vec3& d) { return glm::vec3(in_disc(d, middle, radius) ? 1 : 0); },
          radius < 2 ? 8 : 2));
      const glm::vec3 side = glm::normalize(glm::cross(sun.direction, {0.3f, 0.5f, -0.8f}));
      for (int i = -20; i <= 20; ++i) {
        const double elevation = 1.3 * radius * i / 20.0;
        const float e = glm::radians(float(elevation));
        const float found = sun.received({}, std::cos(e) * side + std::sin(e) * sun.direction);
        const double exact = cosine_of_disc(radius, elevation);
        worst = std::max(worst, std::abs(found - exact));
        EXPECT_NEAR(found, exact, 1e-3) << radius << " " << elevation;
        if (e > 1.01f * sun.angular_radius) {
          ASSERT_NEAR(found, std::sin(e), 1e-6);
        }
        if (e < -1.01f * sun.angular_radius) {
          ASSERT_EQ(found, 0);
        }
      }
    }
  }
  fmt::print("cosine of discs at the horizon: off by {:.1e} at most\n", worst);
}

TEST(DistantSource, TurnsAsAWhole) {
  const glm::mat3 turn(glm::rotate(glm::mat4(1), 0.8f, glm::normalize(glm::vec3(1, 2, -1))));
  const DistantSource still =
      only_source(paint(256, [](const glm::vec3& d) { return uneven(d, direction_of(20, 30)); }));
  DistantSource turned = still;
  turned.turn(turn);
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const glm::vec2 u(float(i % 10) / 10, float(i / 10) / 10);
    EXPECT_LT(glm::distance(turned.point(u), turn * still.point(u)), 1e-6);
    const glm::vec3 n = random_direction(random);
    EXPECT_NEAR(turned.received({}, turn * n), still.received({}, n), 1e-6);
  }
}

}  // namespace
}  // namespace ssdo::test::distant_source_test
