// SPDX-License-Identifier: Apache-2.0
#include "scene/light/environment.h"

#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

namespace ssdo::test::environment_test {
namespace {

glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
}

/// A map whose red grows with the column and whose green grows with the row.
std::shared_ptr<const Plane<glm::vec3>> ramp(int width, int height) {
  auto map = std::make_shared<Plane<glm::vec3>>(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) (*map)(x, y) = {float(x) + 0.5f, float(y) + 0.5f, 1};
  }
  return map;
}

TEST(Environment, HasOpenExrAxesWhereYIsUp) {
  const Environment env(ramp(64, 32), {.up = UpAxis::y});
  // longitude = atan2(x, z), column = (1/2 - longitude / 2 pi) w; the pole is the first row.
  EXPECT_NEAR(env.radiance({0, 0, 1}).x, 32, 1e-3);
  EXPECT_NEAR(env.radiance({1, 0, 0}).x, 16, 1e-3);
  EXPECT_NEAR(env.radiance({-1, 0, 0}).x, 48, 1e-3);
  EXPECT_NEAR(env.radiance({0, 1, 0}).y, 0.5, 1e-3);
  EXPECT_NEAR(env.radiance({0, -1, 0}).y, 31.5, 1e-3);
}

TEST(Environment, HasBlendersAxesWhereZIsUp) {
  const Environment env(ramp(64, 32), {.up = UpAxis::z});
  // u = 1/2 - atan2(y, x) / 2 pi.
  EXPECT_NEAR(env.radiance({1, 0, 0}).x, 32, 1e-3);
  EXPECT_NEAR(env.radiance({0, 1, 0}).x, 16, 1e-3);
  EXPECT_NEAR(env.radiance({0, -1, 0}).x, 48, 1e-3);
  EXPECT_NEAR(env.radiance({0, 0, 1}).y, 0.5, 1e-3);
}

TEST(Environment, RotatesCounterClockwiseSeenFromAbove) {
  std::mt19937 random(1);
  for (const UpAxis up : {UpAxis::y, UpAxis::z}) {
    const glm::vec3 axis = up == UpAxis::y ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1);
    const Environment still(ramp(64, 32), {.up = up});
    const Environment turned(ramp(64, 32), {.up = up, .rotate_degrees = 37});
    for (int i = 0; i < 100; ++i) {
      const glm::vec3 d = random_direction(random);
      const glm::vec3 before = glm::mat3(glm::rotate(glm::mat4(1), glm::radians(-37.0f), axis)) * d;
      EXPECT_NEAR(turned.radiance(d).y, still.radiance(before).y, 1e-2);
      // The column jumps at the date line.
      const float difference = std::abs(turned.radiance(d).x - still.radiance(before).x);
      EXPECT_LT(std::min(difference, 64 - difference), 0.7) << i;
    }
  }
}

TEST(Environment, ExposureIsInStops) {
  const Environment env(ramp(8, 4), {.exposure_stops = 3});
  EXPECT_NEAR(env.radiance({0, 0, 1}).z, 8, 1e-5);
  EXPECT_NEAR(env.mean().z, 8, 1e-5);
  EXPECT_NEAR(env.blurred(0.5f, glm::mat3(1))(glm::vec3(0, 0, 1)).z, 8, 1e-4);
}

TEST(Environment, MeanWeighsBySolidAngle) {
  auto map = std::make_shared<Plane<glm::vec3>>(64, 32, glm::vec3(0));
  for (int x = 0; x < 64; ++x) (*map)(x, 0) = glm::vec3(1);
  const double cap = (1 - std::cos(glm::pi<double>() / 32)) / 2;  // of the sphere
  EXPECT_NEAR(Environment(map, {}).mean().x, cap, 1e-6);
}

TEST(Environment, BlurKeepsAConstant) {
  const auto map = std::make_shared<Plane<glm::vec3>>(100, 50, glm::vec3(0.25f, 1, 4));
  const OctahedralMap blurred = Environment(map, {}).blurred(0.1f, glm::mat3(1));
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const glm::vec3 c = blurred(random_direction(random));
    EXPECT_NEAR(c.x, 0.25, 1e-5);
    EXPECT_NEAR(c.z, 4, 1e-4);
  }
}

TEST(Environment, BlurOfHalfASphereIsTheIrradiance) {
  // A sun of one texel and a dim sky; the irradiance summed texel by texel in double.
  const int width = 256, height = 128;
  auto map = std::make_shared<Plane<glm::vec3>>(width, height, glm::vec3(0.2f));
  (*map)(40, 30) = glm::vec3(5000);
  const Environment env(map, {.up = UpAxis::z});
  const OctahedralMap irradiance = env.blurred(glm::pi<float>(), glm::mat3(1));
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 n(random_direction(random));
    double sum = 0;
    for (int y = 0; y < height; ++y) {
      const double top = std::cos(glm::pi<double>() * y / height),
                   bottom = std::cos(glm::pi<double>() * (y + 1) / height);
      const double omega = (top - bottom) * 2 * glm::pi<double>() / width,
                   polar = glm::pi<double>() * (y + 0.5) / height;
      for (int x = 0; x < width; ++x) {
        const double azimuth = 2 * glm::pi<double>() * (0.5 - (x + 0.5) / width);
        const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                           std::cos(polar));
        sum += omega * std::max(0.0, glm::dot(n, d)) * (*map)(x, y).x;
      }
    }
    // The sun's peak is 0.64. At its terminator the cosine has a kink, which nodes that are 3
    // degrees apart round off by a quarter of that angle.
    EXPECT_NEAR(irradiance(glm::vec3(n)).x, sum / glm::pi<double>(), 0.64 * 0.052 / 4 + 0.001);
  }
}

TEST(OctahedralMap, EncodesEveryDirection) {
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 d = random_direction(random);
    EXPECT_LT(glm::distance(octahedral_decode(octahedral_encode(d)), d), 1e-5);
  }
}

TEST(OctahedralMap, HasNoSeam) {
  OctahedralMap map(64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) map(x, y) = map.direction_of(x, y);
  }
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 d = random_direction(random);
    EXPECT_LT(glm::distance(map(d), d), 0.02) << "interpolated across the fold";
  }
}

}  // namespace
}  // namespace ssdo::test::environment_test
