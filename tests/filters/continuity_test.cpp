// SPDX-License-Identifier: Apache-2.0
//
// Cuts between frames that share a floor, and what is none.
#include "filters/continuity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>

#include "support/analytic_scene.h"
#include "support/random_frame.h"

namespace ssdo::test::continuity_test {
namespace {

const Window kWindow{0, 0, 96, 72};

struct Shot {
  Geometry geometry;
  Plane<HalfColor> albedo;

  FrameSurfaces view() const { return {geometry, albedo}; }
};

using Texture = std::function<glm::vec3(const glm::dvec3& world)>;

Shot take(const Surface& things, const Camera& camera, const Texture& texture) {
  Shot shot{geometry_of(all_of({plane({}, {0, 0, 1}), things}), camera, kWindow),
            Plane<HalfColor>(kWindow.width(), kWindow.height())};
  for (std::size_t i = 0; i < shot.albedo.size(); ++i) {
    const glm::dvec3 p(shot.geometry.surfaces[i].position);
    if (shot.geometry.is_surface(i))
      shot.albedo[i] = texture(camera.origin + glm::transpose(camera.rotation) * p);
  }
  return shot;
}

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target = {0, 0, 0.3}) {
  return look_at(camera_from_fov(50, kWindow, 1), eye, target, {0, 0, 1});
}

const glm::dvec3 kEye(0, -4, 3);
const Surface kBall = sphere({0.2, 0, 0.6}, 0.6);

glm::vec3 grey(const glm::dvec3&) { return glm::vec3(0.5f); }
glm::vec3 brown(const glm::dvec3&) { return {0.35f, 0.22f, 0.12f}; }
/// Squares about as wide as a pixel.
glm::vec3 checks(const glm::dvec3& p) {
  const auto odd = [](double x) { return int(std::floor(20 * x)) & 1; };
  return odd(p.x) == odd(p.y) ? glm::vec3(0.8f, 0.7f, 0.6f) : glm::vec3(0.1f, 0.15f, 0.2f);
}

bool is_cut(const Shot& before, const Shot& now) {
  return compare_frames(before.view(), now.view()).is_cut();
}

/// Issue 12, 7: the floor at z = 0 is the same in both, but its albedo is another one.
TEST(Continuity, OtherScenesOnTheSameFloorAreACut) {
  const Shot before = take(kBall, camera_at(kEye), grey);
  const Surface card = cut(plane({0, 0.5, 0}, {0, 1, 0}),
                           [](const glm::dvec3& p) { return std::abs(p.x) < 1 && p.z < 1.5; });
  for (const glm::dvec3& eye : {kEye, glm::dvec3(1, -3.5, 2.6), glm::dvec3(-3, -3, 4)})
    for (const Texture& texture : {Texture(brown), Texture(checks)})
      EXPECT_TRUE(is_cut(before, take(card, camera_at(eye), texture))) << eye.x;
}

/// Without an albedo a table tells that covers most of the floor in one of the frames: the other
/// saw through it.
TEST(Continuity, WithoutAlbedoTheThingsTell) {
  const Surface table = cut(plane({0, 0, 1}, {0, 0, 1}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 1.8 && std::abs(p.y) < 1.5;
  });
  const Camera camera = camera_at({0, -0.5, 6}, {0, 0, 0});
  Shot before = take(kBall, camera, grey), now = take(table, camera, grey);
  before.albedo = now.albedo = {};
  EXPECT_TRUE(is_cut(before, now));
  EXPECT_TRUE(is_cut(now, before));
  EXPECT_FALSE(is_cut(before, before));
}

TEST(Continuity, FastCamerasAreNoCut) {
  for (const Texture& texture : {Texture(grey), Texture(checks)}) {
    const Shot before = take(kBall, camera_at(kEye), texture);
    // A pan that leaves a tenth of the picture, an orbit by 60 degrees, a zoom, and a look at
    // something else altogether.
    for (const Camera& camera : {camera_at(kEye, {4, 0, 0.3}), camera_at({3.5, -2, 3}),
                                 camera_at({0, -1.5, 1.2}), camera_at({20, 30, 3}, {20, 40, 0})})
      EXPECT_FALSE(is_cut(before, take(kBall, camera, texture))) << camera.origin.x;
  }
}

TEST(Continuity, ThingsThatMoveAreNoCut) {
  const Shot before = take(sphere({-0.9, 0, 0.8}, 0.8), camera_at(kEye), checks),
             now = take(sphere({0.9, 0, 0.8}, 0.8), camera_at(kEye), checks);
  EXPECT_FALSE(is_cut(before, now));
}

TEST(Continuity, NoiseOfAlbedoIsNoCut) {
  const auto noisy = [](unsigned seed, float size) {
    Shot shot = take(kBall, camera_at({0.05 * seed, -4, 3}), grey);
    Random random(seed);
    for (HalfColor& c : shot.albedo.pixels) c = glm::vec3(c) + vector_of(random, size);
    return shot;
  };
  for (const float size : {0.1f, 0.3f}) EXPECT_FALSE(is_cut(noisy(0, size), noisy(1, size)));
}

/// Motion in other units than the cameras' does not make every frame a cut.
TEST(Continuity, WrongMotionIsNoCut) {
  const Shot shot = take(kBall, camera_at(kEye), checks);
  for (const glm::vec2& motion : {glm::vec2(20, -15), glm::vec2(1e4f, 0), glm::vec2(NAN, NAN)}) {
    const Plane<glm::vec2> wrong(kWindow.width(), kWindow.height(), motion);
    EXPECT_FALSE(compare_frames(shot.view(), shot.view(), wrong).is_cut());
  }
}

}  // namespace
}  // namespace ssdo::test::continuity_test
