// SPDX-License-Identifier: Apache-2.0
//
// Flicker on made shots, whose layers are known functions of the point that a pixel shows.
#include "metrics/flicker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "math/sequence_numbers.h"
#include "support/analytic_scene.h"

namespace ssdo::test::flicker_test {
namespace {

const Window kWindow{0, 0, 128, 96};
const auto kEverywhere = [](int, int) { return true; };

/// A camera on an arc of 5 units around the origin, 2 above the ground.
Camera camera_at(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return look_at(camera_from_fov(45, kWindow, 1), {5 * std::sin(a), -5 * std::cos(a), 2},
                 {0, 0, 0.4}, {0, 0, 1});
}

/// A ball on a ground, before a wall.
Surface scene_with_ball(const glm::dvec3& centre) {
  return all_of({plane({}, {0, 0, 1}), plane({0, 3, 0}, {0, -1, 0}), sphere(centre, 0.6)});
}
const glm::dvec3 kBall(0, 0, 0.6);

Geometry frame_at(double degrees, const glm::dvec3& ball = kBall) {
  return geometry_of(scene_with_ball(ball), camera_at(degrees), kWindow);
}

glm::dvec3 world_of(const Geometry& g, std::size_t i) {
  return g.camera.origin + glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces[i].position);
}

/// A layer of one channel: a function of the world's point.
Channels layer_of(const Geometry& g, const std::function<double(const glm::dvec3&)>& value) {
  Channels layer{g.window, {Plane<float>(g.window.width(), g.window.height())}};
  for (std::size_t i = 0; i < g.surfaces.size(); ++i)
    if (g.is_surface(i)) layer.planes[0][i] = float(value(world_of(g, i)));
  return layer;
}

/// Sines of 0..1, `period` pixels of the middle of the picture long.
std::function<double(const glm::dvec3&)> sines(double period) {
  const double k = 2 * std::numbers::pi / (period * 5.4 / 154);
  return [k](const glm::dvec3& p) {
    return 0.5 + (std::sin(k * p.x) + std::sin(k * p.y) + std::sin(k * p.z)) / 6;
  };
}

/// Where each pixel of `now` was in `before`, as a motion layer has it; `moved` is the way of the
/// ball since then.
Plane<glm::vec2> motion_of(const Geometry& before, const Geometry& now, const glm::dvec3& moved) {
  Plane<glm::vec2> motion(now.surfaces.width, now.surfaces.height, glm::vec2(0));
  for (int y = 0; y < motion.height; ++y) {
    for (int x = 0; x < motion.width; ++x) {
      const glm::dvec3 p = world_of(now, motion.index(x, y));
      const bool is_ball = std::abs(glm::length(p - kBall - moved) - 0.6) < 1e-3;
      const glm::dvec2 then =
          before.camera.project(before.camera.to_camera(is_ball ? p - moved : p));
      motion(x, y) = glm::vec2(then - glm::dvec2(x + 0.5, y + 0.5));
    }
  }
  return motion;
}

/// How many points lie on the ball of `now`.
std::size_t on_ball(const SharedPoints& shared, const Geometry& now, const glm::dvec3& centre) {
  std::size_t count = 0;
  for (const SharedPoint& point : shared.points) {
    const glm::dvec3 p = world_of(now, now.surfaces.index(point.x, point.y));
    count += std::abs(glm::length(p - centre) - 0.6) < 1e-3;
  }
  return count;
}

double rms(const SharedPoints& shared, const Channels& before, const Channels& now) {
  return measure_flicker(shared, before, now).figures().rms;
}

TEST(Flicker, OfAFunctionOfThePointIsThatOfTheSampling) {
  const Geometry before = frame_at(0), now = frame_at(1);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  EXPECT_GT(shared.points.size(), 0.9 * double(kWindow.area())) << "nearly all is seen twice";
  const auto of_period = [&](double period) {
    return rms(shared, layer_of(before, sines(period)), layer_of(now, sines(period)));
  };
  EXPECT_LT(of_period(64), 0.0015);
  EXPECT_LT(of_period(32), 0.005);
  EXPECT_NEAR(of_period(32) / of_period(64), 4, 1) << "the square of the period";
  // The nearest of the four pixels, in place of their mean.
  SharedPoints nearest = shared;
  for (SharedPoint& point : nearest.points) {
    point.left += point.across > 0.5f, point.top += point.down > 0.5f;
    point.across = point.down = 0;
  }
  EXPECT_GT(rms(nearest, layer_of(before, sines(64)), layer_of(now, sines(64))), 5 * of_period(64));
}

TEST(Flicker, OfAJumpIsThatJump) {
  const Geometry before = frame_at(0), now = frame_at(1);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  const auto level = [](double value) { return [value](const glm::dvec3&) { return value; }; };
  const FlickerFigures none =
      measure_flicker(shared, layer_of(before, level(0.3)), layer_of(now, level(0.3))).figures();
  EXPECT_EQ(none.rms, 0);
  EXPECT_EQ(none.p99, 0);
  const FlickerFigures jump =
      measure_flicker(shared, layer_of(before, level(0.5)), layer_of(now, level(0.75))).figures();
  EXPECT_EQ(jump.rms, 0.25);
  EXPECT_EQ(jump.border_rms, 0.25);
  EXPECT_NEAR(jump.p99, 0.25, 0.25 / 200);
  EXPECT_EQ(jump.mean, 0.75);
  EXPECT_EQ(jump.points, shared.points.size());
}

TEST(Flicker, OfARestingCameraIsTheDifferenceOfThePixels) {
  const Geometry frame = frame_at(0);
  const SharedPoints shared = find_shared_points(frame, frame, {}, kEverywhere);
  Channels one = layer_of(frame, sines(64)), two = one;
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < one.planes[0].size(); ++i) {
    two.planes[0][i] += float(i % 7) / 16;
    if (!frame.is_surface(i)) continue;
    squares += std::pow(double(two.planes[0][i]) - double(one.planes[0][i]), 2);
    ++count;
  }
  EXPECT_EQ(shared.points.size(), count) << "pixels beside edges and in the last column too";
  EXPECT_NEAR(rms(shared, one, two), std::sqrt(squares / double(count)), 1e-12);
}

TEST(Flicker, NoiseOfPixelsCountsOnceAndFourNinths) {
  const Geometry before = frame_at(0), now = frame_at(1);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  std::uint64_t number = 0;
  Channels one = layer_of(before, sines(64)), two = layer_of(now, sines(64));
  for (Channels* layer : {&one, &two})
    for (float& value : layer->planes[0].pixels) value = float(start_of(++number));
  const double deviation = std::sqrt(1 / 12.0);  // of numbers in 0..1
  EXPECT_NEAR(rms(shared, one, two), deviation * std::sqrt(1 + 4 / 9.0), 0.02)
      << "on average over places between pixels";
}

TEST(Flicker, LeavesOutWhatTheFrameBeforeDoesNotShow) {
  const Geometry before = frame_at(0), now = frame_at(6);
  const Surface scene = scene_with_ball(kBall);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  EXPECT_GT(shared.points.size(), kWindow.area() / 2);
  EXPECT_LT(shared.points.size(), 0.97 * double(kWindow.area()));
  for (const SharedPoint& point : shared.points) {
    const glm::dvec3 p = world_of(now, now.surfaces.index(point.x, point.y));
    const glm::dvec3 eye = before.camera.origin, way = p - eye;
    const auto hit = scene({eye, glm::normalize(way)});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, glm::length(way), 0.01)
        << "hidden at " << point.x << ", " << point.y;
    const glm::dvec2 place = before.camera.project(before.camera.to_camera(p));
    EXPECT_NEAR(place.x, point.left + 0.5 + point.across, 1.0 / 32);
    EXPECT_NEAR(place.y, point.top + 0.5 + point.down, 1.0 / 32);
  }
}

TEST(Flicker, WhatMovesIsNotTheSamePoint) {
  const glm::dvec3 moved(0.12, 0.03, 0);  // 3.5 pixels
  const Geometry before = frame_at(0), now = frame_at(1, kBall + moved);
  const std::size_t still =
      on_ball(find_shared_points(before, frame_at(1), {}, kEverywhere), frame_at(1), kBall);
  ASSERT_GT(still, 700u);
  // P tells it, but where the ball moves along its own surface.
  const SharedPoints by_position = find_shared_points(before, now, {}, kEverywhere);
  EXPECT_LT(on_ball(by_position, now, kBall + moved), still / 10);
  EXPECT_GT(by_position.points.size(), 0.8 * double(kWindow.area()));
  // A motion layer tells it everywhere.
  const SharedPoints by_motion =
      find_shared_points(before, now, motion_of(before, now, moved), kEverywhere);
  EXPECT_FALSE(by_motion.motion_is_wrong);
  EXPECT_EQ(on_ball(by_motion, now, kBall + moved), 0u);
  EXPECT_EQ(by_motion.points.size(),
            by_position.points.size() - on_ball(by_position, now, kBall + moved));
}

TEST(Flicker, ASurfaceThatSinksIsNotTheSame) {
  const auto ground = [](double height, double degrees) {
    return geometry_of(plane({0, 0, height}, {0, 0, 1}), camera_at(degrees), kWindow);
  };
  const double pixel = 5.4 / 154;
  const Geometry before = ground(0, 0);
  const std::size_t still = find_shared_points(before, ground(0, 1), {}, kEverywhere).points.size();
  EXPECT_GT(find_shared_points(before, ground(0.03 * pixel, 1), {}, kEverywhere).points.size(),
            still * 9 / 10);
  EXPECT_LT(find_shared_points(before, ground(0.3 * pixel, 1), {}, kEverywhere).points.size(),
            still / 2)
      << "far away that is less than a tenth of a pixel";
}

/// Each surface has a value of its own, which a mean over two surfaces would change.
TEST(Flicker, FourPixelsAreOfOneSurface) {
  const auto change = [](const Surface& scene,
                         const std::function<double(const glm::dvec3&)>& value) {
    const Geometry before = geometry_of(scene, camera_at(0), kWindow),
                   now = geometry_of(scene, camera_at(1), kWindow);
    const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
    EXPECT_GT(shared.points.size(), kWindow.area() / 2);
    return rms(shared, layer_of(before, value), layer_of(now, value));
  };
  const Surface ground = plane({}, {0, 0, 1});
  // A slope of 30 degrees: the other surface has another normal.
  EXPECT_EQ(change(all_of({ground, plane({0, 1, 0}, {0, -0.5, std::sqrt(0.75)})}),
                   [](const glm::dvec3& p) { return p.z > 1e-4 ? 1 : 0; }),
            0);
  // A card three pixels above the ground: the other surface has another place.
  const Surface card = cut(plane({0, 0, 0.1}, {0, 0, 1}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 1 && std::abs(p.y) < 1;
  });
  EXPECT_EQ(change(all_of({ground, card}), [](const glm::dvec3& p) { return p.z > 0.05 ? 1 : 0; }),
            0);
}

TEST(Flicker, AMotionLayerOfOtherUnitsIsNotUsed) {
  const Geometry before = frame_at(0), now = frame_at(1);
  Plane<glm::vec2> motion = motion_of(before, now, glm::dvec3(0));
  const std::size_t all = find_shared_points(before, now, motion, kEverywhere).points.size();
  for (glm::vec2& way : motion.pixels) way = -way;
  const SharedPoints shared = find_shared_points(before, now, motion, kEverywhere);
  EXPECT_TRUE(shared.motion_is_wrong);
  EXPECT_EQ(shared.points.size(), all);
}

TEST(Flicker, TheBorderIsSixteenPixelsWideInBothPictures) {
  const Geometry frame = frame_at(0);
  const SharedPoints rest = find_shared_points(frame, frame, {}, kEverywhere);
  Channels one = layer_of(frame, sines(64)), two = one;
  for (int x = 16; x < 112; ++x)
    for (int y = 16; y < 80; ++y) two.planes[0](x, y) += 0.5f;
  const FlickerFigures inside = measure_flicker(rest, one, two).figures();
  EXPECT_EQ(inside.border_rms, 0);
  EXPECT_GT(inside.rms, 0.3);
  two.planes[0](16, 15) += 0.5f;
  EXPECT_GT(measure_flicker(rest, one, two).figures().border_rms, 0);
  // With a camera that turns, points that were at the border before are at it too.
  const SharedPoints turned = find_shared_points(frame_at(0), frame_at(4), {}, kEverywhere);
  std::size_t was = 0;
  for (const SharedPoint& p : turned.points) {
    const bool is_now = p.x < 16 || p.x >= 112 || p.y < 16 || p.y >= 80;
    was += p.at_border && !is_now;
    EXPECT_TRUE(p.at_border || !is_now);
  }
  EXPECT_GT(was, 0u);
}

TEST(Flicker, OverscanIsNoPartOfThePictureButShowsWhereItsPointsWere) {
  const Window wide{-16, -16, 144, 112};
  const auto frame = [&](double degrees) {
    Geometry g = geometry_of(scene_with_ball(kBall), camera_at(degrees), wide);
    g.display = kWindow;
    return g;
  };
  const Geometry before = frame(0), now = frame(2);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  for (const SharedPoint& point : shared.points)
    EXPECT_TRUE(kWindow.contains(point.x, point.y)) << point.x << ", " << point.y;
  EXPECT_GT(shared.points.size(),
            find_shared_points(frame_at(0), frame_at(2), {}, kEverywhere).points.size());
  EXPECT_LT(rms(shared, layer_of(before, sines(64)), layer_of(now, sines(64))), 0.002);
}

TEST(Flicker, OnlyPixelsThatCountAndAreFiniteAreAsked) {
  const Geometry before = frame_at(0), now = frame_at(1);
  const SharedPoints left = find_shared_points(before, now, {}, [](int x, int) { return x < 20; });
  ASSERT_FALSE(left.points.empty());
  for (const SharedPoint& point : left.points) EXPECT_LT(point.x, 20);
  Channels one = layer_of(before, sines(64)), two = layer_of(now, sines(64));
  const std::size_t all = measure_flicker(left, one, two).points;
  one.planes[0](8, 50) = NAN;
  const std::size_t fewer = measure_flicker(left, one, two).points;
  EXPECT_LT(fewer, all);
  EXPECT_GE(fewer + 6, all) << "those between it and its neighbours";
}

TEST(Flicker, OfADifferenceForgivesLightThatReallyChanges) {
  const Geometry before = frame_at(0), now = frame_at(1);
  const SharedPoints shared = find_shared_points(before, now, {}, kEverywhere);
  const auto dimmed = [](double by) {
    return [by](const glm::dvec3& p) { return by * sines(64)(p); };
  };
  const Channels a = layer_of(before, dimmed(1)), b = layer_of(now, dimmed(0.5));
  EXPECT_GT(rms(shared, a, b), 0.2) << "a light was dimmed";
  EXPECT_EQ(rms(shared, subtract(a, a), subtract(b, b)), 0);
}

TEST(Changes, OfFramesAddUp) {
  Changes one, two, all;
  for (int i = 0; i < 1000; ++i) {
    (i % 3 == 0 ? one : two).add(i % 2 == 0 ? i : -i);
    all.add(i);
  }
  one.add(two);
  EXPECT_EQ(one.count(), 1000u);
  EXPECT_NEAR(one.rms(), std::sqrt(999 * 1999 / 6.0), 1e-9);
  EXPECT_EQ(one.p99(), all.p99());
  EXPECT_GE(one.p99(), 989) << "99 % are at most that";
  EXPECT_LE(one.p99(), 989 * 1.004);
  EXPECT_TRUE(std::isnan(Changes().rms()));
  EXPECT_TRUE(std::isnan(Changes().p99()));
}

}  // namespace
}  // namespace ssdo::test::flicker_test
