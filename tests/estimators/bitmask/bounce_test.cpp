// SPDX-License-Identifier: Apache-2.0
//
// Light from surface to surface: what is sent comes from where the sky is hidden, and only there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "estimators/bitmask/request.h"
#include "support/boxes.h"

namespace ssdo::test::bounce_test {
namespace {

const Window kWindow{0, 0, 192, 144};

Plane<glm::vec3> constant(const glm::vec3& color) {
  return {kWindow.width(), kWindow.height(), color};
}

TEST(BitmaskBounce, InAFurnaceItIsTheLightTimesWhatIsHidden) {
  const glm::vec3 color(0.25f, 1, 8);
  const Surface wall = floor_and_wall();
  const Surface room = all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 2, 0}, {0, -1, 0}),
                               plane({-2, 0, 0}, {1, 0, 0}), plane({2.5, 0, 0}, {-1, 0, 0}),
                               plane({0, 0, 3}, {0, 0, -1})});
  const Camera inside =
      look_at(camera_from_fov(90, kWindow, 1), {0, -3, 1.5}, {0.3, 2, 1}, {0, 0, 1});
  double error = 0, hidden = 0;
  const auto check = [&](const Surface& scene, const Camera& camera, float radius, bool extend) {
    const Products out = run(geometry_of(scene, camera, kWindow), {.radius = radius,
                                                                   .slices = 3,
                                                                   .steps = 12,
                                                                   .extend = extend,
                                                                   .bounces = 1,
                                                                   .radiance = constant(color)});
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      hidden += 1 - out.ao[i];
      for (int c = 0; c < 3; ++c)
        error = std::max(error, std::abs(out.bounce[i][c] / color[c] - (1.0 - out.ao[i])));
    }
  };
  for (const bool extend : {false, true}) {
    for (const float radius : {0.5f, kNoLimit}) {
      check(wall, tilted(camera_from_fov(40, kWindow, 1), 45), radius, extend);
      check(wall, tilted(camera_from_ortho_width(4, kWindow, 1), 45), radius, extend);
      check(room, inside, radius, extend);
    }
  }
  fmt::print("furnace: bounce off by {:.1e} of the light\n", error);
  EXPECT_LT(error, 1e-5);
  EXPECT_GT(hidden, 10000);
}

TEST(BitmaskBounce, BesideAWallItIsTheFormFactor) {
  const Window window{0, 0, 480, 400};
  for (const double x : {0.1, 0.3}) {
    const Camera camera =
        tilted(camera_from_ortho_width(2.4, window, 1), 45, 6, glm::dvec3(0, -x, 0));
    const Surface scene = floor_and_wall();
    const Products out =
        run(geometry_of(scene, camera, window),
            {.bounces = 1, .radiance = {window.width(), window.height(), glm::vec3(0.8f)}});
    // After the receiver's albedo of 0.8; 0.32 at the very foot.
    const double measured =
        0.8 * middle(window, [&](int px, int py) { return double(out.bounce(px, py).y); });
    const double expected =
        0.64 * middle(window, [&](int px, int py) {
          return disc_segment(-point_at(scene, camera, window, px, py).position.y);
        });
    fmt::print("bounce, x/R {}: expected {:.4f}  measured {:.4f}  off by {:+.4f}\n", x, expected,
               measured, measured - expected);
    EXPECT_NEAR(measured, expected, 2e-3) << x;
  }
  EXPECT_NEAR(0.64 * disc_segment(0), 0.32, 1e-12);
}

TEST(BitmaskBounce, ALayerOfRadianceHoldsForBothSides) {
  // Normals of the wall that the viewer can see but the floor cannot.
  Geometry g =
      geometry_of(floor_and_wall(), tilted(camera_from_ortho_width(4, kWindow, 1), 45), kWindow);
  const glm::vec3 up = glm::vec3(g.camera.rotation * glm::dvec3(0, 0, 1)),
                  out_of_wall = glm::vec3(g.camera.rotation * glm::dvec3(0, -1, 0)),
                  leaning = glm::vec3(g.camera.rotation * glm::normalize(glm::dvec3(0, 0.3, 1)));
  g.surfaces.change_each([&](Surfel& s) {
    const glm::vec3 n(s.normal);
    if (glm::dot(n, out_of_wall) > 0.9f)
      s.normal = leaning;
    else
      EXPECT_GT(glm::dot(n, up), 0.9f);
  });
  const Products out =
      run(g, {.slices = 4, .steps = 64, .bounces = 1, .radiance = constant(glm::vec3(1))});
  double hidden = 0, bounce = 0;
  for (int x = 60; x < 130; ++x) {
    const int y = kWindow.height() / 2 + 2;  // on the floor, at the foot of the wall
    hidden += 1 - out.ao(x, y), bounce += out.bounce(x, y).x;
  }
  fmt::print("bounce of senders that face away: {:.4f} of {:.1f}\n", bounce, hidden);
  EXPECT_GT(hidden, 20);
  // The side that is not seen is as bright as the layer says of the one that is.
  EXPECT_NEAR(bounce, hidden, 0.01 * hidden);
}

/// A sky that is bright on one side of y = 0 and black on the other.
Environment half_a_sky(bool bright_behind) {
  const auto map = std::make_shared<Plane<glm::vec3>>(64, 32);
  const Environment directions(map, {});
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x)
      (*map)(x, y) = glm::vec3((directions.texel_direction(x, y).y > 0) == bright_behind ? 1 : 0);
  }
  return Environment(map, {});
}

TEST(BitmaskBounce, ASideThatIsNotSeenSendsItsOwnLight) {
  // A low wall, whose front the viewer sees, on a floor that goes on behind it.
  const Surface scene =
      all_of({plane({}, {0, 0, 1}), cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) {
                return p.z > 0 && p.z < 0.5 && std::abs(p.x) < 1;
              })});
  const Geometry g =
      geometry_of(scene, tilted(camera_from_ortho_width(4, kWindow, 1), 45), kWindow);
  for (const bool bright_behind : {true, false}) {
    const Products out = run(g, {.environment = half_a_sky(bright_behind),
                                 .slices = 8,
                                 .steps = 64,
                                 .extend = false,
                                 .bounces = 1});
    double behind = 0, in_front = 0;
    for (int x = 86; x < 106; ++x) {
      behind += out.bounce(x, 46).x / 20;
      in_front += out.bounce(x, 85).x / 20;
    }
    fmt::print("bounce behind a wall {:.4f}, in front of it {:.4f}\n", behind, in_front);
    const double lit = bright_behind ? behind : in_front, dark = bright_behind ? in_front : behind;
    EXPECT_GT(lit, 0.01);
    EXPECT_GT(lit, 3 * dark);
  }
}

/// Mean bounce over the columns of pixels from x0 to x1, in rows where the walls go on.
glm::dvec3 mean_bounce(const Products& out, int x0, int x1) {
  glm::dvec3 sum(0);
  for (int y = 40; y < 104; ++y) {
    for (int x = x0; x < x1; ++x) sum += glm::dvec3(out.bounce(x, y));
  }
  return sum / (64.0 * (x1 - x0));
}

TEST(BitmaskBounce, FewSlicesKeepToTheirSurface) {
  // A terrace over a floor, seen from above, and a red wall on the terrace, a blue one on the
  // floor: on both sides of the edge between them the light is another.
  const auto on_terrace = [](const glm::dvec3& p) { return p.x < 0; };
  const auto on_floor = [](const glm::dvec3& p) { return p.x >= 0; };
  const auto low = [](const glm::dvec3& p) { return p.z > 0 && p.z < 1.5; };
  const Surface scene =
      all_of({cut(plane({0, 0, 1}, {0, 0, 1}), on_terrace), cut(plane({}, {0, 0, 1}), on_floor),
              cut(plane({-1.5, 0, 0}, {1, 0, 0}), low), cut(plane({1, 0, 0}, {-1, 0, 0}), low)});
  const Camera camera = look_at(camera_from_fov(40, kWindow, 1), {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
  const Geometry g = geometry_of(scene, camera, kWindow);
  Plane<glm::vec3> radiance = constant(glm::vec3(0));
  int edge = 0;
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const Point p = point_at(scene, camera, kWindow, x, y);
      if (std::abs(p.normal.x) > 0.5)
        radiance(x, y) = p.normal.x > 0 ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
      else if (y == 72 && p.position.z > 0.5)
        edge = std::max(edge, x);
    }
  }
  const auto with = [&](int slices, unsigned seed) {
    return run(g, {.radius = kNoLimit,
                   .slices = slices,
                   .steps = 64,
                   .extend = false,
                   .bounces = 1,
                   .radiance = radiance,
                   .seed = seed});
  };
  // A mean over seeds: two columns of pixels march along a few directions only.
  constexpr int kSeeds = 8;
  std::vector<Products> few;
  for (unsigned seed = 0; seed < kSeeds; ++seed) few.push_back(with(2, seed));
  const Products many = with(12, 0);
  for (const int x : {edge - 1, edge + 1}) {
    const glm::dvec3 expected = mean_bounce(many, x, x + 2);
    glm::dvec3 found(0);
    for (const Products& of_seed : few) found += mean_bounce(of_seed, x, x + 2) / double(kSeeds);
    fmt::print("bounce beside an edge: red {:.4f} ({:.4f}), blue {:.4f} ({:.4f})\n", found.x,
               expected.x, found.z, expected.z);
    EXPECT_LT(glm::length(found - expected), 0.1 * glm::length(expected)) << x;
  }
}

/// What a filter leaves of the noise: that of means over the pattern.
TEST(BitmaskBounce, HasLittleNoise) {
  // A room that is lit through its roof, half of which is missing.
  const auto back_half = [](const glm::dvec3& p) { return p.y > 0.5; };
  const Surface room = all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 3, 0}, {0, -1, 0}),
                               plane({-2, 0, 0}, {1, 0, 0}), plane({2, 0, 0}, {-1, 0, 0}),
                               cut(plane({0, 0, 3}, {0, 0, -1}), back_half)});
  const Camera camera =
      look_at(camera_from_fov(90, kWindow, 1), {0.1, -2.5, 1.6}, {0, 2, 1}, {0, 0, 1});
  const Geometry g = geometry_of(room, camera, kWindow);
  constexpr int kSeeds = 8, kPattern = 8;
  std::vector<Products> of_seeds;
  for (unsigned seed = 0; seed < kSeeds; ++seed)
    of_seeds.push_back(
        run(g, {.radius = kNoLimit, .slices = 2, .steps = 16, .bounces = 1, .seed = seed}));
  double variance = 0, sum = 0;
  int blocks = 0;
  for (int y = 0; y + kPattern <= kWindow.height(); y += kPattern) {
    for (int x = 0; x + kPattern <= kWindow.width(); x += kPattern, ++blocks) {
      const auto mean_of = [&](const Products& out) {
        double mean = 0;
        for (int i = 0; i < kPattern * kPattern; ++i)
          mean += double(out.bounce(x + i % kPattern, y + i / kPattern).x);
        return mean / (kPattern * kPattern);
      };
      double mean = 0;
      for (const Products& out : of_seeds) mean += mean_of(out) / kSeeds;
      for (const Products& out : of_seeds)
        variance += std::pow(mean_of(out) - mean, 2) / (kSeeds - 1);
      sum += mean;
    }
  }
  const double noise = std::sqrt(variance / blocks) / (sum / blocks);
  fmt::print("noise of the bounce: {:.4f} of its mean\n", noise);
  EXPECT_LT(noise, 0.028);
}

TEST(BitmaskBounce, InAClosedBoxNothingOutshinesTheSky) {
  const Surface box = all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 0, 3}, {0, 0, -1}),
                              plane({0, 3, 0}, {0, -1, 0}), plane({0, -3, 0}, {0, 1, 0}),
                              plane({-2, 0, 0}, {1, 0, 0}), plane({2, 0, 0}, {-1, 0, 0}),
                              sphere({0.3, 1.5, 0.6}, 0.6)});
  const Camera camera =
      look_at(camera_from_fov(90, kWindow, 1), {0.1, -2.5, 1.6}, {0, 2, 1}, {0, 0, 1});
  const Geometry g = geometry_of(box, camera, kWindow);
  const Solids local = guess_solids(g);
  double brightest = 0, least = 1;
  for (const Solids* solids : {static_cast<const Solids*>(nullptr), &local}) {
    for (const bool extend : {false, true}) {
      for (const float radius : {1.0f, kNoLimit}) {
        const Products out = run(g, {.radius = radius,
                                     .products = {.ao = true, .direct = true},
                                     .slices = 3,
                                     .steps = 12,
                                     .solids = solids,
                                     .extend = extend,
                                     .albedo = 1,
                                     .bounces = 8});
        for (std::size_t i = 0; i < out.direct.size(); ++i) {
          const glm::vec3 light = out.direct[i] + out.bounce[i];
          for (int c = 0; c < 3; ++c) brightest = std::max(brightest, double(light[c]));
          least = std::min(least, double(light.x));
        }
      }
    }
  }
  fmt::print("closed box, albedo 1, 8 bounces under a sky of 1: {:.4f} to {:.4f}\n", least,
             brightest);
  EXPECT_LE(brightest, 1 + 1e-3);
  EXPECT_GE(least, 0);
}

}  // namespace
}  // namespace ssdo::test::bounce_test
