// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/panorama.h"

#include <gtest/gtest.h>

#include "scene/camera/find_camera.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::panorama_test {
namespace {

const Window kWindow{0, 0, 96, 48};

Surface room() {
  return all_of({plane({0, 0, 0}, {0, 0, 1}), plane({0, 0, 3}, {0, 0, -1}),
                 plane({-2, 0, 0}, {1, 0, 0}), plane({4, 0, 0}, {-1, 0, 0}),
                 plane({0, -3, 0}, {0, 1, 0}), plane({0, 2, 0}, {0, -1, 0}),
                 sphere({1, 0.5, 1}, 0.6)});
}

Camera panorama_at(const glm::dvec3& eye, const glm::dvec3& target) {
  return look_at(lat_long(kWindow), eye, target, {0, 0, 1});
}

void expect_same(const Camera& found, const Camera& expected) {
  EXPECT_TRUE(found.panorama);
  EXPECT_LT(glm::distance(found.origin, expected.origin), 1e-5);
  for (int c = 0; c < 3; ++c)
    EXPECT_LT(glm::distance(found.rotation[c], expected.rotation[c]), 1e-5) << c;
}

TEST(Panorama, IsFittedWhereverItStandsAndLooks) {
  for (const glm::dvec3& target : {glm::dvec3(1, 0, 1), glm::dvec3(-1, -2, 0), {0.2, 0.1, 2.5}}) {
    const Camera camera = panorama_at({0, 0, 1.2}, target);
    const Picture picture = take_picture(room(), camera, kWindow);
    const auto found = fit_panorama(picture.position, picture.valid, kWindow, kWindow);
    ASSERT_TRUE(found);
    expect_same(*found, camera);
  }
}

TEST(Panorama, IsFittedFromAPartOfItsPicture) {
  const Camera camera = panorama_at({0, 0, 1.2}, {1, 0.3, 1});
  Picture picture = take_picture(room(), camera, kWindow);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < kWindow.width(); ++x) picture.valid(x, y) = 0;
  const auto found = fit_panorama(picture.position, picture.valid, kWindow, kWindow);
  ASSERT_TRUE(found);
  expect_same(*found, camera);
}

TEST(Panorama, ProjectsWhatItsRaysMeet) {
  const Camera camera = panorama_at({0, 0, 1.2}, {-1, 0.3, 0.4});
  for (const glm::dvec2& pixel : {glm::dvec2(1.5, 2.5), glm::dvec2(95.5, 46.5), {48, 24}}) {
    const Camera::Ray ray = camera.ray(pixel);
    const glm::dvec3 p = ray.origin + 3.0 * ray.direction;
    EXPECT_LT(glm::distance(camera.project(p), pixel), 1e-9);
    EXPECT_NEAR(camera.depth_of(p), 3, 1e-12);
  }
}

TEST(Panorama, IsTakenByTheFrameOnlyWhereNoPinholeExplainsP) {
  GeometryReport report;
  const Camera pinhole =
      look_at(camera_from_fov(60, kWindow, 1), {0, 0, 1.2}, {1, 0.5, 1}, {0, 0, 1});
  EXPECT_FALSE(find_camera(gbuffer_of(take_picture(room(), pinhole, kWindow)), {}, "p.exr", report)
                   .camera.panorama);
  const Camera panorama = panorama_at({0, 0, 1.2}, {1, 0.5, 1});
  EXPECT_TRUE(find_camera(gbuffer_of(take_picture(room(), panorama, kWindow)), {}, "p.exr", report)
                  .camera.panorama);
  const auto none = take_picture(room(), pinhole, kWindow);
  EXPECT_FALSE(fit_panorama(none.position, none.valid, kWindow, kWindow));
}

}  // namespace
}  // namespace ssdo::test::panorama_test
