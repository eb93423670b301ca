// SPDX-License-Identifier: Apache-2.0
//
// Light that bounces off what only other views show, in front of the unseen side of a solid: method
// bitmask has that of rays which take what they meet first.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>

#include "estimators/bitmask/request.h"
#include "estimators/trace.h"
#include "support/boxes.h"
#include "support/point_source.h"

namespace ssdo::test::nearer_senders_test {
namespace {

const Window kWindow{0, 0, 160, 120};

/// A white square that faces away from the camera, behind the box that hides it.
OtherSurfaces square_behind_box(const Camera& camera) {
  OtherSurfaces surfaces;
  for (const double z : {0.0, 1.0}) {
    for (const double x : {-0.5, 0.5}) {
      Vertex v;
      v.position = glm::vec3(camera.to_camera({x, 0.3, z}));
      v.normal = glm::vec3(camera.rotation * glm::dvec3(0, 1, 0));
      v.albedo = glm::vec3(1);
      v.footprint = 0.01f;
      v.sender = std::uint32_t(surfaces.vertices.size());
      surfaces.vertices.push_back(v);
    }
  }
  surfaces.added = surfaces.all = {{0, 1, 2}, {1, 3, 2}};
  return surfaces;
}

const Camera kCamera = look_at(camera_from_fov(50, kWindow, 1), {0, -4, 3}, {0, 0.3, 0}, {0, 0, 1});

/// A box on a floor, the square behind it, and a light that shines on the square.
Scene lit_scene() {
  const Surface scene_surface =
      all_of({plane({}, {0, 0, 1}), Box{{-0.5, -0.6, 0}, {0.5, -0.4, 1.1}}.surface()});
  Scene scene =
      scene_of(geometry_of(scene_surface, kCamera, kWindow), Environment::constant(glm::vec3(0)));
  scene.light.sources.push_back(
      std::make_shared<PointSource>(glm::vec3(kCamera.to_camera({0, 2, 0.6}))));
  scene.other_surfaces = square_behind_box(kCamera);
  return scene;
}

double sum_of_bounce(const Products& found) {
  double sum = 0;
  for (const glm::vec3& light : found.bounce.pixels) sum += double(light.x);
  return sum;
}

TEST(OtherViewBounce, WhatIsNearerThanTheUnseenSideOfASolidSends) {
  const Scene scene = lit_scene();
  double sums[2] = {};
  for (const bool traced : {false, true}) {
    const Method method = traced ? trace_method() : bitmask_method();
    Request request{.products = {.ao = true, .direct = true, .bounce = true},
                    .radius = kNoLimit,
                    .bounces = 1,
                    .slices = 8,
                    .steps = 256};
    if (traced) request.parameters["samples"] = 64;
    sums[traced] = sum_of_bounce(method.estimate(scene, request, {}));
  }
  fmt::print("bounce of a hidden square: {:.4f} by marches, {:.4f} by rays\n", sums[0], sums[1]);
  EXPECT_GT(sums[1], 1);
  EXPECT_NEAR(sums[0], sums[1], 0.2 * sums[1]);
}

/// A solid that is guessed behind the box sends the light of a pixel of the floor that is in the
/// dark; a view shows the lit square there.
TEST(OtherViewBounce, WhatIsOnlyGuessedSendsNothingWhereAViewShowsWhatIsThere) {
  Scene scene = lit_scene();
  scene.solids = constant_thickness(scene.geometry, 0.25f);
  const Surfaces& shown = scene.geometry.surfaces;
  const glm::mat3 to_world(glm::transpose(kCamera.rotation));
  const auto place = [&](std::size_t i) {
    return to_world * shown[i].position + glm::vec3(kCamera.origin);
  };
  int dark = -1;  // in front of the box
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const glm::vec3 p = place(i);
    if (std::abs(p.x) < 0.05f && std::abs(p.y + 0.7f) < 0.05f && p.z < 0.01f) dark = int(i);
  }
  ASSERT_GE(dark, 0);
  SolidLayer layer(kWindow.width(), kWindow.height(), Provenance::guessed);
  layer.thickness = Plane<float>(kWindow.width(), kWindow.height(), 0.05f);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const glm::vec3 p = place(i), way = glm::normalize(p - glm::vec3(kCamera.origin));
    const float to_square = (0.3f - p.y) / way.y;
    if (p.y > -0.35f || p.z < 0.05f || p.z + to_square * way.z < 0) continue;
    layer.distance[i] = to_square, layer.sender[i] = dark;
  }
  const Request request{.products = {.ao = true, .direct = true, .bounce = true},
                        .radius = kNoLimit,
                        .bounces = 1,
                        .slices = 8,
                        .steps = 256};
  const double without = sum_of_bounce(bitmask_method().estimate(scene, request, {}));
  scene.solids.behind.push_back(std::move(layer));
  const double with = sum_of_bounce(bitmask_method().estimate(scene, request, {}));
  fmt::print("bounce of the square: {:.4f}, {:.4f} with a guess\n", without, with);
  EXPECT_NEAR(with, without, 0.2 * without);
}

}  // namespace
}  // namespace ssdo::test::nearer_senders_test
