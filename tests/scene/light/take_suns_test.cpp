// SPDX-License-Identifier: Apache-2.0
//
// Which sources are found in a map, and that they and the rest are its light.
#include "scene/light/take_suns.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "math/spherical_harmonics.h"
#include "scene/light/light.h"
#include "scene/light/painted_map.h"
#include "support/sun_of.h"

namespace ssdo::test::take_suns_test {
namespace {

constexpr float kPi = glm::pi<float>();

glm::vec3 dim(const glm::vec3& d) { return (1.3f + d.z) * glm::vec3(0.15f, 0.2f, 0.3f); }

/// A disc that gives a surface facing it 1.5 times what the sky does, or the sky.
glm::vec3 disc_or_sky(const glm::vec3& d, const glm::vec3& middle, float radius) {
  const float sine = std::sin(glm::radians(radius));
  return in_disc(d, middle, radius) ? glm::vec3(0.5f, 0.45f, 0.4f) / (sine * sine) : dim(d);
}

/// Normals that put the horizon at all places in and around a source.
template <class Visit>
void for_each_elevation(const DistantSource& sun, const Visit& visit) {
  const glm::vec3 side = glm::normalize(glm::cross(sun.direction, {0.3f, 0.5f, -0.8f}));
  for (int i = -9; i <= 9; ++i) {
    const float e = 1.3f * sun.angular_radius * float(i) / 9;
    visit(std::cos(e) * side + std::sin(e) * sun.direction);
  }
  visit(sun.direction);
}

/// The light of all sources and the rest against every texel, at the horizon of each source and
/// elsewhere: the largest error, relative to what a surface gets that faces the first.
double unoccluded_error(const Environment& map) {
  const Light light = model_light(map, glm::mat3(1));
  const TexelSum exact(map);
  const glm::dvec3 most = exact(sun_of(light).direction);
  double worst = 0;
  const auto compare = [&](const glm::vec3& n) {
    const glm::dvec3 off = (glm::dvec3(light.unoccluded({}, n)) - exact(n)) / most;
    worst = std::max({worst, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
  };
  for (const auto& source : light.sources) for_each_elevation(*source->distant(), compare);
  std::mt19937 random(7);
  for (int i = 0; i < 20; ++i) compare(random_direction(random));
  return worst;
}

/// Sources and rest conserve the light of a map, and the rest is nowhere brighter than the map.
void expect_whole(const Environment& map) {
  const SunsAndRest parts = take_suns(map);
  glm::dvec3 taken(0);
  for (int y = 0; y < map.map()->height; ++y) {
    for (int x = 0; x < map.map()->width; ++x) {
      const glm::vec3 part = (*map.map())(x, y) - (*parts.rest.map())(x, y);
      ASSERT_GE(std::min({part.x, part.y, part.z}), 0);
      taken += glm::dvec3(part * map.texel_solid_angle(y) / kPi);
    }
  }
  // The length of a vector sum is a little less than the sum of lengths: undone by the mean cosine.
  glm::dvec3 found(0);
  for (const DistantSource& sun : parts.suns) {
    double cosines = 0;
    for (int i = 0; i < 4096; ++i)
      cosines += double(glm::dot(
          sun.direction, sun.point({(float(i % 64) + 0.5f) / 64, (float(i / 64) + 0.5f) / 64})));
    found += glm::dvec3(sun.irradiance) * (4096 / cosines);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / taken[c], 1, 1e-3);
}

TEST(TakeSuns, FindsDiscsOfAnySize) {
  for (const float radius : {0.27f, 1.0f, 4.5f, 5.5f, 7.0f, 10.0f, 15.0f, 20.0f}) {
    const glm::vec3 middle = direction_of(35, 28);
    const auto sky = [&](const glm::vec3& d) { return disc_or_sky(d, middle, radius); };
    const int samples = radius < 2 ? 8 : 2;
    const Environment map = paint(radius < 2 ? 1024 : 512, sky, samples);
    const SunsAndRest parts = take_suns(map);
    ASSERT_EQ(parts.suns.size(), 1u) << radius;
    const DistantSource& sun = parts.suns[0];
    const float texel = 360.0f / float(map.map()->width);
    EXPECT_LT(glm::degrees(glm::distance(sun.direction, middle)), 0.02 + 0.01 * radius) << radius;
    EXPECT_NEAR(glm::degrees(sun.angular_radius), std::max(radius, texel / 2), texel) << radius;
    // Unlike the sum over the sky that it replaces, the disc in closed form: radiance sin^2.
    const float sine = std::sin(glm::radians(radius));
    const glm::vec3 expected = glm::vec3(0.5f, 0.45f, 0.4f) - sine * sine * dim(middle);
    const float tolerance = radius < 2 ? 0.03f : 0.01f;  // of a painted disc's area
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.irradiance[c], expected[c], tolerance) << radius;
    // What is left is the sky.
    float off = 0;
    for (int y = 0; y < map.map()->height; ++y) {
      for (int x = 0; x < map.map()->width; ++x) {
        const glm::vec3 left = (*parts.rest.map())(x, y) - dim(map.texel_direction(x, y));
        off = std::max({off, std::abs(left.x), std::abs(left.y), std::abs(left.z)});
      }
    }
    EXPECT_LT(off, 0.03) << radius;
    EXPECT_NEAR(sun.share, 0.5f / 0.85f, 0.15f) << radius;
    EXPECT_GT(sun.sh_fraction, radius < 5 ? 0 : 0.02);
    EXPECT_LT(sun.sh_fraction, radius < 5 ? 0.1 : 0.7);
    expect_whole(map);
    const double error = unoccluded_error(map);
    fmt::print("disc of {:.2f} degrees: unoccluded off by {:.1e}, {:.2f} held by harmonics\n",
               radius, error, sun.sh_fraction);
    EXPECT_LT(error, 1e-3) << radius;
  }
}

TEST(TakeSuns, FindsRectangles) {
  for (const glm::vec2& size : {glm::vec2(20, 12), glm::vec2(50, 40), glm::vec2(60, 8)}) {
    const glm::vec3 middle = direction_of(-50, 20);
    const Environment map = paint(
        512,
        [&](const glm::vec3& d) {
          return in_rectangle(d, middle, size.x, size.y) ? glm::vec3(6) : dim(d);
        },
        2);
    const SunsAndRest parts = take_suns(map);
    ASSERT_EQ(parts.suns.size(), 1u) << size.x;
    EXPECT_NEAR(glm::degrees(parts.suns[0].extent.x), size.x, 0.05 * size.x);
    EXPECT_NEAR(glm::degrees(parts.suns[0].extent.y), size.y, 0.05 * size.y);
    EXPECT_NEAR(glm::degrees(parts.suns[0].angular_radius), glm::length(size) / 2, 0.08 * size.x);
    expect_whole(map);
    const double error = unoccluded_error(map);
    fmt::print("rectangle {} x {}: unoccluded off by {:.1e}\n", size.x, size.y, error);
    EXPECT_LT(error, 1e-3);
  }
}

TEST(TakeSuns, FindsSeveralStrongestFirst) {
  std::vector<glm::vec3> middles;
  for (int i = 0; i < 8; ++i) middles.push_back(direction_of(float(45 * i), i % 2 ? 40 : -25));
  const SunsAndRest parts = take_suns(paint(512, [&](const glm::vec3& d) {
    for (std::size_t i = 0; i < middles.size(); ++i)
      if (in_disc(d, middles[i], i % 3 ? 3 : 8)) return glm::vec3(float(10 + i) / (i % 3 ? 1 : 7));
    return glm::vec3(0.01f);
  }));
  ASSERT_EQ(parts.suns.size(), 8u);
  for (std::size_t i = 1; i < 8; ++i)
    EXPECT_GE(brightness(parts.suns[i - 1].irradiance), brightness(parts.suns[i].irradiance));
  for (const glm::vec3& middle : middles) {
    EXPECT_TRUE(std::any_of(parts.suns.begin(), parts.suns.end(), [&](const DistantSource& sun) {
      return glm::distance(sun.direction, middle) < 0.01f;
    }));
  }
}

TEST(TakeSuns, TellsTwoApartThatAreClose) {
  // Discs of 3 degrees with a gap of 1.4 degrees: two to four texels.
  const glm::vec3 left = direction_of(0, 10), right = direction_of(7.5f, 10);
  for (const float second : {40.0f, 15.0f}) {
    const Environment map = paint(512, [&](const glm::vec3& d) {
      if (in_disc(d, left, 3)) return glm::vec3(40);
      return in_disc(d, right, 3) ? glm::vec3(second) : dim(d);
    });
    const SunsAndRest parts = take_suns(map);
    ASSERT_EQ(parts.suns.size(), 2u) << second;
    const bool swapped = glm::distance(parts.suns[0].direction, left) > 0.06f;
    EXPECT_LT(glm::distance(parts.suns[swapped].direction, left), 0.01) << second;
    EXPECT_LT(glm::distance(parts.suns[!swapped].direction, right), 0.01) << second;
    for (const DistantSource& sun : parts.suns)
      EXPECT_NEAR(glm::degrees(sun.angular_radius), 3, 0.6);
    expect_whole(map);
    EXPECT_LT(unoccluded_error(map), 1e-3);
  }
}

TEST(TakeSuns, FindsThemAcrossTheDateLineAndAtThePoles) {
  for (const glm::vec3& middle : {direction_of(180, 5), direction_of(0, 90), direction_of(20, -90),
                                  direction_of(60, 84), direction_of(179, -50)}) {
    for (const float radius : {1.0f, 10.0f}) {
      const Environment map = paint(
          512, [&](const glm::vec3& d) { return disc_or_sky(d, middle, radius); }, 4);
      const SunsAndRest parts = take_suns(map);
      ASSERT_EQ(parts.suns.size(), 1u) << middle.z;
      EXPECT_LT(glm::distance(parts.suns[0].direction, middle), 2e-3) << middle.z;
      EXPECT_NEAR(glm::degrees(parts.suns[0].angular_radius), radius, 0.7) << middle.z;
      expect_whole(map);
      EXPECT_LT(unoccluded_error(map), 1e-3) << middle.z << " " << radius;
    }
  }
}

TEST(TakeSuns, ASunLeavesTheGradientBehindIt) {
  // A sky that brightens fivefold across the source, as at the edge of dusk.
  const glm::vec3 middle = direction_of(10, 15);
  const auto dusk = [](const glm::vec3& d) { return glm::vec3(0.3f + 1.2f * (d.z + 0.1f)); };
  const auto sky = [&](const glm::vec3& d) {
    return glm::max(in_disc(d, middle, 8) ? glm::vec3(20) : glm::vec3(0), dusk(d));
  };
  const Environment map = paint(512, sky, 2);
  const SunsAndRest parts = take_suns(map);
  ASSERT_EQ(parts.suns.size(), 1u);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 512; ++x) {
      const glm::vec3 d = map.texel_direction(x, y);
      if (in_disc(d, middle, 12)) {
        ASSERT_NEAR((*parts.rest.map())(x, y).x, dusk(d).x, 0.06) << x << " " << y;
      }
    }
  }
  EXPECT_LT(unoccluded_error(map), 1e-3);
}

TEST(TakeSuns, ASmallSunHasItsTexelInAMapOfAnySize) {
  for (const int width : {64, 1024, 2048, 8192}) {
    auto texels = std::make_shared<Plane<glm::vec3>>(width, width / 2, glm::vec3(0.2f));
    const int x = width / 3, y = width / 7;
    const Environment flat(texels, {});
    const float solid_angle = flat.texel_solid_angle(y);
    (*texels)(x, y) = glm::vec3(0.2f + kPi / solid_angle);
    const SunsAndRest parts = take_suns(Environment(texels, {}));
    ASSERT_EQ(parts.suns.size(), 1u) << width;
    EXPECT_LT(glm::distance(parts.suns[0].direction, flat.texel_direction(x, y)), 1e-5) << width;
    EXPECT_NEAR(parts.suns[0].angular_radius, kPi / float(width), 1e-3 / width) << width;
    EXPECT_NEAR(parts.suns[0].irradiance.x, 1, 1e-3) << width;
    EXPECT_NEAR((*parts.rest.map())(x, y).x, 0.2f, 1e-4) << width;
  }
}

TEST(TakeSuns, ASourceIsTakenLittleByLittleAsItGrows) {
  // A disc before a sky that gives 1.
  constexpr float kStep = 0.0025f;
  for (const float radius : {2.0f, 10.0f}) {
    const glm::vec3 middle = direction_of(70, 40);
    const float sine = std::sin(glm::radians(radius));
    float before = 0, most = 0;
    for (int i = 4; i <= 48; ++i) {
      const float strength = kStep * float(i);
      const Environment map = paint(128, [&](const glm::vec3& d) {
        return glm::vec3(in_disc(d, middle, radius) ? 1 + strength / (sine * sine) : 1);
      });
      float taken = 0;
      for (const DistantSource& sun : take_suns(map).suns) taken += brightness(sun.irradiance);
      if (i == 4) {
        EXPECT_EQ(taken, 0) << radius;
      }
      if (i == 48) {
        EXPECT_NEAR(taken, strength, 0.15f * strength) << radius;
        expect_whole(map);
      }
      if (i == 20) expect_whole(map);
      most = std::max(most, std::abs(taken - before));
      before = taken;
    }
    fmt::print("a source that grows by {}: what is taken grows by {:.4f} at most\n", kStep, most);
    EXPECT_LT(most, 5 * kStep) << radius;
  }
}

/// A bright band of so many degrees along the great circle around a pole.
Environment band(float width, const glm::vec3& pole) {
  const float edge = std::sin(glm::radians(width / 2));
  return paint(
      256,
      [&](const glm::vec3& d) {
        return glm::vec3(std::abs(glm::dot(d, pole)) < edge ? 3.0f : 0.02f);
      },
      2);
}

TEST(TakeSuns, TakesALongBandInPieces) {
  for (const glm::vec3& pole : {glm::vec3(0, 0, 1), direction_of(30, 20)}) {
    for (const float width : {4.0f, 10.0f}) {
      const Environment map = band(width, pole);
      const SunsAndRest parts = take_suns(map);
      EXPECT_GE(parts.suns.size(), 5u);
      EXPECT_LE(parts.suns.size(), 6u);
      for (const DistantSource& sun : parts.suns) EXPECT_LT(glm::degrees(sun.angular_radius), 42);
      float most = 0;
      for (const glm::vec3& left : parts.rest.map()->pixels) most = std::max(most, left.x);
      EXPECT_LT(most, 0.03) << "all of it is taken";
      expect_whole(map);
      EXPECT_LT(unoccluded_error(map), 2e-3);
    }
  }
}

TEST(TakeSuns, TakesLessAndLessOfWiderBands) {
  float before = 0;
  for (float width = 10; width <= 20; width += 1) {
    float most = 0;
    for (const DistantSource& sun : take_suns(band(width, direction_of(30, 20))).suns)
      most = std::max(most, sun.share);
    fmt::print("a band of {} degrees: {:.3f} of the light of what faces it\n", width, most);
    if (width == 10) {
      EXPECT_GT(most, 0.5);
    } else {
      EXPECT_LT(before - most, 0.1);
    }
    before = most;
  }
  EXPECT_EQ(before, 0);
}

TEST(TakeSuns, LeavesWhatHarmonicsHold) {
  const auto smooth = [](float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  const std::initializer_list<Radiance> skies = {
      dim,
      [&](const glm::vec3& d) { return glm::vec3(0.1f + smooth(-0.3f, 0.3f, d.x)); },
      [&](const glm::vec3& d) { return glm::vec3(0.1f + smooth(-0.05f, 0.0f, d.z)); },
      [](const glm::vec3& d) { return glm::vec3(d.z > 0 ? 1 : 0); },
      [](const glm::vec3& d) { return glm::vec3(0.5f + std::pow(std::max(0.0f, d.y), 8.0f)); },
      [](const glm::vec3& d) { return glm::vec3(1 + 0.5f * sh_basis(d)[20]); },
      [](const glm::vec3&) { return glm::vec3(0); }};
  int number = 0;
  for (const Radiance& sky : skies) {
    EXPECT_TRUE(take_suns(paint(256, sky, 2)).suns.empty()) << number;
    ++number;
  }
}

}  // namespace
}  // namespace ssdo::test::take_suns_test
