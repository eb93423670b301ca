// SPDX-License-Identifier: Apache-2.0
#include "estimators/sao.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "estimators/obscurance_request.h"
#include "estimators/view_space/slow_depth_mips.h"

namespace ssdo::test::sao_test {
namespace {

const Window kWindow{0, 0, 96, 72};

/// The authors' sum in double, tap by tap, with their (R^2 - v.v)^3 over R^6.
struct SlowSao {
  const Geometry& g;
  double radius;
  int samples = 11, turns = 7;
  double intensity = 1, bias = 0.01, epsilon = 0.01;
  unsigned seed = 0;
  bool doubtful = false;  ///< whether rounding may have moved a tap of the latest pixel

  double ao(int x, int y) {
    doubtful = false;
    const Surfel& s = g.surfaces(x, y);
    const glm::dvec3 p(s.position), n(s.normal);
    const int column = x + g.window.x0 - g.display.x0, row = y + g.window.y0 - g.display.y0;
    const double spin = 10.0 * unsigned((3 * column) ^ (row + column * row)) +
                        glm::two_pi<double>() * std::fmod(seed * 0.7548776662466927, 1);
    const double start = std::fmod(0.5 + seed * 0.5698402909980532, 1);
    const double disc = g.camera.fy * radius / (g.camera.orthographic ? 1 : -p.z);
    const double r2 = radius * radius, b = bias * radius + double(s.rounding);
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
      const double alpha = (i + start) / samples,
                   angle = alpha * turns * glm::two_pi<double>() + spin;
      const double dx = alpha * disc * std::cos(angle) * g.camera.fx / g.camera.fy,
                   dy = alpha * disc * std::sin(angle), level = std::log2(alpha * disc);
      for (const double number : {dx, dy, level})
        doubtful |= std::abs(number - std::round(number)) < 2e-3;
      const int qx = x + int(dx), qy = y + int(dy);
      if (qx < 0 || qy < 0 || qx >= g.window.width() || qy >= g.window.height()) continue;
      const int mip = std::clamp(int(std::floor(level)) - 3, 0, 5);
      const double z = double(slow_mip(g, mip, int(std::floor(std::ldexp(column + int(dx), -mip))),
                                       int(std::floor(std::ldexp(row + int(dy), -mip)))));
      if (std::isinf(z)) continue;
      const glm::dvec3 v =
          g.camera.unproject({qx + g.window.x0 + 0.5, qy + g.window.y0 + 0.5}, -z) - p;
      const double vv = glm::dot(v, v), f = std::max(r2 - vv, 0.0);
      sum += f * f * f * std::max(glm::dot(v, n) - b, 0.0) / (vv + epsilon * r2);
    }
    // The authors' intensity has the unit of a length.
    return std::max(0.0, 1 - 5 * intensity * radius / (samples * std::pow(radius, 6)) * sum);
  }
};

/// Compares all pixels of which no tap is doubtful; gives the least ao.
double expect_the_slow_sum(const Geometry& g, SlowSao slow, const Products& out) {
  double least = 1;
  int compared = 0;
  for (int y = 0; y < out.ao.height; y += 2) {
    for (int x = 0; x < out.ao.width; x += 2) {
      if (!g.is_surface(out.ao.index(x, y))) continue;
      const double expected = slow.ao(x, y);
      if (slow.doubtful) continue;
      EXPECT_NEAR(out.ao(x, y), expected, 3e-4) << x << "," << y;
      least = std::min(least, expected), ++compared;
    }
  }
  EXPECT_GT(compared, int(out.ao.size() / 8)) << "half of the pixels that are looked at";
  return least;
}

TEST(Sao, IsTheAuthorsSum) {
  for (const bool orthographic : {false, true}) {
    for (const double aspect : {1.0, 2.0}) {
      const Camera projection = orthographic ? camera_from_ortho_width(4, kWindow, aspect)
                                             : camera_from_fov(50, kWindow, aspect);
      const Geometry g = geometry_of(
          still_life(), look_at(projection, {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}), kWindow);
      for (const double radius : {0.2, 0.7, 3.0}) {
        SCOPED_TRACE(testing::Message() << orthographic << " " << aspect << " " << radius);
        const double least =
            expect_the_slow_sum(g, {g, radius}, obscure(sao_method(), g, float(radius)));
        EXPECT_LT(least, 0.3);
      }
    }
  }
}

TEST(Sao, ItsParametersAreThoseOfTheSum) {
  const Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, kWindow, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      kWindow);
  expect_the_slow_sum(
      g, {g, 0.6, 23, 5, 0.4, 0.05, 0.002},
      obscure(sao_method(), g, 0.6f,
              {"samples=23", "turns=5", "intensity=0.4", "bias=0.05", "epsilon=0.002"}));
}

TEST(Sao, SeedsTurnTheSpiralsAndMoveTheTapsAlongThem) {
  const Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, kWindow, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      kWindow);
  for (const unsigned seed : {1u, 2u, 1001u}) {
    SCOPED_TRACE(seed);
    SlowSao slow{g, 0.7};
    slow.seed = seed;
    expect_the_slow_sum(g, slow, run(sao_method(), g, {.radius = 0.7f, .seed = seed}));
  }
}

TEST(Sao, TheUnitOfTheSceneDoesNotMatter) {
  Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, kWindow, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      kWindow);
  const Products metres = obscure(sao_method(), g, 0.5f);
  g.surfaces.change_each([&](Surfel& s) { s.position *= 128, s.rounding *= 128; });
  const Products other = obscure(sao_method(), g, 64);
  EXPECT_LT(*std::min_element(other.ao.pixels.begin(), other.ao.pixels.end()), 0.5f);
  for (std::size_t i = 0; i < other.ao.size(); ++i) EXPECT_NEAR(other.ao[i], metres.ao[i], 1e-5);
}

TEST(Sao, AnOpenPlaneReadsOneWhileItsTapsReadFullResolution) {
  // The disc is at most 15 pixels wide: level 0.
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
      const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow);
      float nearest = 1e9f;
      for (const Surfel& s : g.surfaces)
        if (s.is_surface()) nearest = std::min(nearest, -s.position.z);
      const float radius = 15 / float(g.camera.fy) * (g.camera.orthographic ? 1 : nearest);
      for (const float ao : obscure(sao_method(), g, radius).ao.pixels) EXPECT_EQ(ao, 1) << tilt;
    }
  }
}

TEST(Sao, WhatRoundingMovedDoesNotHide) {
  Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(60, kWindow, 1), 0), kWindow);
  std::mt19937 random(1);
  const float step = 1.0f / 256;  // half floats from 4 to 8 units
  g.surfaces.change_each([&](Surfel& s) {
    s.position.z += (float(random() % 1024) / 1024 - 0.5f) * step, s.rounding = step;
  });
  for (const float ao : obscure(sao_method(), g, 0.2f).ao.pixels) EXPECT_EQ(ao, 1);
  g.surfaces.change_each([&](Surfel& s) { s.rounding = 0; });
  EXPECT_LT(obscure(sao_method(), g, 0.2f).ao(48, 36), 1) << "not even without knowing of it";
}

TEST(Sao, ATiltedPlaneHidesItselfWhereTapsReadCoarseLevels) {
  // The known fault: at 10 degrees the bias covers it, at 50 it does not.
  const Camera projection = camera_from_fov(60, kWindow, 1);
  const auto self_obscurance = [&](double tilt) {
    const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow);
    const Products out = obscure(sao_method(), g, 4);
    expect_the_slow_sum(g, {g, 4}, out);
    double sum = 0;
    for (const float ao : out.ao.pixels) sum += 1 - ao;
    return sum / double(out.ao.size());
  };
  EXPECT_EQ(self_obscurance(0), 0);
  EXPECT_LT(self_obscurance(10), 1e-6);
  EXPECT_GT(self_obscurance(50), 1e-3);
  for (const double tilt : {20, 30, 40, 50, 60, 70, 80})
    EXPECT_LT(self_obscurance(tilt), 2e-3) << tilt;
}

TEST(Sao, ADistantForegroundDoesNotOcclude) {
  const Surface strip =
      cut(plane({0, 0, 4}, {0, 0, 1}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.1; });
  const Geometry g = geometry_of(all_of({plane({}, {0, 0, 1}), strip}),
                                 tilted(camera_from_fov(60, kWindow, 1), 0), kWindow);
  for (const float ao : obscure(sao_method(), g, 1).ao.pixels) EXPECT_EQ(ao, 1);
  const Products reached = obscure(sao_method(), g, 8);
  EXPECT_LT(*std::min_element(reached.ao.pixels.begin(), reached.ao.pixels.end()), 0.9f)
      << "within the radius it would";
}

TEST(Sao, ConstantLightIsThatColourTimesAo) {
  const Geometry g =
      geometry_of(still_life(), tilted(camera_from_fov(40, kWindow, 1), 50), kWindow);
  const glm::vec3 color(0.25f, 1, 8);
  const Products out = obscure(sao_method(), g, 1, {}, Environment::constant(color));
  for (std::size_t i = 0; i < out.ao.size(); ++i)
    EXPECT_EQ(out.direct[i], g.is_surface(i) ? out.ao[i] * color : glm::vec3(0));
}

TEST(Sao, InstructionSetsAndThreadsDoNotMatter) {
  const Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, kWindow, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      kWindow);
  const auto ao = [&] { return obscure(sao_method(), g, 0.8f).ao; };
  expect_the_same_from_every_isa(ao);
  expect_the_same_from_any_threads(ao);
}

TEST(Sao, ACropFarEnoughInsideIsThatPartOfTheWhole) {
  const Window window{-20, 7, 230, 197}, part{13, 40, 220, 190};
  const Geometry g = geometry_of(
      still_life(), look_at(camera_from_fov(50, window, 1), {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
      window);
  const float radius = 0.5f;
  const Products whole = obscure(sao_method(), g, radius),
                 cropped = obscure(sao_method(), crop(g, part), radius);
  int compared = 0;
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x) {
      const int wx = x + part.x0 - window.x0, wy = y + part.y0 - window.y0;
      const double disc = g.camera.fy * radius / double(-g.surfaces(wx, wy).position.z);
      const double margin = disc + 32;
      if (x < margin || y < margin || x >= part.width() - margin || y >= part.height() - margin)
        continue;
      ASSERT_EQ(cropped.ao(x, y), whole.ao(wx, wy)) << x << "," << y;
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(Sao, FramesOfAnySize) {
  for (const Window& window : {Window{0, 0, 1, 1}, Window{0, 0, 1, 41}, Window{0, 0, 37, 1},
                               Window{0, 0, 17, 3}, Window{-5, -9, 60, 22}}) {
    const Geometry g =
        geometry_of(still_life(), tilted(camera_from_fov(40, window, 1), 40), window);
    expect_usable(obscure(sao_method(), g, 1));
    expect_usable(obscure(sao_method(), g, 1e4f));
  }
}

TEST(Sao, NothingThatComesInMakesANaN) {
  const Geometry g = broken_geometry();
  for (const float radius : {1e-30f, 1e-6f, 1.0f, 1e6f, 1e30f}) {
    SCOPED_TRACE(radius);
    expect_usable(obscure(sao_method(), g, radius));
    expect_usable(obscure(sao_method(), g, radius, {"bias=0", "epsilon=1e-6", "samples=1"}));
  }
}

}  // namespace
}  // namespace ssdo::test::sao_test
