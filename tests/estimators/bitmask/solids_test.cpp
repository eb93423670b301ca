// SPDX-License-Identifier: Apache-2.0
//
// Occlusion by solid things that end somewhere: spheres whose backs are given, and a cliff that
// can be seen from every tilt.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "estimators/bitmask/closed_form.h"

namespace ssdo::test::solids_test {
namespace {

const Window kWindow = kFineWindow;

/// Floor and sphere, and how long each view ray stays in the sphere.
struct Ball {
  glm::dvec3 centre;
  double radius;

  Surface scene() const { return all_of({plane({}, {0, 0, 1}), sphere(centre, radius)}); }

  Solids solids(const Geometry& g, const Camera& camera) const {
    Solids solids = constant_thickness(g, kNoLimit);
    for (int y = 0; y < g.window.height(); ++y) {
      for (int x = 0; x < g.window.width(); ++x) {
        const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
        const auto hit = sphere(centre, radius)(ray);
        if (hit) solids.thickness(x, y) = float(-2 * radius * glm::dot(hit->normal, ray.direction));
      }
    }
    return solids;
  }

  /// Share of the cosine that a sphere above the horizon covers.
  double form_factor(const glm::dvec3& p) const {
    const glm::dvec3 to = centre - p;
    return radius * radius * to.z / std::pow(glm::length(to), 3);
  }
};

void expect_ball(const std::string& name, const Ball& ball, const Camera& camera) {
  expect_closed_form(
      name, ball.scene(), camera, {.radius = kNoLimit},
      [&](const glm::dvec3& p) { return 1 - ball.form_factor(p); },
      [&](const Geometry& g, const Camera& c) { return ball.solids(g, c); });
}

TEST(BitmaskSolids, ASphereHidesItsFormFactor) {
  for (const double lift : {0.0, 0.15}) {
    for (const glm::dvec2& place : {glm::dvec2(0, 0.6), {0.6, 0}, {-0.4, 0.6}}) {
      const Ball ball{glm::dvec3(place, 0.4 + lift), 0.4};
      const std::string name =
          fmt::format("sphere at {:g} {:g}, lifted {:g}", place.x, place.y, lift);
      expect_ball(name + ", ortho", ball, tilted(camera_from_ortho_width(3.2, kWindow, 1), 15));
      expect_ball(name + ", persp", ball, tilted(camera_from_fov(46, kWindow, 1), 45, 4.5));
    }
  }
  expect_ball("sphere, slope 1 0", {{0, 0.6, 0.4}, 0.4},
              off_axis(tilted(camera_from_fov(40, kWindow, 1), 45, 9), kWindow, {1, 0}));
  expect_ball("sphere, slope -0.7 0.7", {{0.4, 0.4, 0.5}, 0.4},
              off_axis(tilted(camera_from_fov(40, kWindow, 1), 30, 9), kWindow, {-0.7, 0.7}));
}

/// Of a ball above the ground, often only the underside is within the radius, which no pixel shows.
TEST(BitmaskSolids, ASphereHidesWithWhatIsWithinTheRadius) {
  const Ball ball{{0, 0.45, 0.5}, 0.4};
  for (const float radius : {0.4f, 0.55f, 0.8f}) {
    const auto by_rays = [&](const glm::dvec3& p) {
      return ao_by_rays(ball.scene(), {p, {0, 0, 1}}, double(radius), 4096);
    };
    for (const bool orthographic : {false, true}) {
      const Camera camera = orthographic ? tilted(camera_from_ortho_width(2.4, kWindow, 1), 30)
                                         : tilted(camera_from_fov(30, kWindow, 1), 30, 4.5);
      expect_closed_form(
          fmt::format("sphere, radius {:g}{}", radius, orthographic ? ", ortho" : ""), ball.scene(),
          camera, {.radius = radius}, by_rays,
          [&](const Geometry& g, const Camera& c) { return ball.solids(g, c); });
    }
  }
}

/// A wall seen over its top from behind: as far as it is thin, only what is between the pixels that
/// show it closes it, however many steps there are.
TEST(BitmaskSolids, AThinWallIsClosedBetweenThePixelsThatShowIt) {
  const Surface wall = cut(plane({0, -0.4, 0}, {0, -1, 0}), [](const glm::dvec3& p) {
    return p.z > 0 && p.z < 0.3 && std::abs(p.x) < 0.8;
  });
  const Surface scene = all_of({plane({}, {0, 0, 1}), wall});
  const double expected = ao_by_rays(scene, {{0, 0, 0}, {0, 0, 1}}, kNoLimit);
  for (const bool orthographic : {false, true}) {
    const Camera projection =
        orthographic ? camera_from_ortho_width(2.4, kWindow, 1) : camera_from_fov(24, kWindow, 1);
    const Geometry g = geometry_of(scene, tilted(projection, 40), kWindow);
    const Solids thin = constant_thickness(g, 1e-3f);
    for (const int steps : {16, 64, 256, 4096}) {
      const Window receivers = middle_square(kWindow, 4);
      const Products out =
          run(g, {.radius = kNoLimit, .steps = steps, .solids = &thin, .receivers = receivers});
      const double found = middle(
          kWindow, [&](int x, int y) { return double(at_pixel(out.ao, receivers, x, y)); }, 4);
      fmt::print("thin wall, {} steps: {:.4f}, by rays {:.4f}\n", steps, found, expected);
      EXPECT_NEAR(found, expected, steps < 64 ? 0.01 : 0.004) << steps << " " << orthographic;
    }
  }
}

/// A round cliff around a third of the receiver's horizon, 60 degrees high: it hides a third of
/// cos^2 30 = 3/4, and 3/4 are left. The camera on the open side sees all of it at every tilt.
Surface cliff(double a) {
  const double height = a * std::sqrt(3.0), edge = glm::radians(60.0);
  const auto in_third = [=](const glm::dvec3& p) {
    return std::abs(std::atan2(p.x, p.y)) < edge + 1e-9;
  };
  const Surface face = [=](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec2 o(ray.origin), d(ray.direction);
    const double A = glm::dot(d, d), B = glm::dot(o, d), C = glm::dot(o, o) - a * a;
    const double disc = B * B - A * C;
    if (A < 1e-18 || disc < 0) return std::nullopt;
    const double t = (-B + std::sqrt(disc)) / A;
    const glm::dvec3 p = ray.origin + t * ray.direction;
    if (t < 1e-9 || p.z < 0 || p.z > height || !in_third(p)) return std::nullopt;
    return Hit{t, glm::dvec3(-p.x / a, -p.y / a, 0)};
  };
  const auto on_top = [=](const glm::dvec3& p) { return in_third(p) && std::hypot(p.x, p.y) > a; };
  const auto on_end = [=](const glm::dvec3& p) {
    return p.z > 0 && p.z < height && std::hypot(p.x, p.y) > a && p.y > 0;
  };
  return all_of({face, cut(plane({}, {0, 0, 1}), [=](const glm::dvec3& p) { return !on_top(p); }),
                 cut(plane({0, 0, height}, {0, 0, 1}), on_top),
                 cut(plane({}, {std::cos(edge), -std::sin(edge), 0}),
                     [=](const glm::dvec3& p) { return on_end(p) && p.x > 0; }),
                 cut(plane({}, {-std::cos(edge), -std::sin(edge), 0}),
                     [=](const glm::dvec3& p) { return on_end(p) && p.x < 0; })});
}

TEST(BitmaskSolids, ACliffHidesTheSameAtEveryTilt) {
  const Surface scene = cliff(0.42);
  const auto by_rays = [&](const glm::dvec3& p) {
    return ao_by_rays(scene, {p, {0, 0, 1}}, kNoLimit, 4096);
  };
  EXPECT_NEAR(ao_by_rays(scene, {{0, 0, 0}, {0, 0, 1}}, kNoLimit), 0.75, 5e-4);
  for (const double tilt : {0.0, 20.0, 40.0, 60.0, 70.0, 80.0}) {
    expect_closed_form(fmt::format("cliff, orthographic, tilt {}", tilt), scene,
                       tilted(camera_from_ortho_width(2.4, kWindow, 1), tilt), {.radius = kNoLimit},
                       by_rays);
    expect_closed_form(fmt::format("cliff, perspective, tilt {}", tilt), scene,
                       tilted(camera_from_fov(15, kWindow, 1), tilt, 9), {.radius = kNoLimit},
                       by_rays);
  }
}

}  // namespace
}  // namespace ssdo::test::solids_test
