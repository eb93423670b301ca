// SPDX-License-Identifier: Apache-2.0
#include "estimators/hbao.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "estimators/obscurance_request.h"

namespace ssdo::test::hbao_test {
namespace {

const Window kWindow{0, 0, 96, 72};

/// The listing's loop in double, tap by tap.
struct SlowHbao {
  const Geometry& g;
  double radius;
  int steps = 3;
  double bias = 0.05, strength = 1, least = 0.1, largest = 128;
  bool doubtful = false;  ///< whether rounding may have moved a tap of the latest pixel

  double ao(int x, int y) {
    doubtful = false;
    const HbaoPattern pattern = hbao_pattern(0);
    const Surfel& s = g.surfaces(x, y);
    const glm::dvec3 p(s.position), n(s.normal);
    const int column = x + g.window.x0 - g.display.x0, row = y + g.window.y0 - g.display.y0;
    const std::size_t cell = std::size_t((row & 3) * 4 + (column & 3));
    const double disc = g.camera.fy * radius / (g.camera.orthographic ? 1 : -p.z),
                 step = std::min(disc, largest) / (steps + 1.0);
    double sum = 0;
    for (const double degrees : {0.0, 120.0, 240.0, 90.0}) {
      const double angle =
          glm::radians(degrees) + double(pattern.turn[cell]) * glm::two_pi<double>();
      double pixels = double(pattern.jitter[cell]) * step + 1;
      for (int i = 0; i < steps; ++i, pixels += step) {
        const double dx = pixels * std::cos(angle) * g.camera.fx / g.camera.fy,
                     dy = pixels * std::sin(angle);
        for (const double offset : {dx, dy})
          doubtful |= std::abs(offset - std::floor(offset) - 0.5) < 1e-3;
        const int qx = x + int(std::lround(dx)), qy = y + int(std::lround(dy));
        if (qx < 0 || qy < 0 || qx >= g.window.width() || qy >= g.window.height()) continue;
        const Surfel& q = g.surfaces(qx, qy);
        if (!q.is_surface()) continue;
        const glm::dvec3 v = glm::dvec3(q.position) - p;
        const double vv = std::max(glm::dot(v, v), least * least * radius * radius);
        const double sine = (glm::dot(v, n) - double(s.rounding)) / std::sqrt(vv);
        sum += std::clamp(sine - bias, 0.0, 1.0) * std::clamp(1 - vv / (radius * radius), 0.0, 1.0);
      }
    }
    return std::clamp(1 - 2 * strength / (1 - bias) / (4 * steps) * sum, 0.0, 1.0);
  }
};

Geometry still(const Camera& projection) {
  return geometry_of(still_life(), look_at(projection, {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
                     kWindow);
}

/// Compares all pixels of which no tap is doubtful; gives the least ao.
template <class Slow>
double expect_the_slow_sum(const Geometry& g, Slow slow, const Products& out) {
  double least = 1;
  int compared = 0;
  for (int y = 0; y < out.ao.height; ++y) {
    for (int x = 0; x < out.ao.width; ++x) {
      if (!g.is_surface(out.ao.index(x, y))) continue;
      const double expected = slow.ao(x, y);
      if (slow.doubtful) continue;
      EXPECT_NEAR(out.ao(x, y), expected, 3e-4) << x << "," << y;
      least = std::min(least, expected), ++compared;
    }
  }
  EXPECT_GT(compared, int(out.ao.size() / 3));
  return least;
}

TEST(Hbao, IsTheListingsSum) {
  for (const bool orthographic : {false, true}) {
    for (const double aspect : {1.0, 2.0}) {
      const Geometry g = still(orthographic ? camera_from_ortho_width(4, kWindow, aspect)
                                            : camera_from_fov(50, kWindow, aspect));
      for (const double radius : {0.3, 0.8}) {
        SCOPED_TRACE(testing::Message() << orthographic << " " << aspect << " " << radius);
        EXPECT_LT(expect_the_slow_sum(g, SlowHbao{g, radius},
                                      obscure(hbao_method(), g, float(radius), {"horizon=taps"})),
                  0.6);
      }
    }
  }
}

TEST(Hbao, ItsParametersAreThoseOfTheSum) {
  const Geometry g = still(camera_from_fov(50, kWindow, 1));
  expect_the_slow_sum(g, SlowHbao{g, 0.8, 5, 0.2, 0.7, 0.4, 9},
                      obscure(hbao_method(), g, 0.8f,
                              {"horizon=taps", "steps=5", "bias=0.2", "strength=0.7",
                               "least-distance=0.4", "max-pixels=9"}));
}

/// With horizon=max: the mean over directions of sin h - sin t, tap by tap in double.
struct SlowHorizons {
  const Geometry& g;
  double radius;
  int steps = 3;
  double bias = 0.05, strength = 1;
  bool doubtful = false;

  double ao(int x, int y) {
    doubtful = false;
    const HbaoPattern pattern = hbao_pattern(0);
    const Surfel& s = g.surfaces(x, y);
    const glm::dvec3 p(s.position), n(s.normal);
    const glm::dvec3 viewer = g.camera.orthographic ? glm::dvec3(0, 0, 1) : -glm::normalize(p);
    const std::size_t cell = std::size_t((y & 3) * 4 + (x & 3));
    const double disc = g.camera.fy * radius / (g.camera.orthographic ? 1 : -p.z),
                 step = std::min(disc, 128.0) / (steps + 1.0);
    double sum = 0;
    for (const double degrees : {0.0, 120.0, 240.0, 90.0}) {
      const double angle =
          glm::radians(degrees) + double(pattern.turn[cell]) * glm::two_pi<double>();
      double highest = 0;
      for (int i = 0; i < steps; ++i) {
        const double pixels = (double(pattern.jitter[cell]) + i) * step + 1;
        const double dx = pixels * std::cos(angle) * g.camera.fx / g.camera.fy,
                     dy = pixels * std::sin(angle);
        for (const double offset : {dx, dy})
          doubtful |= std::abs(offset - std::floor(offset) - 0.5) < 1e-3;
        const int qx = x + int(std::lround(dx)), qy = y + int(std::lround(dy));
        if (qx < 0 || qy < 0 || qx >= g.window.width() || qy >= g.window.height()) continue;
        if (!g.surfaces(qx, qy).is_surface()) continue;
        const glm::dvec3 v = glm::dvec3(g.surfaces(qx, qy).position) - p;
        const double lift = glm::dot(v, n) - double(s.rounding);
        doubtful |= std::abs(glm::length(v) - radius) < 1e-4;
        if (lift <= 0 || glm::length(v) >= radius) continue;
        // Down along the view ray to the tangent plane.
        const glm::dvec3 below = v - viewer * (lift / std::max(glm::dot(n, viewer), 1e-3));
        const double h = std::asin(glm::dot(glm::normalize(v), viewer)),
                     t = std::asin(glm::dot(glm::normalize(below), viewer)) + std::asin(bias);
        if (t < glm::half_pi<double>()) highest = std::max(highest, std::sin(h) - std::sin(t));
      }
      sum += highest / 4;
    }
    return std::clamp(1 - strength * sum, 0.0, 1.0);
  }
};

TEST(Hbao, HorizonsAreTheSumOfTheText) {
  for (const bool orthographic : {false, true}) {
    for (const double aspect : {1.0, 2.0}) {
      SCOPED_TRACE(testing::Message() << orthographic << " " << aspect);
      const Geometry g = still(orthographic ? camera_from_ortho_width(4, kWindow, aspect)
                                            : camera_from_fov(50, kWindow, aspect));
      EXPECT_LT(expect_the_slow_sum(g, SlowHorizons{g, 0.8},
                                    obscure(hbao_method(), g, 0.8f, {"horizon=max"})),
                0.6);
      expect_the_slow_sum(
          g, SlowHorizons{g, 0.8, 7, 0.3, 0.6},
          obscure(hbao_method(), g, 0.8f, {"horizon=max", "steps=7", "bias=0.3", "strength=0.6"}));
    }
  }
}

/// Mean of the pattern's pixels in the middle over several seeds, with taps so close that none is
/// missed.
double converged_in_the_middle(const Surface& scene, double tilt_degrees = 0, double radius = 2) {
  const Window window{0, 0, 168, 168};  // 40 pixels a unit
  const Geometry g =
      geometry_of(scene, tilted(camera_from_ortho_width(4.2, window, 1), tilt_degrees), window);
  double sum = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Products out = run(hbao_method(), g,
                             {.radius = float(radius),
                              .set = {"horizon=max", "steps=64", "bias=0", "max-pixels=1e6"},
                              .seed = seed});
    for (int y = 82; y < 86; ++y)
      for (int x = 82; x < 86; ++x) sum += double(out.ao(x, y)) / (16 * 4);
  }
  return sum;
}

TEST(Hbao, HorizonsOfAStepAreItsIntegral) {
  // A block of height H from x = d on, seen from above. In a direction at an angle a to the step,
  // sin h = H / sqrt(H^2 + (d / cos a)^2) where that is within R, and sin t = 0; the integral over
  // a is asin(H sin a / sqrt(H^2 + d^2)) at the largest a.
  for (const double height : {0.3, 1.0, 1.7}) {
    for (const double d : {0.5, 0.9}) {
      const Surface scene =
          all_of({plane({}, {0, 0, 1}), cut(plane({0, 0, height}, {0, 0, 1}),
                                            [=](const glm::dvec3& p) { return p.x > d; })});
      const double widest = std::acos(std::min(1.0, d / std::sqrt(4 - height * height))),
                   hidden = std::asin(height * std::sin(widest) / std::hypot(height, d)) /
                            glm::pi<double>();
      EXPECT_NEAR(converged_in_the_middle(scene), 1 - hidden, 0.015) << height << " " << d;
    }
  }
}

TEST(Hbao, HorizonsOfAValleyAreItsOpening) {
  // Two planes that rise at an angle s from their valley, seen from above. At the bottom,
  // tan h = tan s |cos a| on one side and t = -h on the other: the integral is 1 - 2 s / pi.
  for (const double degrees : {15.0, 30.0, 45.0, 60.0}) {
    const double s = glm::radians(degrees);
    const Surface valley = all_of(
        {plane({}, {-std::sin(s), 0, std::cos(s)}), plane({}, {std::sin(s), 0, std::cos(s)})});
    EXPECT_NEAR(converged_in_the_middle(valley), 1 - 2 * s / glm::pi<double>(), 0.03) << degrees;
  }
}

TEST(Hbao, ConsecutiveSeedsSpreadEvenlyInEveryPixel) {
  constexpr unsigned kSeeds = 64;
  for (const unsigned first : {0u, 1001u}) {
    for (std::size_t cell = 0; cell < 16; ++cell) {
      // A cell of the unit square of turns and jitters for each four of them.
      std::array<int, 16> found{};
      for (unsigned seed = first; seed < first + kSeeds; ++seed) {
        const HbaoPattern pattern = hbao_pattern(seed);
        ++found[std::size_t(4 * pattern.turn[cell]) * 4 + std::size_t(4 * pattern.jitter[cell])];
      }
      for (const int count : found) {
        EXPECT_GE(count, 2) << first << " " << cell;
        EXPECT_LE(count, 6) << first << " " << cell;
      }
    }
  }
}

TEST(Hbao, TheUnitOfTheSceneDoesNotMatter) {
  Geometry g = still(camera_from_fov(50, kWindow, 1));
  const Products metres = obscure(hbao_method(), g, 0.5f);
  g.surfaces.change_each([&](Surfel& s) { s.position *= 128, s.rounding *= 128; });
  const Products other = obscure(hbao_method(), g, 64);
  EXPECT_LT(*std::min_element(other.ao.pixels.begin(), other.ao.pixels.end()), 0.6f);
  for (std::size_t i = 0; i < other.ao.size(); ++i) EXPECT_NEAR(other.ao[i], metres.ao[i], 1e-5);
}

TEST(Hbao, AnOpenPlaneReadsOne) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
      const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow);
      for (const std::string horizon : {"horizon=taps", "horizon=max"}) {
        for (const float ao : obscure(hbao_method(), g, 1, {"bias=0.001", horizon}).ao.pixels)
          EXPECT_EQ(ao, 1) << tilt;
      }
    }
  }
}

TEST(Hbao, AWallDarkensTheFloorBeforeItAndLessFartherAway) {
  const Geometry g = geometry_of(
      all_of({plane({}, {0, 0, 1}), plane({0, 1, 0}, {0, -1, 0})}),
      look_at(camera_from_ortho_width(6, kWindow, 1), {0, -4, 4}, {0, 0, 0}, {0, 0, 1}), kWindow);
  const Products out = obscure(hbao_method(), g, 1);
  const auto mean = [&](double from, double to) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y < out.ao.height; ++y) {
      const glm::dvec3 world =
          glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces(48, y).position) +
          g.camera.origin;
      if (std::abs(world.z) > 1e-3 || world.y < from || world.y > to) continue;
      for (int x = 40; x < 56; ++x) sum += double(out.ao(x, y)), ++count;
    }
    EXPECT_GT(count, 0);
    return sum / count;
  };
  EXPECT_LT(mean(0.8, 1), 0.85);
  EXPECT_LT(mean(0.8, 1), mean(0.4, 0.8) - 0.02);
  EXPECT_EQ(mean(-1, -0.2), 1) << "beyond the radius";
}

TEST(Hbao, WhatIsFartherInFrontThanTheRadiusMakesNoHalo) {
  const auto darkest_behind = [](double depth) {
    const Geometry g = geometry_of(disc_before_a_plane(depth),
                                   tilted(camera_from_fov(40, kWindow, 1), 0), kWindow);
    const Products out = obscure(hbao_method(), g, 0.5f);
    float least = 1;
    for (std::size_t i = 0; i < out.ao.size(); ++i)
      if (g.surfaces[i].position.z < -6.1f) least = std::min(least, out.ao[i]);
    return least;
  };
  EXPECT_EQ(darkest_behind(0.52), 1);
  EXPECT_LT(darkest_behind(0.25), 0.9);
}

TEST(Hbao, SurfacesBeyondTheMaximumDistanceAreOpen) {
  const Geometry g = still(camera_from_fov(50, kWindow, 1));
  const Products all = obscure(hbao_method(), g, 0.8f),
                 near = obscure(hbao_method(), g, 0.8f, {"max-distance=4.5"});
  int cut = 0;
  for (std::size_t i = 0; i < all.ao.size(); ++i) {
    const bool far = g.surfaces[i].position.z < -4.5f;
    EXPECT_EQ(near.ao[i], far ? 1 : all.ao[i]);
    cut += far && all.ao[i] < 0.9f;
  }
  EXPECT_GT(cut, 20);
}

TEST(Hbao, ConstantLightIsThatColourTimesAo) {
  const Geometry g = still(camera_from_fov(50, kWindow, 1));
  const glm::vec3 color(0.25f, 1, 8);
  const Products out = obscure(hbao_method(), g, 1, {}, Environment::constant(color));
  for (std::size_t i = 0; i < out.ao.size(); ++i)
    EXPECT_EQ(out.direct[i], g.is_surface(i) ? out.ao[i] * color : glm::vec3(0));
}

TEST(Hbao, InstructionSetsAndThreadsDoNotMatter) {
  const Geometry g = still(camera_from_fov(50, kWindow, 1));
  for (const std::string horizon : {"horizon=taps", "horizon=max"}) {
    const auto ao = [&] { return obscure(hbao_method(), g, 0.8f, {horizon}).ao; };
    expect_the_same_from_every_isa(ao);
    expect_the_same_from_any_threads(ao);
  }
}

TEST(Hbao, NothingThatComesInMakesANaN) {
  const Geometry g = broken_geometry();
  for (const float radius : {1e-30f, 1e-6f, 1.0f, 1e6f, 1e30f}) {
    SCOPED_TRACE(radius);
    expect_usable(obscure(hbao_method(), g, radius));
    expect_usable(obscure(hbao_method(), g, radius, {"bias=0", "least-distance=1e-6"}));
    expect_usable(obscure(hbao_method(), g, radius, {"bias=0", "horizon=max"}));
  }
}

}  // namespace
}  // namespace ssdo::test::hbao_test
