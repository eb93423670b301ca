// SPDX-License-Identifier: Apache-2.0
//
// What an estimate says while it runs.
#include "estimate.h"

#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"

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

/// From when on the scene needs no solids; another round of --error needs them again.
TEST(Estimate, TellsOnceWhenSolidsMayBeFreed) {
  for (const std::optional<double> error : {std::optional<double>(), std::optional(1e-3)}) {
    Scene scene = boxes();
    const Plan plan = plan_of(scene, error);
    const Estimate kept = estimate(scene, plan, [](double) {}, {});
    int told = 0;
    const Estimate freed = estimate(
        scene, plan, [](double) {}, {},
        [&] {
          ++told;
          scene.solids = {};
        });
    EXPECT_EQ(told, 1);
    EXPECT_EQ(freed.products.ao.pixels, kept.products.ao.pixels);
    EXPECT_EQ(freed.products.bounce.pixels, kept.products.bounce.pixels);
    EXPECT_EQ(freed.products.error.pixels, kept.products.error.pixels);
    EXPECT_EQ(freed.request.slices > plan.request.slices, error.has_value())
        << "one round, or several";
  }
}

}  // namespace
}  // namespace ssdo::test
