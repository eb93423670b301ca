// SPDX-License-Identifier: Apache-2.0
//
// The layers of each light: their sums are the layers of all, a light's layer is what it gives
// alone, and the layers of all stay as they are to the bit.
#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "color/compose.h"
#include "estimators/bitmask/request.h"
#include "plan/make_plan.h"
#include "relight/estimate.h"
#include "scene/light/light_group.h"
#include "scene/light/painted_map.h"
#include "support/error_matchers.h"
#include "support/estimate_light.h"
#include "support/point_source.h"

namespace ssdo::test::light_layers_test {
namespace {

using testing::ElementsAre;

const Window kWindow{0, 0, 92, 68};

std::shared_ptr<PointSource> lamp(const std::string& name, const glm::vec3& at,
                                  const glm::vec3& light) {
  auto source = std::make_shared<PointSource>(at, light);
  source->name = name;
  return source;
}

/// A floor and a wall with a ball between two lamps of other colours, under a sky with a sun. One
/// lamp is so near the wall that it makes a bright sender of it.
Scene room() {
  const Camera camera = tilted(camera_from_fov(40, kWindow, 1), 45);
  const Environment map = paint(256, [](const glm::vec3& d) {
    if (in_disc(d, direction_of(-60, 50), 3)) return glm::vec3(100, 90, 80);
    return glm::vec3(1 + 0.3f * d.z, 1, 1 - 0.3f * d.x);
  });
  const Surface surface = all_of({floor_and_wall(), sphere({0.4, -0.6, 0.4}, 0.4)});
  Scene scene = scene_of(geometry_of(surface, camera, kWindow), map, 0.5f);
  scene.solids = guess_solids(scene.geometry);
  const auto place = [&](const glm::dvec3& world) { return glm::vec3(camera.to_camera(world)); };
  scene.light.sources.push_back(lamp("key", place({-1.2, -1, 1.5}), {4, 3, 1}));
  scene.light.sources.push_back(lamp("kick", place({0.2, -0.06, 0.5}), {1, 3, 9}));
  return scene;
}

/// The same with one lamp alone.
Scene with_only(Scene scene, const std::string& name) {
  for (LightGroup& light : light_groups_of(scene.light))
    if (light.name == name) scene.light = std::move(light.light);
  return scene;
}

Plan plan_of(const Scene& scene, const std::string& method, bool per_light,
             const std::string& filter = "geometry", int bounces = 2) {
  ModelOptions model;
  model.method = method;
  model.filter = filter;
  model.bounces = bounces;
  const SupportedOptions& supports = find_method(method).supports;
  if (supports.radius && !supports.infinite_radius) model.radius = 0.5;
  if (find_method(method).is_reference) model.set = {"samples=16"};
  OutputOptions output;
  output.products = {"direct", "unshadowed", "shadow"};
  if (find_method(method).products.bounce) output.products.emplace_back("bounce");
  output.per_light = per_light;
  return make_plan(model, output, scene, {}, "in.exr");
}

Estimate run(const Scene& scene, const Plan& plan) { return estimate_light(scene, plan); }

/// Root mean square of a - b, relative to the mean of b.
double difference(const Plane<glm::vec3>& a, const Plane<glm::vec3>& b) {
  double sum = 0, mean = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(a[i]) - glm::dvec3(b[i]);
    sum += glm::dot(d, d) / 3;
    mean += (double(b[i].x) + double(b[i].y) + double(b[i].z)) / 3;
  }
  return std::sqrt(sum * double(b.size())) / mean;
}

template <class Member>
Plane<glm::vec3> sum_of(const Products& products, const Member& member) {
  Plane<glm::vec3> sum(kWindow.width(), kWindow.height(), glm::vec3(0));
  for (const LightProducts& light : products.lights)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += (light.*member)[i];
  return sum;
}

TEST(LightLayers, AddUpToTheLightOfAllWhichStaysAsItIs) {
  const Scene scene = room();
  for (const Method& method : methods()) {
    // Methods without solids refuse lamps.
    if (!method.products.direct || !method.supports.thickness) continue;
    for (const char* filter : {"geometry", "none", "box"}) {
      SCOPED_TRACE(std::string(method.name) + " " + filter);
      const Products
          without = run(scene, plan_of(scene, std::string(method.name), false, filter)).products,
          with = run(scene, plan_of(scene, std::string(method.name), true, filter)).products;
      EXPECT_TRUE(without.lights.empty());
      ASSERT_EQ(with.lights.size(), 3u);
      EXPECT_EQ(with.lights[0].name, "env");
      EXPECT_EQ(with.lights[1].name, "key");
      EXPECT_EQ(with.lights[2].name, "kick");
      EXPECT_EQ(with.direct.pixels, without.direct.pixels);
      EXPECT_LT(difference(sum_of(with, &LightProducts::direct), with.direct), 1e-6);
      if (!method.products.bounce) continue;
      EXPECT_EQ(with.bounce.pixels, without.bounce.pixels);
      EXPECT_LT(difference(sum_of(with, &LightProducts::bounce), with.bounce), 1e-4);
      for (const LightProducts& light : with.lights)
        EXPECT_GT(difference(light.bounce, with.bounce), 0.1) << light.name << " is all of it";
    }
  }
}

TEST(LightLayers, AreWhatALightGivesAlone) {
  const Scene scene = room();
  for (const auto& [method, of_direct, of_bounce] :
       {std::tuple{"trace", 1e-6, 1e-6}, {"bitmask", 1e-6, 0.02}}) {
    const Products all = run(scene, plan_of(scene, method, true)).products;
    for (const LightProducts& light : all.lights) {
      SCOPED_TRACE(std::string(method) + " " + light.name);
      const Scene alone = with_only(scene, light.name);
      const Products one = run(alone, plan_of(alone, method, false)).products;
      EXPECT_LT(difference(light.direct, one.direct), of_direct);
      // What the lamp at the wall lights is brighter among darker things if it is alone.
      const bool other_level = light.name == "kick" && of_bounce > 1e-3;
      EXPECT_LT(difference(light.bounce, one.bounce), other_level ? 0.2 : of_bounce);
    }
  }
}

TEST(LightLayers, RaysGoToTheSendersThatAreBrightInTheLightOfAll) {
  const Scene scene = room();
  Request request = plan_of(scene, "bitmask", true).request;
  const Products found = find_method("bitmask").estimate(scene, request, {});
  ASSERT_FALSE(found.visibility.emitted.empty()) << "the test needs bright senders";
  ASSERT_EQ(found.lights.size(), 3u);
  Plane<glm::vec3> sum(kWindow.width(), kWindow.height(), glm::vec3(0));
  for (const LightProducts& light : found.lights)
    for (std::size_t i = 0; i < light.emitted.size(); ++i) sum[i] += light.emitted[i];
  EXPECT_LT(difference(sum, found.visibility.emitted), 1e-4);
  EXPECT_LT(difference(found.lights[2].emitted, found.visibility.emitted), 0.3)
      << "most of it is of the lamp at the wall";
}

TEST(LightLayers, OfASingleLightAreThoseOfAll) {
  Scene scene = room();
  scene.light.sources.resize(1);
  ASSERT_TRUE(scene.light.sources[0]->name.empty());
  const Products found = run(scene, plan_of(scene, "bitmask", true)).products;
  ASSERT_EQ(found.lights.size(), 1u);
  EXPECT_EQ(found.lights[0].name, "env");
  EXPECT_EQ(found.lights[0].bounce.pixels, found.bounce.pixels);
  EXPECT_LT(difference(found.lights[0].direct, found.direct), 1e-6);
}

TEST(LightLayers, HoldWhatWasAskedForOnly) {
  const Scene scene = room();
  Plan plan = plan_of(scene, "bitmask", true);
  plan.request.by_light.direct = false;
  const Products bounce = run(scene, plan).products;
  EXPECT_TRUE(bounce.lights[1].direct.empty());
  EXPECT_FALSE(bounce.lights[1].bounce.empty());
  plan.request.by_light = {.direct = true};
  const Products direct = run(scene, plan).products;
  EXPECT_FALSE(direct.lights[1].direct.empty());
  EXPECT_TRUE(direct.lights[1].bounce.empty());
}

TEST(LightLayers, UnshadowedAloneNeedsNoEstimate) {
  const Scene scene = room();
  OutputOptions output;
  output.products = {"unshadowed"};
  output.per_light = true;
  const Plan plan = make_plan({}, output, scene, {}, "in.exr");
  EXPECT_EQ(plan.request.products, ProductSet());
  const Products found = run(scene, plan).products;
  EXPECT_TRUE(found.ao.empty());
  const GBuffer gbuffer;
  const Results results{scene, gbuffer, found, plan.composition};
  const NamedChannels all = product_channels("unshadowed", results);
  const std::vector<NamedChannels> each = light_channels("unshadowed", results);
  ASSERT_EQ(each.size(), 3u);
  EXPECT_EQ(each[2].channels[1].name, "unshadowed.kick.G");
  for (std::size_t i = 0; i < scene.geometry.surfaces.size(); ++i) {
    const Surfel& s = scene.geometry.surfaces[i];
    const float expected = s.is_surface() ? scene.light.unoccluded(s.position, s.normal).y : 0.0f;
    EXPECT_EQ(all.channels[1].pixels[i], expected);
    float sum = 0;
    for (const NamedChannels& light : each) sum += light.channels[1].pixels[i];
    EXPECT_NEAR(sum, expected, 1e-6 * expected);
  }
}

TEST(LightLayers, OfTheEnvironmentAreLeftOutWhereItIsNone) {
  Scene scene = room();
  Light lamps;
  for (const auto& source : scene.light.sources)
    if (!source->name.empty()) lamps.sources.push_back(source);
  scene.light = lamps;
  const std::vector<LightGroup> lights = light_groups_of(scene.light);
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].name, "key");
  EXPECT_THAT(lights[1].source_indices, ElementsAre(1));
  EXPECT_EQ(light_groups_of(Light()).at(0).name, "env") << "one light is always there";
}

TEST(LightLayers, NeedNamesOfTheirOwnAndSendersThatAreLit) {
  Scene scene = room();
  scene.light.sources.push_back(lamp("key", {}, {}));
  EXPECT_THAT(error_of([&] { plan_of(scene, "bitmask", true); }),
              IsError(ExitCode::usage, "light 'key': the layers of two lights"));
  scene.light.sources.back() = lamp("env", {}, {});
  EXPECT_THAT(error_of([&] { plan_of(scene, "bitmask", true); }),
              IsError(ExitCode::usage, "light 'env': the layers of the environment"));
  plan_of(scene, "bitmask", false);
  scene = room();
  scene.senders.radiance = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(1));
  EXPECT_THAT(error_of([&] { plan_of(scene, "bitmask", true); }),
              IsError(ExitCode::usage, "in.exr: --per-light: the layer of radiance"));
}

/// shadow times unshadowed is direct, of all light and of each, for one merge.
TEST(LightLayers, ShadowTimesUnshadowedIsDirect) {
  const Scene scene = room();
  for (const Method& method : methods()) {
    if (!method.products.direct || !method.supports.thickness) continue;
    const Plan plan = plan_of(scene, std::string(method.name), true, "geometry", 0);
    const Products found = run(scene, plan).products;
    for (const int factor : {1, 4}) {
      SCOPED_TRACE(std::string(method.name) + " " + std::to_string(factor));
      GBuffer gbuffer;
      gbuffer.window = gbuffer.display = kWindow;
      gbuffer.downsampling = {factor, kWindow};
      const Results results{scene, gbuffer, found, plan.composition};
      const auto layers = [&](const std::string& product) {
        std::vector<NamedChannels> all = light_channels(product, results);
        all.push_back(product_channels(product, results));
        return all;
      };
      const auto direct = layers("direct"), unshadowed = layers("unshadowed"),
                 shadow = layers("shadow");
      ASSERT_EQ(direct.size(), 4u);
      double brightest = 0;
      for (std::size_t k = 0; k < direct.size(); ++k) {
        for (int c = 0; c < 3; ++c) {
          const ChannelView &d = direct[k].channels[std::size_t(c)].pixels,
                            &u = unshadowed[k].channels[std::size_t(c)].pixels,
                            &s = shadow[k].channels[std::size_t(c)].pixels;
          for (std::size_t i = 0; i < std::size_t(d.width * d.height); ++i) {
            EXPECT_NEAR(s[i] * u[i], d[i], 3e-7 * d[i]);
            if (method.name == "bitmask") {
              EXPECT_LE(s[i], 1 + 1e-5f);
            }
            brightest = std::max(brightest, double(d[i]));
          }
        }
      }
      EXPECT_GT(brightest, 1);
    }
  }
}

/// The plan of a composite asks for what it takes, and refuses what cannot be.
TEST(LightLayers, ArePlannedForAComposite) {
  Scene scene = room();
  GBuffer gbuffer;
  gbuffer.beauty = Plane<glm::vec3>(1, 1);
  gbuffer.lights["key"] = Plane<glm::vec3>(1, 1);
  OutputOptions output;
  output.products = {"composite"};
  const auto plan = [&] { return make_plan({}, output, scene, gbuffer, "in.exr"); };
  EXPECT_EQ(plan().composition.compose, Compose::occlude) << "a layer of a lamp asks for it";
  EXPECT_EQ(plan().request.by_light, (ProductSet{.direct = true}));
  EXPECT_EQ(plan().request.products, (ProductSet{.direct = true})) << "no ao without ambient";
  EXPECT_FALSE(plan().composition.per_light);
  gbuffer.ambient = Plane<glm::vec3>(1, 1);
  gbuffer.lights.clear();
  EXPECT_EQ(plan().request.by_light, (ProductSet{.direct = true})) << "that of the environment";
  gbuffer.lights["key"] = Plane<glm::vec3>(1, 1);
  Light constant = model_light(Environment::constant(glm::vec3(1)), glm::mat3(1));
  constant.sources.push_back(lamp("key", {}, {1, 1, 1}));
  scene.light = constant;
  EXPECT_TRUE(plan().composition.share_is_ao) << "the environment is constant, whatever lamps do";
  EXPECT_EQ(plan().request.products, (ProductSet{.ao = true, .direct = true}));
  gbuffer.lights["kye"] = Plane<glm::vec3>(1, 1);
  EXPECT_THAT(error_of([&] { plan(); }),
              IsError(ExitCode::usage, "in.exr: --aov light:kye: there is no lamp 'kye'"));
  gbuffer.lights.erase("kye");
  gbuffer.beauty = {};
  EXPECT_THAT(error_of([&] { plan(); }), IsError(ExitCode::layer, "--aov light:key"));
}

}  // namespace
}  // namespace ssdo::test::light_layers_test
