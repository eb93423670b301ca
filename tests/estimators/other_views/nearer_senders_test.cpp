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

TEST(OtherViewBounce, WhatIsNearerThanTheUnseenSideOfASolidSends) {
  const Surface scene_surface =
      all_of({plane({}, {0, 0, 1}), Box{{-0.5, -0.6, 0}, {0.5, -0.4, 1.1}}.surface()});
  const Camera camera =
      look_at(camera_from_fov(50, kWindow, 1), {0, -4, 3}, {0, 0.3, 0}, {0, 0, 1});
  Scene scene =
      scene_of(geometry_of(scene_surface, camera, kWindow), Environment::constant(glm::vec3(0)));
  scene.light.sources.push_back(
      std::make_shared<PointSource>(glm::vec3(camera.to_camera({0, 2, 0.6}))));
  scene.other_surfaces = square_behind_box(camera);
  double sums[2] = {};
  for (const bool traced : {false, true}) {
    const Method method = traced ? trace_method() : bitmask_method();
    Request request{.products = {.ao = true, .direct = true, .bounce = true},
                    .radius = kNoLimit,
                    .bounces = 1,
                    .slices = 8,
                    .steps = 256};
    if (traced) request.parameters["samples"] = 64;
    const Products out = method.estimate(scene, request, {});
    for (const glm::vec3& light : out.bounce.pixels) sums[traced] += double(light.x);
  }
  fmt::print("bounce of a hidden square: {:.4f} by marches, {:.4f} by rays\n", sums[0], sums[1]);
  EXPECT_GT(sums[1], 1);
  EXPECT_NEAR(sums[0], sums[1], 0.2 * sums[1]);
}

}  // namespace
}  // namespace ssdo::test::nearer_senders_test
