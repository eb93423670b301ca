// SPDX-License-Identifier: Apache-2.0
//
// What an estimate says while it runs.
#include "relight/estimate.h"

#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"
#include "plan/make_plan.h"
#include "support/estimate_light.h"

namespace ssdo::test::estimate_test {
namespace {

Scene boxes() {
  const Window window{0, 0, 93, 71};
  Scene scene =
      scene_of(geometry_of(floor_and_wall(), tilted(camera_from_fov(40, window, 1), 45), window),
               Environment::constant(glm::vec3(1)), 0.5f);
  scene.solids = guess_solids(scene.geometry);
  return scene;
}

Plan plan_of(const Scene& scene, std::optional<double> error) {
  ModelOptions model;
  model.error = error;
  OutputOptions output;
  output.products = {"ao", "direct", "bounce", "error"};
  return make_plan(model, output, scene, {}, "in.exr");
}

/// What only methods look at does not come back, whether --error has several rounds or not.
TEST(Estimate, TakesTheSceneAndLeavesItWithoutSolids) {
  for (const std::optional<double> error : {std::optional<double>(), std::optional(1e-3)}) {
    const Scene scene = boxes();
    const Plan plan = plan_of(scene, error);
    const Estimate found = estimate_light(scene, plan);
    EXPECT_FALSE(scene.solids.thickness.empty()) << "the test needs some";
    EXPECT_TRUE(found.scene.solids.thickness.empty());
    EXPECT_EQ(found.scene.geometry.surfaces.size(), scene.geometry.surfaces.size());
    EXPECT_EQ(found.scene.senders.albedo.size(), scene.senders.albedo.size());
    EXPECT_EQ(found.request.slices > plan.request.slices, error.has_value())
        << "one round, or several";
  }
}

}  // namespace
}  // namespace ssdo::test::estimate_test
