// SPDX-License-Identifier: Apache-2.0
//
// A depth beside P is the distance from the camera that P shows, and nothing else that P tells.
#include "scene/gbuffer/depth_check.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::depth_check_test {
namespace {

using testing::HasSubstr;

const Window kWindow{0, 0, 64, 48};

Picture ball_on_ground(bool orthographic) {
  const Camera projection =
      orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(40, kWindow, 1);
  return take_picture(all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)}),
                      look_at(projection, {0.5, -4, 3}, {0, 0, 0.3}, {0, 0, 1}), kWindow);
}

/// What is said of a depth that is this function of P and of P in camera space.
std::string said_of(const Picture& picture,
                    const std::function<double(const glm::dvec3&, const glm::dvec3&)>& depth) {
  GBuffer g = gbuffer_of(picture);
  g.depth = Plane<float>(kWindow.width(), kWindow.height());
  for (std::size_t i = 0; i < g.depth.size(); ++i) {
    const glm::dvec3 p(g.position[i]);
    g.depth[i] = float(depth(p, picture.camera.to_camera(p)));
    g.valid[i] &= g.depth[i] > 0;
  }
  return what_depth_is_instead(g, picture.camera);
}

TEST(DepthCheck, AcceptsDistancesFromTheCamera) {
  const Picture picture = ball_on_ground(false), parallel = ball_on_ground(true);
  EXPECT_EQ(said_of(picture, [](auto&, auto& q) { return -q.z; }), "");
  EXPECT_EQ(said_of(picture, [](auto&, auto& q) { return glm::length(q); }), "");
  // The far clip ends a third of the depths, or an average over an edge has changed them.
  EXPECT_EQ(said_of(picture, [](auto&, auto& q) { return std::min(-q.z, 5.4); }), "");
  // Without perspective, the camera may stand anywhere on its axis.
  EXPECT_EQ(said_of(parallel, [](auto&, auto& q) { return 3 - q.z; }), "");
}

TEST(DepthCheck, NamesWhatElsePTells) {
  const Picture picture = ball_on_ground(false);
  EXPECT_EQ(said_of(picture, [](auto& p, auto&) { return p.x; }), "it is the x of P");
  EXPECT_EQ(said_of(picture, [](auto& p, auto&) { return -p.y; }), "it is the y of P");
  EXPECT_EQ(said_of(picture, [](auto& p, auto&) { return p.z; }), "it is the z of P");
  EXPECT_EQ(said_of(picture, [](auto& p, auto&) { return glm::length(p); }),
            "it is the distance from the origin of P");
  EXPECT_EQ(said_of(picture, [](auto&, auto& q) { return 5 - q.z; }),
            "it is the distance from the camera + 5");
  EXPECT_EQ(said_of(picture, [](auto&, auto& q) { return glm::length(q) - 2; }),
            "it is the distance from the camera - 2");
  EXPECT_THAT(said_of(picture, [](auto& p, auto&) { return 3 + 0.6 * p.x + 0.8 * p.z; }),
              HasSubstr("not the distance from the camera"));
  EXPECT_EQ(said_of(ball_on_ground(true), [](auto& p, auto&) { return -p.y; }), "it is the y of P");
}

TEST(DepthCheck, NamesADepthOfNextToNothing) {
  const Picture picture = ball_on_ground(false);
  EXPECT_EQ(said_of(picture, [](auto& p, auto&) { return p.z > 1.19 ? p.z : -1; }),
            "it shows next to no surface");
}

}  // namespace
}  // namespace ssdo::test::depth_check_test
