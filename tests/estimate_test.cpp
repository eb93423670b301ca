// SPDX-License-Identifier: Apache-2.0
//
// When an estimate gives up what only it needs.
#include "relight/estimate.h"

#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"
#include "plan/make_plan.h"

namespace ssdo::test {
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

/// Another round of --error needs the solids again.
TEST(Estimate, FreesOccludersAfterTheLastRound) {
  for (const std::optional<double> error : {std::optional<double>(), std::optional(1e-3)}) {
    Scene scene = boxes();
    const Plan plan = plan_of(scene, error);
    const Estimate kept = estimate(scene, plan, [](double) {}, {});
    EXPECT_FALSE(scene.solids.thickness.empty());
    const Estimate freed = estimate_and_free(scene, plan, [](double) {}, {});
    EXPECT_TRUE(scene.solids.thickness.empty());
    EXPECT_EQ(freed.products.ao.pixels, kept.products.ao.pixels);
    EXPECT_EQ(freed.products.bounce.pixels, kept.products.bounce.pixels);
    EXPECT_EQ(freed.products.error.pixels, kept.products.error.pixels);
    EXPECT_EQ(freed.request.slices > plan.request.slices, error.has_value())
        << "one round, or several";
  }
}

}  // namespace
}  // namespace ssdo::test
