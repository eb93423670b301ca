// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/remove_objects.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "support/analytic_scene.h"

namespace ssdo::test::remove_objects_test {
namespace {

constexpr Window kWindow{0, 0, 96, 72};

Camera camera(const Window& window = kWindow) {
  return look_at(camera_from_fov(50, window, 1), {0.3, -4, 2.2}, {0, 0.5, 0.4}, {0, 0, 1});
}

const Surface kFloor = plane({0, 0, 0}, {0, 0, 1}), kWall = plane({0, 2, 0}, {0, -1, 0}),
              kBall = sphere({0.1, 0.6, 0.5}, 0.5);

/// What a frame shows of a scene, and how much a ball covers of each pixel.
struct Frame {
  Geometry geometry;
  Plane<float> coverage;
};

Frame frame_of(const std::vector<Surface>& around, const Camera& by = camera(),
               const Window& window = kWindow, const Surface& ball = kBall) {
  std::vector<Surface> all = around;
  all.push_back(ball);
  const Geometry alone = geometry_of(ball, by, window);
  Frame out{geometry_of(all_of(all), by, window),
            Plane<float>(window.width(), window.height(), 0.0f)};
  for (std::size_t i = 0; i < out.coverage.size(); ++i) {
    const bool shows =
        alone.is_surface(i) && alone.surfaces[i].position == out.geometry.surfaces[i].position;
    out.coverage[i] = shows ? 1.0f : 0.0f;
  }
  return out;
}

/// Pixels of the hole, and how many of them do not show what is behind the ball.
struct Filled {
  int pixels = 0, wrong = 0, off = 0;
};

Filled filled(const Frame& frame, const std::vector<Surface>& around, const CasterSurfaces& casting,
              const Camera& by = camera(), const Window& window = kWindow) {
  const Geometry truth = geometry_of(all_of(around), by, window);
  Filled out;
  for (std::size_t i = 0; i < frame.coverage.size(); ++i) {
    const Surfel &a = casting.geometry.surfaces[i], &b = truth.surfaces[i];
    if (frame.coverage[i] == 0) {
      EXPECT_EQ(a.position, frame.geometry.surfaces[i].position) << "beside the hole";
      EXPECT_EQ(casting.sender[i], -1);
      continue;
    }
    ++out.pixels;
    const bool alike = a.is_surface() == b.is_surface();
    out.wrong += !alike || (a.is_surface() && glm::dot(a.normal, b.normal) < 0.99f);
    out.off += alike && a.is_surface() && glm::distance(a.position, b.position) > 1e-3f;
    if (!a.is_surface()) continue;
    const int sender = casting.sender[i];
    EXPECT_GE(sender, 0);
    EXPECT_EQ(frame.coverage[std::size_t(sender)], 0) << "the ball sends";
    EXPECT_LE(a.position.z, frame.geometry.surfaces[i].position.z + 1e-4f) << "before the ball";
  }
  return out;
}

TEST(TakeOut, APlaneGoesOnBelowAThing) {
  const std::vector<Surface> around = {kFloor};
  const Frame frame = frame_of(around);
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}));
  EXPECT_GT(found.pixels, 200);
  EXPECT_EQ(found.wrong, 0);
  EXPECT_EQ(found.off, 0);
}

/// Normals that lean by two degrees, as those of bumps do, say less than both sides together.
TEST(TakeOut, APlaneBetweenTwoSidesIsThatOfTheirPositions) {
  const std::vector<Surface> around = {kFloor};
  const Camera down =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -2.5, 4}, {0.1, 0.6, 0.2}, {0, 0, 1});
  Frame frame = frame_of(around, down);
  for (std::size_t i = 0; i < frame.coverage.size(); ++i) {
    const glm::vec3 n = frame.geometry.surfaces[i].normal;
    if (frame.coverage[i] == 0)
      frame.geometry.surfaces.set_normal(i, glm::normalize(n + glm::vec3(0.035f, 0, 0)));
  }
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}), down);
  EXPECT_GT(found.pixels, 200);
  EXPECT_EQ(found.off, 0);
}

/// Of two planes that meet in a corner of a room, what is seen is the nearer one, although the
/// other is seen from closer by.
TEST(TakeOut, ACornerEndsBothOfItsPlanes) {
  const Surface near_ball = sphere({0.1, 1.3, 0.5}, 0.5);
  const std::vector<Surface> around = {kFloor, kWall};
  Frame frame = frame_of(around, camera(), kWindow, near_ball);
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}));
  fmt::print("{} of {}\n", found.wrong, found.pixels);
  EXPECT_LT(found.wrong, found.pixels / 50);
}

/// A floor and a wall meet behind it: the line where they do is off by few pixels.
TEST(TakeOut, AFloorAndAWallMeetBehindAThing) {
  const std::vector<Surface> around = {kFloor, kWall};
  const Frame frame = frame_of(around);
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}));
  EXPECT_LT(found.wrong, found.pixels / 20);
}

/// What rests on a thing ends there: below it, the wall behind both goes on.
TEST(TakeOut, WhatRestsOnAThingDoesNotHangBelowIt) {
  const auto board = [](double y, double left, double right, double low, double high) {
    return cut(plane({0, y, 0}, {0, -1, 0}), [=](const glm::dvec3& p) {
      return left < p.x && p.x < right && low < p.z && p.z < high;
    });
  };
  const Surface stand = board(0.1, -0.9, 0.9, 0, 1);
  const std::vector<Surface> around = {kFloor, kWall, board(0.3, -0.8, 0.8, 1, 1.1)};
  const Camera level =
      look_at(camera_from_fov(50, kWindow, 1), {0, -4, 1}, {0, 0.5, 0.8}, {0, 0, 1});
  const Frame frame = frame_of(around, level, kWindow, stand);
  const CasterSurfaces casting = remove_objects(frame.geometry, frame.coverage, {}, {});
  const glm::dvec3 at = level.to_camera({0, 0.3, 0}), out = level.to_camera({0, -0.7, 0}) - at;
  int hanging = 0, pixels = 0;
  for (std::size_t i = 0; i < frame.coverage.size(); ++i) {
    const Surfel& s = casting.geometry.surfaces[i];
    if (frame.coverage[i] == 0 || !s.is_surface()) continue;
    ++pixels, hanging += std::abs(glm::dot(glm::dvec3(s.position) - at, out)) < 0.02;
  }
  EXPECT_GT(pixels, 500);
  EXPECT_LT(hanging, 2 * pixels / 5) << pixels;
}

/// A wall that goes on beside its hole does so however far.
TEST(TakeOut, WhatIsSeenAtLengthGoesOn) {
  const std::vector<Surface> around = {kWall};
  const Camera level =
      look_at(camera_from_fov(50, kWindow, 1), {0.3, -4, 0.6}, {0.1, 0.6, 0.5}, {0, 0, 1});
  const Frame frame = frame_of(around, level, kWindow, sphere({0.1, 0.6, 0.5}, 1.2));
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}), level);
  EXPECT_GT(found.pixels, 1000);
  EXPECT_EQ(found.wrong, 0);
}

TEST(TakeOut, BackgroundStaysBackground) {
  const Frame frame = frame_of({});
  const CasterSurfaces casting = remove_objects(frame.geometry, frame.coverage, {}, {});
  for (const Surfel& s : casting.geometry.surfaces) {
    EXPECT_FALSE(s.is_surface());
    EXPECT_FALSE(s.is_broken());
  }
}

/// Some rows of a frame that end within the hole take from an overview what is below it.
TEST(TakeOut, RowsThatEndInTheHoleAskTheOverview) {
  constexpr Window kAll{0, 0, 192, 384}, kRows{0, 60, 192, 140}, kSmall{0, 0, 24, 48};
  const std::vector<Surface> around = {kFloor, kWall};
  const Camera by = camera(kAll);
  const Surface ball = sphere({0.3, 0.2, 2.2}, 2.2);  // as wide as these rows
  Frame rows = frame_of(around, by, kRows, ball);
  rows.geometry.part_of = kAll;
  const Frame whole = frame_of(around, by, kAll, ball);
  Camera small = by;
  small.fx /= 8, small.fy /= 8, small.cx /= 8, small.cy /= 8;
  Frame coarse = frame_of(around, small, kSmall, ball);
  rows.geometry.display = kAll, coarse.geometry.display = kSmall;
  const CasterSurfaces in_small = remove_objects(coarse.geometry, coarse.coverage, {}, {}),
                       in_whole = remove_objects(whole.geometry, whole.coverage, {}, {}),
                       alone = remove_objects(rows.geometry, rows.coverage, {}, {}),
                       in_rows =
                           remove_objects(rows.geometry, rows.coverage, {}, {}, &in_small.geometry);
  int pixels = 0, off = 0, off_alone = 0;
  for (std::size_t i = 0; i < rows.coverage.size(); ++i) {
    if (rows.coverage[i] == 0) continue;
    const auto differs = [&](const CasterSurfaces& casting) {
      const Surfel &a = casting.geometry.surfaces[i],
                   &b = in_whole.geometry.surfaces[i + std::size_t(kRows.y0 * kRows.width())];
      return a.is_surface() != b.is_surface() ||
             (a.is_surface() && glm::distance(a.position, b.position) > 0.03f * -b.position.z);
    };
    ++pixels, off += differs(in_rows), off_alone += differs(alone);
  }
  EXPECT_EQ(pixels, int(rows.coverage.size()));
  EXPECT_LT(off, 0.1 * pixels);
  EXPECT_GT(off_alone, 5 * off);
}

TEST(TakeOut, AnOrthographicFrameToo) {
  const Camera by =
      look_at(camera_from_ortho_width(4, kWindow, 1), {0.3, -4, 2.2}, {0, 0.5, 0.4}, {0, 0, 1});
  const std::vector<Surface> around = {kFloor};
  const Frame frame = frame_of(around, by);
  const Filled found =
      filled(frame, around, remove_objects(frame.geometry, frame.coverage, {}, {}), by);
  EXPECT_GT(found.pixels, 100);
  EXPECT_EQ(found.wrong, 0);
  EXPECT_EQ(found.off, 0);
}

/// Of a frame that shows nothing but the thing, nothing is known.
TEST(TakeOut, WhatNothingTellsIsBroken) {
  const Frame frame = frame_of({kFloor});
  const CasterSurfaces casting =
      remove_objects(frame.geometry, Plane<float>(kWindow.width(), kWindow.height(), 1.0f), {}, {});
  for (const Surfel& s : casting.geometry.surfaces) EXPECT_TRUE(s.is_broken());
}

/// A pixel that is covered in part shows one of both.
TEST(TakeOut, ARimGoesWithTheThing) {
  const std::vector<Surface> around = {kFloor};
  Frame frame = frame_of(around);
  Plane<float> matte = frame.coverage;
  int rim = 0, ground = 0;
  for (int y = 1; y + 1 < matte.height; ++y) {
    for (int x = 1; x + 1 < matte.width; ++x) {
      float least = 1, most = 0;
      for (int d = -1; d <= 1; ++d) {
        least = std::min({least, frame.coverage(x + d, y), frame.coverage(x, y + d)});
        most = std::max({most, frame.coverage(x + d, y), frame.coverage(x, y + d)});
      }
      if (least < most) matte(x, y) = frame.coverage(x, y) > 0 ? 0.2f : 0.8f;
    }
  }
  const Geometry truth = geometry_of(kFloor, camera(), kWindow);
  const CasterSurfaces casting = remove_objects(frame.geometry, matte, {}, {});
  for (std::size_t i = 0; i < matte.size(); ++i) {
    rim += matte[i] == 0.2f, ground += matte[i] == 0.8f;
    if (matte[i] == 0) continue;
    EXPECT_LT(glm::distance(casting.geometry.surfaces[i].position, truth.surfaces[i].position),
              1e-3f)
        << "a rim is left";
    if (matte[i] == 0.8f) {
      EXPECT_EQ(casting.sender[i], -1) << "the ground was taken out";
    }
  }
  EXPECT_GT(rim, 20);
  EXPECT_GT(ground, 20);
}

}  // namespace
}  // namespace ssdo::test::remove_objects_test
