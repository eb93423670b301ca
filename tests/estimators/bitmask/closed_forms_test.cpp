// SPDX-License-Identifier: Apache-2.0
//
// Occlusion in closed form, and once more by rays in double: walls, corners, pits, spheres.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "estimators/bitmask/closed_form.h"

namespace ssdo::test::closed_forms_test {
namespace {

const Window kWindow = kFineWindow;

Camera ortho(double tilt, const glm::dvec3& target = {}) {
  return tilted(camera_from_ortho_width(2.4, kWindow, 1), tilt, 6, target);
}
Camera pinhole(double tilt, const glm::dvec3& target = {}, double distance = 4.5) {
  return tilted(camera_from_fov(30, kWindow, 1), tilt, distance, target);
}

TEST(BitmaskClosedForms, BesideAWall) {
  const Formula wall = [](const glm::dvec3& p) { return 1 - disc_segment(-p.y); };
  for (const double x : {0.1, 0.3, 0.6, 0.9}) {
    const glm::dvec3 at(0, -x, 0);
    for (const double tilt : {30.0, 50.0})
      expect_closed_form(fmt::format("wall, x/R {}, orthographic, tilt {}", x, tilt),
                         floor_and_wall(), ortho(tilt, at), {}, wall);
    expect_closed_form(fmt::format("wall, x/R {}, perspective", x), floor_and_wall(),
                       pinhole(45, at), {}, wall);
  }
  expect_closed_form("wall, x/R 0.3, nothing beyond the frame", floor_and_wall(),
                     pinhole(45, {0, -0.3, 0}), {.extend = false}, wall);
  EXPECT_NEAR(1 - disc_segment(0), 0.5, 1e-12) << "at the very foot";
}

TEST(BitmaskClosedForms, BesideAWallOffTheAxis) {
  const Formula wall = [](const glm::dvec3& p) { return 1 - disc_segment(-p.y); };
  for (const double x : {0.1, 0.4}) {
    for (const glm::dvec2& slope : {glm::dvec2(1, 0), {-1, 0}, {0, 1}, {0, -1}, {0.7, -0.7}}) {
      const Camera camera = off_axis(pinhole(45, {0, -x, 0}, 9), kWindow, slope);
      expect_closed_form(fmt::format("wall, x/R {}, slope {:g} {:g}", x, slope.x, slope.y),
                         floor_and_wall(), camera, {}, wall);
    }
  }
}

TEST(BitmaskClosedForms, BesideAWallSeenFromTheSide) {
  const Formula wall = [](const glm::dvec3& p) { return 1 - disc_segment(-p.y); };
  for (const double azimuth : {30.0, 60.0}) {
    const double a = glm::radians(azimuth);
    const glm::dvec3 at(0, -0.3, 0), from = at + 4.5 * glm::dvec3(std::sin(a), -std::cos(a), 1);
    expect_closed_form(fmt::format("wall, x/R 0.3, from {} degrees beside", azimuth),
                       floor_and_wall(),
                       look_at(camera_from_fov(28, kWindow, 1), from, at, {0, 0, 1}), {}, wall);
  }
}

TEST(BitmaskClosedForms, PixelsNeedNotBeSquare) {
  const Formula wall = [](const glm::dvec3& p) { return 1 - disc_segment(-p.y); };
  const glm::dvec3 at(0, -0.3, 0);
  expect_closed_form("wall, orthographic, pixel aspect 1/2", floor_and_wall(),
                     tilted(camera_from_ortho_width(2.4, kWindow, 0.5), 45, 6, at), {}, wall);
  expect_closed_form("wall, perspective, pixel aspect 3/2", floor_and_wall(),
                     tilted(camera_from_fov(45, kWindow, 1.5), 45, 4.5, at), {}, wall);
}

/// Share of the disc with u > a and v > b: the directions that meet both walls.
double both_segments(double a, double b) {
  if (a * a + b * b >= 1) return 0;
  const auto area = [](double u) { return (u * std::sqrt(1 - u * u) + std::asin(u)) / 2; };
  const double end = std::sqrt(1 - b * b);
  return (area(end) - area(a) - b * (end - a)) / kPi;
}

TEST(BitmaskClosedForms, InACorner) {
  const auto inside = [](const glm::dvec3& p) { return p.x < 1e-9 && p.y < 1e-9 && p.z > -1e-9; };
  const Surface scene =
      all_of({cut(plane({}, {0, 0, 1}), inside), cut(plane({}, {0, -1, 0}), inside),
              cut(plane({}, {-1, 0, 0}), inside)});
  const Formula corner = [](const glm::dvec3& p) {
    return 1 - disc_segment(-p.x) - disc_segment(-p.y) + both_segments(-p.x, -p.y);
  };
  for (const glm::dvec2& x : {glm::dvec2(0.12, 0.12), {0.3, 0.3}, {0.2, 0.6}, {0.65, 0.65}}) {
    const glm::dvec3 at(-x, 0), from = at + glm::dvec3(-3, -3, 4);
    const std::string name = fmt::format("corner, {} and {} from its walls", x.x, x.y);
    expect_closed_form(name, scene,
                       look_at(camera_from_ortho_width(2.4, kWindow, 1), from, at, {0, 0, 1}), {},
                       corner);
    expect_closed_form(name + ", perspective", scene,
                       look_at(camera_from_fov(24, kWindow, 1), from, at, {0, 0, 1}), {}, corner);
  }
  EXPECT_NEAR(corner(glm::dvec3(0)), 0.25, 1e-12) << "at the very corner";
}

/// Form factor of a rectangle, from an element that lies across it at distance c of its foot, one
/// side at its lower corner; b wide, a high (Howell, C-11).
double rectangle_factor(double c, double b, double a) {
  const double r = std::hypot(a, c);
  return (std::atan(b / c) - c / r * std::atan(b / r)) / (2 * kPi);
}

TEST(BitmaskClosedForms, BesideABlockWithoutLimit) {
  const double half = 0.6, height = 0.5, depth = 0.3;
  const auto within = [=](const glm::dvec3& p) {
    return std::abs(p.x) < half + 1e-9 && p.y > -1e-9 && p.y < depth + 1e-9 &&
           p.z < height + 1e-9 && p.z > 0;
  };
  const Surface scene = all_of({plane({}, {0, 0, 1}), cut(plane({}, {0, -1, 0}), within),
                                cut(plane({0, 0, height}, {0, 0, 1}), within),
                                cut(plane({half, 0, 0}, {1, 0, 0}), within),
                                cut(plane({-half, 0, 0}, {-1, 0, 0}), within)});
  const Formula block = [=](const glm::dvec3& p) {
    return 1 - rectangle_factor(-p.y, half - p.x, height) -
           rectangle_factor(-p.y, half + p.x, height);
  };
  for (const double x : {0.15, 0.4}) {
    for (const double tilt : {25.0, 40.0, 60.0}) {
      expect_closed_form(fmt::format("block, x {}, orthographic, tilt {}", x, tilt), scene,
                         ortho(tilt, {0, -x, 0}), {.radius = kNoLimit}, block);
      expect_closed_form(fmt::format("block, x {}, perspective, tilt {}", x, tilt), scene,
                         pinhole(tilt, {0, -x, 0}), {.radius = kNoLimit}, block);
    }
  }
}

/// A round pit; what is open is a disc (Howell, B-15: element parallel to a disc, off its axis).
TEST(BitmaskClosedForms, AtTheBottomOfAPit) {
  const double a = 0.75, h = a / std::sqrt(3.0);
  const Surface wall = [=](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec2 o(ray.origin), d(ray.direction);
    const double A = glm::dot(d, d), B = glm::dot(o, d), C = glm::dot(o, o) - a * a;
    const double disc = B * B - A * C;
    if (A < 1e-18 || disc < 0) return std::nullopt;
    const double t = (-B + std::sqrt(disc)) / A;  // from inside, or through the ground
    const glm::dvec3 p = ray.origin + t * ray.direction;
    if (t < 1e-9 || p.z < 0 || p.z > h) return std::nullopt;
    return Hit{t, glm::dvec3(-p.x / a, -p.y / a, 0)};
  };
  const auto in_disc = [=](const glm::dvec3& p) { return std::hypot(p.x, p.y) < a; };
  const Surface scene =
      all_of({wall, cut(plane({}, {0, 0, 1}), in_disc),
              cut(plane({0, 0, h}, {0, 0, 1}), [=](const glm::dvec3& p) { return !in_disc(p); })});
  const Formula open = [=](const glm::dvec3& p) {
    const double l2 = p.x * p.x + p.y * p.y, z = h * h + l2 + a * a;
    return 0.5 * (1 - (h * h + l2 - a * a) / std::sqrt(z * z - 4 * a * a * l2));
  };
  EXPECT_NEAR(open(glm::dvec3(0)), 0.75, 1e-12);
  for (const double tilt : {0.0, 20.0, 40.0, 50.0}) {
    expect_closed_form(fmt::format("pit, orthographic, tilt {}", tilt), scene, ortho(tilt),
                       {.radius = kNoLimit}, open);
    expect_closed_form(fmt::format("pit, perspective, tilt {}", tilt), scene, pinhole(tilt),
                       {.radius = kNoLimit}, open);
  }
  expect_closed_form("pit, tilt 20, 45 degrees off the axis", scene,
                     off_axis(pinhole(20, {}, 9), kWindow, {1, 0}), {.radius = kNoLimit}, open);
  expect_closed_form("pit, tilt 40, 45 degrees off the axis", scene,
                     off_axis(pinhole(40, {}, 9), kWindow, {0.7, 0.7}), {.radius = kNoLimit}, open);
}

}  // namespace
}  // namespace ssdo::test::closed_forms_test
