// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "error.h"
#include "estimators/ssdo_request.h"
#include "support/analytic_scene.h"
#include "support/crop.h"

namespace ssdo::test::ssdo_test {
namespace {

const Window kWindow{0, 0, 96, 72};

Camera tilted(Camera projection, double tilt_degrees, double distance = 6) {
  const double t = glm::radians(tilt_degrees);
  return look_at(projection, distance * glm::dvec3(0, -std::sin(t), std::cos(t)), {0, 0, 0},
                 {0, std::cos(t), std::sin(t)});
}

/// Mean over the 4 x 4 pixels around the middle of the picture: the whole pattern once.
double middle(const Plane<float>& plane) {
  double sum = 0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) sum += plane(plane.width / 2 + x, plane.height / 2 + y);
  }
  return sum / 16;
}

TEST(Ssdo, AnOpenPlaneReadsOneAtEveryTilt) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0, 85.0}) {
      const Products out =
          run_ssdo(geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow), {});
      for (const float ao : out.ao.pixels) EXPECT_NEAR(ao, 1, 1e-5) << tilt;
    }
  }
}

TEST(Ssdo, ConstantLightIsThatColourTimesAo) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.6}, 0.6)});
  const glm::vec3 color(0.25f, 1, 8);
  const Products out =
      run_ssdo(geometry_of(scene, tilted(camera_from_fov(40, kWindow, 1), 50), kWindow),
               {.environment = Environment::constant(color)});
  double occluded = 0;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    occluded += 1 - out.ao[i];
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(out.direct[i][c], color[c] * out.ao[i], 1e-5 * color[c]);
  }
  EXPECT_GT(occluded, 100) << "the sphere hides something";
  // The same through a map of one colour, with lookups.
  const auto map = std::make_shared<Plane<glm::vec3>>(64, 32, color);
  const Products mapped =
      run_ssdo(geometry_of(scene, tilted(camera_from_fov(40, kWindow, 1), 50), kWindow),
               {.environment = Environment(map, {})});
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(mapped.direct[i][c], out.direct[i][c], 1e-4 * color[c]);
  }
}

/// The method's own expectation beside a wall at distance `d`: every point of the half-ball behind
/// the wall is hidden. Summed over cosine, azimuth and volume in double.
double expected_beside_wall(double d) {
  const int n = 200;
  double visible = 0, all = 0;
  for (int i = 0; i < n; ++i) {
    const double cosine = (i + 0.5) / n, sine = std::sqrt(1 - cosine * cosine);
    for (int j = 0; j < n; ++j) {
      const double across = sine * std::cos(glm::pi<double>() * (j + 0.5) / n);
      for (int k = 0; k < n; ++k) {
        const double x = std::cbrt((k + 0.5) / n) * across;
        all += cosine;
        visible += x < d ? cosine : 0;
      }
    }
  }
  return visible / all;
}

TEST(Ssdo, BesideAWallItConvergesToItsOwnExpectation) {
  // The wall stands at y = 0 and faces the camera; the floor at z = 0 reaches up to it.
  const Surface scene =
      all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 0; }),
              cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; })});
  for (const double d : {0.2, 0.4, 0.7}) {
    const glm::dvec3 at(0, -d, 0);
    const Camera camera =
        look_at(camera_from_ortho_width(4, kWindow, 1), at + glm::dvec3(0, -5, 5), at, {0, 0, 1});
    const Products out =
        run_ssdo(geometry_of(scene, camera, kWindow), {.set = {"samples=512", "singularity=100"}});
    EXPECT_NEAR(middle(out.ao), expected_beside_wall(d), 0.01) << d;
  }
  // Rays give 1/2 at the foot; a half-ball whose points behind the wall are hidden does too.
  EXPECT_NEAR(expected_beside_wall(0), 0.5, 1e-3);
}

TEST(Ssdo, ADistantForegroundDoesNotOcclude) {
  const Surface near_strip =
      cut(plane({0, 0, 4}, {0, 0, 1}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.1; });
  const Surface floor = plane({}, {0, 0, 1});
  const Camera camera = tilted(camera_from_fov(60, kWindow, 1), 0);
  const Products with =
      run_ssdo(geometry_of(all_of({floor, near_strip}), camera, kWindow), {.radius = 1});
  for (const float ao : with.ao.pixels) EXPECT_NEAR(ao, 1, 1e-5);
  const Products seen = run_ssdo(geometry_of(all_of({floor, near_strip}), camera, kWindow),
                                 {.radius = 1, .set = {"singularity=100"}});
  EXPECT_LT(*std::min_element(seen.ao.pixels.begin(), seen.ao.pixels.end()), 0.9f)
      << "without the window it would";
}

TEST(Ssdo, BackgroundIsOpenAndUntouched) {
  const Products out = run_ssdo(
      geometry_of(sphere({0, 0, 0}, 1), tilted(camera_from_fov(40, kWindow, 1), 30), kWindow),
      {.bounces = 1});
  EXPECT_EQ(out.ao(0, 0), 1);
  EXPECT_EQ(out.direct(0, 0), glm::vec3(0));
  EXPECT_EQ(out.bounce(0, 0), glm::vec3(0));
  EXPECT_EQ(out.ao(48, 36), 1) << "a sphere before nothing is not occluded by the nothing";
}

TEST(Ssdo, BounceIsProportionalToTheSendersAlbedoAndGrowsWithPasses) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), plane({0, 1, 0}, {0, -1, 0})});
  const Geometry g = geometry_of(
      scene, look_at(camera_from_fov(40, kWindow, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1}), kWindow);
  const Products dark = run_ssdo(g, {.albedo = 0.25f, .bounces = 1}),
                 light = run_ssdo(g, {.albedo = 0.5f, .bounces = 1});
  const Products twice = run_ssdo(g, {.albedo = 0.5f, .bounces = 2}),
                 black = run_ssdo(g, {.albedo = 0, .bounces = 1});
  double first = 0, second = 0;
  for (std::size_t i = 0; i < dark.bounce.size(); ++i) {
    EXPECT_NEAR(light.bounce[i].x, 2 * dark.bounce[i].x, 1e-5);
    EXPECT_EQ(black.bounce[i].x, 0);
    EXPECT_GE(twice.bounce[i].x, light.bounce[i].x);
    first += light.bounce[i].x, second += twice.bounce[i].x;
  }
  EXPECT_GT(second, first * 1.01);
}

TEST(Ssdo, ACropFarEnoughInsideIsThatPartOfTheWhole) {
  const Window part{7, 5, 90, 70};
  const Surface scene = all_of({plane({}, {0, 0, 1}), plane({0, 1, 0}, {0, -1, 0})});
  const Camera camera =
      look_at(camera_from_fov(40, kWindow, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
  const Geometry g = geometry_of(scene, camera, kWindow);
  const SsdoRequest request{.radius = 0.2f, .bounces = 1};
  const Products all = run_ssdo(g, request), of_part = run_ssdo(crop(g, part), request);
  // A radius is at most 8 pixels here, and a bounce comes from pixels that look as far themselves.
  const int margin = 16;
  double bounced = 0;
  for (int y = margin; y < part.height() - margin; ++y) {
    for (int x = margin; x < part.width() - margin; ++x) {
      const int wx = x + part.x0, wy = y + part.y0;
      ASSERT_EQ(of_part.ao(x, y), all.ao(wx, wy)) << x << "," << y;
      ASSERT_EQ(of_part.direct(x, y), all.direct(wx, wy));
      ASSERT_EQ(of_part.bounce(x, y), all.bounce(wx, wy));
      bounced += all.bounce(wx, wy).x;
    }
  }
  EXPECT_GT(bounced, 1);
}

TEST(Ssdo, NothingThatComesInMakesANaN) {
  std::mt19937 random(3);
  Geometry g =
      geometry_of(sphere({0, 0, 0}, 2), tilted(camera_from_fov(40, kWindow, 1), 30), kWindow);
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (random() % 10 == 0)
      g.surfaces.set_position(i, glm::vec3(0)), g.surfaces.rounding[i] = Surfel::kBackground;
    if (g.is_surface(i) && random() % 10 == 0)
      g.surfaces.set_position(i, 1e6f * g.surfaces[i].position);
    if (g.is_surface(i) && random() % 10 == 0) g.surfaces.set_position(i, glm::vec3(0, 0, -1e-30f));
  }
  for (const float radius : {1e-6f, 1.0f, 1e6f}) {
    const Products out = run_ssdo(g, {.radius = radius, .bounces = 3});
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      EXPECT_TRUE(out.ao[i] >= 0 && out.ao[i] <= 1);
      for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(std::isfinite(out.direct[i][c]) && std::isfinite(out.bounce[i][c]));
    }
  }
}

TEST(Registry, NamesWhatExists) {
  EXPECT_EQ(find_method("ssdo").name, "ssdo");
  EXPECT_THROW(find_method("ssdO"), Error);
  const Method method = ssdo_method();
  EXPECT_EQ(resolve_parameters(method, {"samples=32"}).at("samples"), 32);
  for (const char* bad :
       {"samples", "samples=", "samples=0", "samples=2.5", "samples=nan", "sample=3", "bias=x"}) {
    EXPECT_THROW(resolve_parameters(method, {bad}), Error) << bad;
  }
}

}  // namespace
}  // namespace ssdo::test::ssdo_test
