// SPDX-License-Identifier: Apache-2.0
//
// What is asked for, and what is planned: products and the planes that a method is asked for, the
// options that methods take, and the reasons.
#include "plan/plan.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>

#include "estimators/registry.h"
#include "plan/make_plan.h"
#include "support/error_matchers.h"
#include "support/point_source.h"
#include "support/scene_of.h"

namespace ssdo::test::plan_test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using Names = std::vector<std::string>;

/// A frame of one pixel, and what is asked of it.
struct Case {
  ModelOptions model = {};
  OutputOptions output = {};
  bool albedo = true, roughness = false, ambient = false, beauty = false, specular = false;
  float brightest_albedo = 0.5f;
  bool map = false;  ///< light from directions, not from everywhere alike
  bool lamp = false;
};

Plan plan_of(const Case& c) {
  Geometry geometry;
  geometry.surfaces = Surfaces(1, 1);
  geometry.surfaces.set_position(0, {0, 0, -2}), geometry.surfaces.rounding[0] = 0;
  geometry.median_depth = 2;
  geometry.camera = camera_from_fov(90, {0, 0, 1, 1}, 1);
  geometry.display = geometry.window = {0, 0, 1, 1};
  const auto map = std::make_shared<Plane<glm::vec3>>(4, 2, glm::vec3(1));
  Scene scene =
      scene_of(geometry, c.map ? Environment(map, {}) : Environment::constant(glm::vec3(1)),
               c.brightest_albedo);
  if (!c.albedo) scene.senders.albedo = {};
  if (c.lamp) {
    const auto lamp = std::make_shared<PointSource>(glm::vec3(0, 1, -1));
    lamp->name = "key";
    scene.light.sources.push_back(lamp);
  }
  if (c.roughness) scene.roughness = Plane<float>(1, 1);
  GBuffer gbuffer;
  if (c.ambient) gbuffer.ambient = Plane<glm::vec3>(1, 1);
  if (c.beauty) gbuffer.beauty = Plane<glm::vec3>(1, 1);
  if (c.specular) gbuffer.specular = Plane<glm::vec3>(1, 1);
  return make_plan(c.model, c.output, scene, gbuffer, "in.exr");
}

ModelOptions of_method(const std::string& method) {
  ModelOptions model;
  model.method = method;
  return model;
}

OutputOptions to(Names files, Names products = {}) {
  OutputOptions output;
  output.files = std::move(files);
  output.products = std::move(products);
  return output;
}

OutputOptions composite(std::optional<Compose> compose) {
  OutputOptions output = to({"out.exr"}, {"composite"});
  output.compose = compose;
  return output;
}

struct ProductCase {
  const char* what;
  Case asked;
  Names make;
  ProductSet of_method;
};

TEST(Plan, MakesTheProductsThatAreAskedForAndAsksTheMethodForTheirParts) {
  ModelOptions with_bounces = of_method("gtao");
  with_bounces.set = {"multi-bounce=1"};
  const OutputOptions exr = to({"out.exr"}), everything = to({"out.exr"}, {"all"});
  const ProductSet lit{.ao = true, .direct = true, .bounce = true};
  const ProductCase cases[] = {
      {"usual", {{}, exr}, {"ao", "direct", "bounce", "composite"}, lit},
      {"without albedo",
       {.output = exr, .albedo = false},
       {"ao", "direct"},
       {.ao = true, .direct = true}},
      {"ambient light in place of albedo",
       {.output = composite({}), .albedo = false, .ambient = true},
       {"composite"},
       {.ao = true}},
      {"ambient light under a map",
       {.output = composite({}), .albedo = false, .ambient = true, .map = true},
       {"composite"},
       {.direct = true}},
      {"bounces that a method counts in direct",
       {.model = with_bounces, .output = composite({}), .ambient = true},
       {"composite"},
       {.direct = true}},
      {"a specular layer",
       {.output = composite({}), .ambient = true, .specular = true},
       {"composite"},
       {.ao = true, .reflection = true}},
      {"relight, in spite of an ambient layer",
       {.output = composite(Compose::relight), .ambient = true},
       {"composite"},
       {.direct = true, .bounce = true}},
      {"add",
       {.output = composite(Compose::add), .ambient = true, .beauty = true},
       {"composite"},
       {.direct = true, .bounce = true}},
      {"a method without bounce",
       {of_method("ssao"), exr},
       {"ao", "direct", "composite"},
       {.ao = true, .direct = true}},
      {"all",
       {{}, everything},
       {"ao", "bent", "direct", "unshadowed", "shadow", "bounce", "error", "guessed", "composite"},
       {.ao = true, .direct = true, .bounce = true, .bent = true, .error = true, .guessed = true}},
      {"all of a method with reflection, without roughness",
       {of_method("gtao"), everything},
       {"ao", "bent", "direct", "unshadowed", "shadow", "composite"},
       {.ao = true, .direct = true, .bent = true}},
      {"all with roughness",
       {.model = of_method("gtao"), .output = everything, .roughness = true},
       {"ao", "bent", "reflection", "direct", "unshadowed", "shadow", "composite"},
       {.ao = true, .direct = true, .bent = true, .reflection = true}},
      {"reflection by name, without roughness",
       {of_method("gtao"), to({"out.exr"}, {"reflection"})},
       {"reflection"},
       {.reflection = true}},
      {"error, in the order of the table",
       {{}, to({"out.exr"}, {"error", "ao"})},
       {"ao", "error"},
       {.ao = true, .direct = true, .bounce = true, .error = true}},
      {"error without albedo",
       {.output = to({"out.exr"}, {"error"}), .albedo = false},
       {"error"},
       {.direct = true, .error = true}},
      {"a picture", {{}, to({"out.png"})}, {"composite"}, {.direct = true, .bounce = true}},
      {"a picture of ao", {{}, to({"out.png"}, {"ao"})}, {"ao"}, {.ao = true}},
  };
  for (const ProductCase& c : cases) {
    SCOPED_TRACE(c.what);
    const Plan plan = plan_of(c.asked);
    EXPECT_EQ(plan.make, c.make);
    EXPECT_EQ(plan.request.products, c.of_method);
  }
}

TEST(Plan, SavesAloneMakeNothingElse) {
  OutputOptions output;
  output.saves = {{"bent", "bent.exr"}, {"ao", "ao.png"}};
  const Plan plan = plan_of({{}, output});
  EXPECT_EQ(plan.make, (Names{"ao", "bent"}));
  EXPECT_EQ(plan.write, Names());
  EXPECT_EQ(plan.request.products, (ProductSet{.ao = true, .bent = true}));
}

TEST(Plan, AnErrorToStayBelowIsMeasuredButNotWritten) {
  ModelOptions model;
  model.error = 0.1;
  const Plan plan = plan_of({model, to({"out.exr"}, {"ao"})});
  EXPECT_EQ(plan.make, Names{"ao"});
  EXPECT_TRUE(plan.request.products.error && plan.request.products.bounce);
}

TEST(Plan, RefusesProductsThatCannotBeMade) {
  const auto refused = [](const Case& c) { return error_of([&] { plan_of(c); }); };
  const OutputOptions exr = to({"out.exr"});
  EXPECT_THAT(refused({{}, to({"out.exr"}, {"normals"})}),
              IsError(ExitCode::usage, "product 'normals': no such product; there are ao, bent"));
  EXPECT_THAT(refused({of_method("ssao"), to({"out.exr"}, {"bent"})}),
              IsError(ExitCode::usage, "ssao makes no bent; these do: bitmask, trace, gtao"));
  EXPECT_THAT(refused({.output = to({"out.exr"}, {"bounce"}), .albedo = false}),
              IsError(ExitCode::layer, "in.exr: bounce needs a layer for albedo"));
  EXPECT_THAT(refused({.output = to({"out.png"}), .albedo = false}),
              IsError(ExitCode::layer, "composite needs a layer for albedo"));
  EXPECT_THAT(refused({{}, to({"out.png"}, {"ao", "direct"})}),
              IsError(ExitCode::usage, "a picture shows one product"));
  OutputOptions add = to({"out.exr"});
  add.compose = Compose::add;
  EXPECT_THAT(refused({.output = add, .albedo = false, .beauty = true}),
              IsError(ExitCode::layer, "in.exr: composite needs a layer for albedo"))
      << "what is asked for is not left out";
  EXPECT_THAT(
      refused({.model = of_method("ssao"), .output = exr, .ambient = true, .specular = true}),
      IsError(ExitCode::usage,
              "method ssao makes no reflection for the composite; these do: "
              "bitmask, trace, gtao"));
}

TEST(Plan, RefusesLampsWhereTheMethodSendsNoRaysToThem) {
  const OutputOptions light = to({"out.exr"}, {"direct"}), ao = to({"out.exr"}, {"ao"});
  for (const Method& method : methods()) {
    const Case lit{.model = of_method(std::string(method.name)), .output = light, .lamp = true};
    Case open = lit;
    open.output = ao;
    EXPECT_NO_THROW(plan_of(open)) << method.name;
    if (method.name == "bitmask" || method.name == "trace") {
      EXPECT_NO_THROW(plan_of(lit)) << method.name;
    } else if (method.products.direct) {
      EXPECT_THAT(error_of([&] { plan_of(lit); }),
                  IsError(ExitCode::usage, "knows no shadows of lamps; take bitmask or trace"));
    }
  }
}

TEST(Plan, SlicesAndStepsReachParametersOfTheseNames) {
  ModelOptions by_option = of_method("gtao"), by_set = by_option;
  by_option.slices = 3;
  by_option.steps = 5;
  by_set.set = {"slices=3", "steps=5"};
  const Plan plan = plan_of({by_option});
  EXPECT_EQ(plan.request.parameters, plan_of({by_set}).request.parameters);
  EXPECT_EQ(plan.samples_per_pixel(), 2 * 3 * 5);
  ModelOptions hbao = of_method("hbao");
  hbao.steps = 6;
  EXPECT_EQ(plan_of({hbao}).samples_per_pixel(), 4 * 6);
  ModelOptions march;
  march.slices = 3;
  march.steps = 5;
  EXPECT_EQ(plan_of({march}).samples_per_pixel(), 2 * 3 * 5);
}

TEST(Plan, ARadiusBringsHalfAsManyStepsAgain) {
  for (const QualityLevel& level : kQualities) {
    ModelOptions model;
    model.quality = level.quality;
    EXPECT_EQ(plan_of({model}).request.steps, level.steps) << level.name;
    model.radius = 3;
    EXPECT_EQ(plan_of({model}).request.steps, level.steps * 3 / 2) << level.name;
    model.steps = 9;
    EXPECT_EQ(plan_of({model}).request.steps, 9) << "as asked";
  }
}

TEST(Plan, RefusesOptionsThatTheMethodDoesNotTake) {
  const auto refused = [](const std::string& method, const auto& change) {
    ModelOptions model = of_method(method);
    change(model);
    return error_of([&] { plan_of({model}); });
  };
  EXPECT_THAT(refused("ssdo", [](ModelOptions& m) { m.slices = 3; }),
              IsError(ExitCode::usage, "method ssdo takes no --slices;"));
  EXPECT_THAT(refused("hbao", [](ModelOptions& m) { m.slices = 3; }),
              IsError(ExitCode::usage, "method hbao takes no --slices;"));
  EXPECT_THAT(refused("sao", [](ModelOptions& m) { m.steps = 3; }),
              IsError(ExitCode::usage, "takes no --steps"));
  EXPECT_THAT(refused("gtao", [](ModelOptions& m) { m.thickness = 1; }),
              IsError(ExitCode::usage, "takes no --thickness"));
  EXPECT_THAT(refused("trace", [](ModelOptions& m) { m.error = 1; }),
              IsError(ExitCode::usage, "takes no --error"));
  EXPECT_THAT(refused("msvo", [](ModelOptions& m) { m.radius = 1; }),
              IsError(ExitCode::usage, "takes no --radius"));
  EXPECT_THAT(refused("ssao", [](ModelOptions& m) { m.radius = INFINITY; }),
              IsError(ExitCode::usage, "--radius inf: method ssao needs a limit"));
  EXPECT_THAT(refused("gtao", [](ModelOptions& m) { m.slices = 65; }),
              IsError(ExitCode::usage, "--slices 65: slices takes whole numbers from 1 to 64"));
  const auto both = [](ModelOptions& m) {
    m.slices = 3;
    m.set = {"slices=3"};
  };
  EXPECT_THAT(refused("gtao", both),
              IsError(ExitCode::usage, "--slices 3 and --set slices=3 set the same"));
}

TEST(Plan, TheRadiusIsEndlessWhereTheMethodSeesBehindThingsAndChosenElsewhere) {
  EXPECT_EQ(plan_of({}).request.radius, INFINITY);
  EXPECT_EQ(plan_of({of_method("trace")}).request.radius, INFINITY);
  // 0.3 of a frame that is 4 high where 90 degrees are 2 away.
  EXPECT_NEAR(plan_of({of_method("ssao")}).request.radius, 1.2f, 1e-5f);
  ModelOptions given = of_method("ssao");
  given.radius = 7;
  EXPECT_EQ(plan_of({given}).request.radius, 7);
  EXPECT_EQ(plan_of({of_method("msvo")}).request.radius, 0);
}

TEST(Plan, WorkThatChangesNothingIsLeftOut) {
  ModelOptions model;
  model.bounces = 3;
  EXPECT_EQ(plan_of({model}).request.bounces, 3);
  EXPECT_EQ(plan_of({model, to({"out.exr"}, {"ao"})}).request.bounces, 0);
  model.method = "ssao";
  EXPECT_EQ(plan_of({model}).request.bounces, 0) << "it makes none";
}

struct ReasonCase {
  const char* what;
  Case asked;
  const char* reason;
};

TEST(Plan, SaysWhyItDecidedSo) {
  ModelOptions radius, thickness, one_slice, open, roughness = of_method("gtao");
  radius.radius = 3;
  thickness.thickness = 2;
  one_slice.slices = 1;
  open.extend_offscreen = false;
  roughness.set = {"roughness=0.25"};
  const ReasonCase cases[] = {
      {"no albedo", {.albedo = false}, "no bounce and no composite: there is no albedo"},
      {"no albedo, ambient", {.albedo = false, .ambient = true}, "no bounce: there is no albedo"},
      {"relight", {}, "composite relight: albedo (direct + bounce); no ambient layer is given"},
      {"ambient",
       {.ambient = true},
       "composite occlude: the ambient layer, as there is no beauty, times ao; an ambient layer is "
       "given"},
      {"beauty",
       {.output = composite(Compose::occlude), .ambient = true, .beauty = true, .specular = true},
       "composite occlude: the beauty with its ambient layer times ao, and its specular layer "
       "times "
       "reflection; as asked"},
      {"beauty under a map",
       {.ambient = true, .beauty = true, .map = true},
       "ambient layer times direct / unoccluded direct, channel by channel;"},
      {"add",
       {.output = composite(Compose::add), .beauty = true},
       "composite add: beauty + albedo (direct + bounce); as asked"},
      {"dark", {.brightest_albedo = 0.005f}, "no bounce: the albedo is 0.005 at most"},
      {"constant light", {}, "direct is ao times the environment's one colour"},
      {"endless", {}, "radius inf: occluders at any distance"},
      {"chosen radius", {of_method("ssao")}, "radius 1.2: 0.3 of the frame's height"},
      {"given radius", {radius}, "radius 3: as given"},
      {"given thickness", {thickness}, "thickness 2: as given"},
      {"thickness of rays",
       {of_method("trace")},
       "thickness: solids are 0.85 times as thick as they appear wide"},
      {"halves", {one_slice, to({"out.exr"}, {"error"})}, "2 slices: the noise is"},
      {"open", {open}, "surfaces end at the border of the frame: as asked"},
      {"roughness",
       {roughness, to({"out.exr"}, {"reflection"})},
       "reflection: roughness 0.25 everywhere"},
  };
  for (const ReasonCase& c : cases)
    EXPECT_THAT(plan_of(c.asked).reasons, Contains(HasSubstr(c.reason))) << c.what;
  for (const std::string& reason : plan_of({of_method("ssao")}).reasons)
    EXPECT_THAT(reason, Not(HasSubstr("thickness")));
}

}  // namespace
}  // namespace ssdo::test::plan_test
