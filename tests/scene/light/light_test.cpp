// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "scene/light/painted_map.h"
#include "scene/light/take_suns.h"
#include "support/sun_of.h"

namespace ssdo::test::light_test {
namespace {

constexpr float kPi = glm::pi<float>();

/// A disc of one degree in a sky that darkens towards the ground.
const glm::vec3 kSunDirection = glm::normalize(glm::vec3(0.6f, -0.3f, 0.5f));
const float kSunRadius = glm::radians(1.0f);
glm::vec3 clear(const glm::vec3& d) { return (1.2f + d.z) * glm::vec3(0.3f, 0.4f, 0.6f); }
glm::vec3 sunny(const glm::vec3& d) {
  return glm::distance(d, kSunDirection) < kSunRadius ? glm::vec3(3000, 2500, 2000) : clear(d);
}

/// One function of band `l` on a mean of 1.
Environment single_band(int index, float amplitude) {
  return paint(256, [=](const glm::vec3& d) {
    return glm::vec3(1 + amplitude * sh_basis(d)[index], 1, 1 - amplitude * sh_basis(d)[index]);
  });
}

TEST(Light, ConstantNeedsOneCoefficient) {
  const glm::vec3 color(0.25f, 1, 4);
  for (const Environment& env :
       {Environment::constant(color), paint(6, [&](const glm::vec3&) { return color; })}) {
    const Light model = model_light(env, glm::mat3(1));
    EXPECT_TRUE(model.sources.empty());
    EXPECT_EQ(model.order, 0);
    EXPECT_LT(model.residual(), 1e-4);
    EXPECT_NEAR(model.band_energy[0], 1, 1e-4);
    EXPECT_NEAR(model.coefficients[0].z, 4 * std::sqrt(4 * kPi), 1e-3);
    std::mt19937 random(1);
    for (int i = 0; i < 50; ++i) {
      EXPECT_LT(glm::distance(model.irradiance(random_direction(random)), color), 1e-4);
    }
  }
}

TEST(Light, BandLimitedLightHasItsCoefficientsAndItsOrder) {
  for (int l = 1; l <= kShOrder; ++l) {
    for (const int index : {l * l, l * l + l, l * l + 2 * l}) {
      const Light model = model_light(single_band(index, 0.5f), glm::mat3(1));
      EXPECT_EQ(model.order, l) << index;
      EXPECT_TRUE(model.sources.empty()) << index;
      EXPECT_LT(model.residual(), 2e-3) << index;
      for (int i = 1; i < kShCount; ++i) {
        EXPECT_NEAR(model.coefficients[i].x, i == index ? 0.5 : 0, 1e-3) << index << " " << i;
      }
    }
  }
}

TEST(Light, SunAndRestAreTheWhole) {
  const Environment whole = paint(512, sunny, 4);
  const SunsAndRest parts = take_suns(whole);
  ASSERT_EQ(parts.suns.size(), 1u);
  const glm::vec3 mean = parts.rest.mean() + parts.suns[0].irradiance / 4.0f;
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / whole.mean()[c], 1, 1e-4);
  for (const glm::vec3& texel : parts.rest.map()->pixels) EXPECT_LT(texel.z, 1.4f);
}

TEST(Light, FindsADisc) {
  for (const int width : {128, 512}) {
    const Environment env = paint(width, sunny, 2048 / width);
    const Light model = model_light(env, glm::mat3(1));
    ASSERT_EQ(model.sources.size(), 1u) << width;
    const DistantSource& sun = sun_of(model);
    EXPECT_LT(glm::degrees(glm::distance(sun.direction, kSunDirection)), 0.3) << width;
    // The painted disc has the steps of its samples: 2 % off its area, 0.5 % off what was painted.
    EXPECT_NEAR(sun.irradiance.x / (3000 * kSunRadius * kSunRadius), 1, 0.02) << width;
    const glm::vec3 painted = 4.0f * (env.mean() - paint(width, clear, 2048 / width).mean());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.irradiance[c] / painted[c], 1, 5e-3) << width;
    if (width == 512) {
      EXPECT_NEAR(glm::degrees(sun.angular_radius), 1, 0.15);
    }
    EXPECT_GE(sun.angular_radius, kPi / float(width));
  }
}

TEST(Light, TakesSunsAndSoftBoxesStrongestFirst) {
  const glm::vec3 weak(0, 1, 0), strong(0, 0, 1), soft(-1, 0, 0);  // one at a pole
  const Light model =
      model_light(paint(256,
                        [&](const glm::vec3& d) {
                          if (glm::distance(d, weak) < 0.02f) return glm::vec3(700);
                          if (glm::distance(d, strong) < 0.02f) return glm::vec3(2000);
                          return glm::vec3(glm::distance(d, soft) < 0.25f ? 20.0f : 0.5f);
                        }),
                  glm::mat3(1));
  ASSERT_EQ(model.sources.size(), 3u);
  EXPECT_LT(glm::distance(sun_of(model).direction, soft), 0.005);
  EXPECT_LT(glm::distance(sun_of(model, 1).direction, strong), 0.005);
  EXPECT_LT(glm::distance(sun_of(model, 2).direction, weak), 0.005);
  EXPECT_NEAR(sun_of(model).angular_radius, 0.25, 0.015);
}

TEST(Light, IrradianceIsThatOfEveryTexel) {
  // A soft box, which is a source, and half a bright sky, which is none.
  const Environment box = paint(256, [](const glm::vec3& d) {
    return glm::vec3(d.x > 0.8f && std::abs(d.y) < 0.3f ? 4.0f : 0.3f);
  });
  const Environment half =
      paint(256, [](const glm::vec3& d) { return glm::vec3(d.x > 0.1f * d.z ? 2.0f : 0.3f); });
  EXPECT_EQ(take_suns(box).suns.size(), 1u);
  EXPECT_TRUE(take_suns(half).suns.empty());
  for (const Environment& env : {box, half}) {
    const Light model = model_light(env, glm::mat3(1));
    const TexelSum exact(env);
    std::mt19937 random(3);
    for (int i = 0; i < 30; ++i) {
      const glm::vec3 n = random_direction(random);
      EXPECT_NEAR(model.unoccluded({}, n).x, exact(n).x, 1e-3);
      if (model.sources.empty()) {
        EXPECT_NEAR(model.irradiance(n).x, exact(n).x, 1e-3);
      }
    }
  }
}

TEST(Light, TurnsWithTheEnvironmentAndTheCamera) {
  const glm::mat3 turn = glm::mat3(glm::rotate(glm::mat4(1), glm::radians(37.0f), {0, 0, 1}));
  const glm::mat3 camera =
      glm::mat3(glm::rotate(glm::mat4(1), 0.8f, glm::normalize(glm::vec3(1, 2, -1))));
  const Light still = model_light(paint(256, sunny, 4), glm::mat3(1));
  const Light turned = model_light(paint(256, sunny, 4, 37), camera);
  ASSERT_EQ(turned.sources.size(), 1u);
  EXPECT_LT(glm::distance(sun_of(turned).direction, camera * turn * sun_of(still).direction), 1e-4);
  EXPECT_EQ(turned.order, still.order);
  EXPECT_NEAR(turned.residual(), still.residual(), 1e-3);
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const glm::vec3 n = random_direction(random), there = camera * turn * n;
    EXPECT_LT(glm::distance(turned.irradiance(there), still.irradiance(n)), 1e-3);
    glm::vec3 here(0), elsewhere(0);
    for (int k = 0; k < kShCount; ++k) {
      here += sh_basis(n)[k] * still.coefficients[k];
      elsewhere += sh_basis(there)[k] * turned.coefficients[k];
    }
    EXPECT_LT(glm::distance(here, elsewhere), 2e-3);
  }
}

TEST(Light, IsTheSameInAnyExposureButForItsBrightness) {
  constexpr float kStops = 20;
  const Environment usual = paint(512, sunny);
  const Environment dim(usual.map(), {.up = UpAxis::z, .exposure_stops = -kStops});
  const Light bright_light = model_light(usual, glm::mat3(1)),
              dim_light = model_light(dim, glm::mat3(1));
  EXPECT_EQ(bright_light.order, dim_light.order);
  for (int i = 0; i < kShCount; ++i)
    EXPECT_EQ(bright_light.coefficients[i], std::exp2(kStops) * dim_light.coefficients[i]) << i;
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const glm::vec3 n = random_direction(random);
    EXPECT_EQ(bright_light.unoccluded({}, n), std::exp2(kStops) * dim_light.unoccluded({}, n));
  }
}

TEST(Light, StaysFiniteForAnyMap) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  const auto noise = [&](const glm::vec3&) {
    return 10.0f * glm::vec3(normal(random), normal(random), normal(random));
  };
  const auto black = [](const glm::vec3&) { return glm::vec3(0); };
  const auto negative = [](const glm::vec3& d) { return -sunny(d); };
  const auto lobes = [](const glm::vec3& d) { return sunny(d) - glm::vec3(0.5f, 2, 0); };
  // Below the least float that has a reciprocal.
  const auto dim = [](const glm::vec3& d) { return 1e-40f * sunny(d); };
  const auto faintest = [](const glm::vec3& d) {
    return d.z > 0.9f ? glm::vec3(1.5e-45f) : d * 0.0f;
  };
  for (const int width : {2, 6, 64, 300}) {
    for (const auto& radiance : std::initializer_list<std::function<glm::vec3(const glm::vec3&)>>{
             noise, black, negative, lobes, dim, faintest}) {
      const Light model = model_light(paint(width, radiance), glm::mat3(1));
      for (const glm::vec3& c : model.coefficients) EXPECT_TRUE(std::isfinite(c.x + c.y + c.z));
      for (const double share : model.band_energy) {
        EXPECT_GE(share, 0) << width;
        EXPECT_LT(share, 1.01) << width;  // the dimmest floats are rounded by as much
      }
      EXPECT_TRUE(std::isfinite(model.residual()));
      for (const auto& source : model.sources) {
        const DistantSource& sun = *source->distant();
        EXPECT_GE(std::min({sun.irradiance.x, sun.irradiance.y, sun.irradiance.z}), 0);
        EXPECT_NEAR(glm::length(sun.direction), 1, 1e-5);
      }
      const glm::vec3 e = model.irradiance(random_direction(random));
      EXPECT_TRUE(std::isfinite(e.x + e.y + e.z));
    }
  }
}

}  // namespace
}  // namespace ssdo::test::light_test
