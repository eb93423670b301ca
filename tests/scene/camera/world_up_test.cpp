// SPDX-License-Identifier: Apache-2.0
//
// Which axis is up, by the camera and the surfaces.
#include "scene/camera/world_up.h"

#include <gmock/gmock.h>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "support/analytic_scene.h"

namespace ssdo::test::world_up_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const Window kWindow{0, 0, 48, 32};

/// A ground, a wall behind it and a ball, z being up.
Surface court() {
  return all_of({plane({}, {0, 0, 1}), plane({0, 12, 0}, {0, -1, 0}), sphere({0, 0, 1}, 1)});
}

struct Pose {
  double azimuth, down, roll = 0;  ///< degrees; azimuth 0 looks along y
  bool orthographic = false;
};

/// The court with z up, or with the axis that `world` makes of z.
Geometry seen(const Pose& pose, const glm::mat3& world = glm::mat3(1),
              const Surface& scene = court()) {
  const double a = glm::radians(pose.azimuth), p = glm::radians(pose.down),
               r = glm::radians(pose.roll);
  const glm::dvec3 forward(std::sin(a) * std::cos(p), std::cos(a) * std::cos(p), -std::sin(p)),
      right(std::cos(a), -std::sin(a), 0), level_up = glm::cross(right, forward),
                                           up = std::cos(r) * level_up + std::sin(r) * right;
  const Camera lens =
      pose.orthographic ? camera_from_ortho_width(6, kWindow, 1) : camera_from_fov(40, kWindow, 1);
  const glm::dvec3 eye(-7 * std::sin(a), -7 * std::cos(a), 3);
  Geometry g = geometry_of(scene, look_at(lens, eye, eye + forward, up), kWindow);
  g.world_to_camera = g.world_to_camera * glm::transpose(world);
  return g;
}

/// From z up to y up.
const glm::mat3 kToYUp{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};

TEST(WorldUp, IsTheAxisAboutWhichTheCameraIsLevel) {
  for (const double azimuth : {0.0, 0.05, 17.0, 45.0, 90.0, 133.0, 180.0, 271.0}) {
    for (const double down : {-5.0, 0.0, 12.0, 30.0}) {
      SCOPED_TRACE(testing::Message() << azimuth << " " << down);
      const WorldUp z = find_world_up({}, seen({azimuth, down})),
                    y = find_world_up({}, seen({azimuth, down}, kToYUp));
      EXPECT_EQ(z.axis, UpAxis::z);
      EXPECT_EQ(y.axis, UpAxis::y);
      for (const WorldUp& up : {z, y}) {
        EXPECT_THAT(up.source, StartsWith("by the camera"));
        EXPECT_THAT(up.warning, IsEmpty());
      }
    }
  }
}

TEST(WorldUp, IsFoundUnderACameraHeldByHand) {
  for (int azimuth = 20; azimuth < 360; azimuth += 45) {
    for (const double roll : {-15.0, -4.0, 1.0, 8.0})
      EXPECT_EQ(find_world_up({}, seen({double(azimuth), 12, roll})).axis, UpAxis::z) << azimuth;
  }
}

/// A camera that turns about an axis of the world alone has no roll about the other one either.
TEST(WorldUp, OfATiltingCameraIsYWhereItIsNotSurelyZ) {
  for (int down = 0; down <= 85; down += 5) {
    SCOPED_TRACE(down);
    for (const double azimuth : {0.0, 180.0})
      EXPECT_EQ(find_world_up({}, seen({azimuth, double(down)}, kToYUp)).axis, UpAxis::y);
    const WorldUp z = find_world_up({}, seen({0, double(down)}));
    if (down <= 30) {
      EXPECT_EQ(z.axis, UpAxis::z);
    }
    if (z.axis == UpAxis::y && down < 60) {
      EXPECT_THAT(z.warning, HasSubstr("--env-up z"));
    }
  }
}

TEST(WorldUp, OfAShotIsThatOfItsFramesTogether) {
  const Geometry level = seen({17, 12}), tilted = seen({0, 70, 25});
  EXPECT_EQ(find_world_up({}, tilted).source, "a guess");
  UpEvidence both = up_evidence(level);
  const UpEvidence other = up_evidence(tilted);
  for (std::size_t i = 0; i < both.size(); ++i) both[i] = (both[i] + other[i]) / 2;
  for (const Geometry& frame : {level, tilted}) {
    const WorldUp up = find_world_up({}, frame, both);
    EXPECT_EQ(up.axis, UpAxis::z);
    EXPECT_THAT(up.source, StartsWith("by the camera of the shot, "));
  }
}

TEST(WorldUp, IsFoundInALeftHandedWorld) {
  const glm::mat3 mirror{{1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  EXPECT_EQ(find_world_up({}, seen({30, 10}, mirror)).axis, UpAxis::z);
  EXPECT_EQ(find_world_up({}, seen({30, 10}, kToYUp * mirror)).axis, UpAxis::y);
}

/// A plan of a world with z up is an elevation of one with y up.
TEST(WorldUp, OfAPlanIsAGuess) {
  const Surface ground = plane({}, {0, 0, 1});
  for (const bool orthographic : {false, true}) {
    const WorldUp up = find_world_up({}, seen({0, 90, 0, orthographic}, glm::mat3(1), ground));
    EXPECT_EQ(up.axis, UpAxis::y);
    EXPECT_EQ(up.source, "a guess");
    EXPECT_THAT(up.warning, HasSubstr("--env-up z"));
  }
}

TEST(WorldUp, OfAnotherAxisIsSaid) {
  const glm::mat3 to_x{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, down{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
  EXPECT_THAT(find_world_up({}, seen({30, 12}, to_x)).warning, HasSubstr("as if x were up"));
  EXPECT_THAT(find_world_up({}, seen({30, 12}, down)).warning, HasSubstr("as if -y were up"));
}

TEST(WorldUp, OfTheHeaderHolds) {
  GBuffer g;
  g.by_blender = true;
  const WorldUp agreed = find_world_up(g, seen({30, 12})),
                denied = find_world_up(g, seen({30, 12}, kToYUp));
  EXPECT_EQ(agreed.axis, UpAxis::z);
  EXPECT_EQ(agreed.source, "by the header");
  EXPECT_THAT(agreed.warning, IsEmpty());
  EXPECT_EQ(denied.axis, UpAxis::z);
  EXPECT_THAT(denied.warning, HasSubstr("as if y were"));
}

}  // namespace
}  // namespace ssdo::test::world_up_test
