// SPDX-License-Identifier: Apache-2.0
//
// Every setting of a ladder is one that the main job takes, and each ladder has the method's own
// default.
#include "bench/ladder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "bench/command.h"
#include "estimators/registry.h"

namespace ssdo::test::ladder_test {
namespace {

int samples_of(const Setting& setting) {
  const ModelOptions model = setting.applied_to({});
  Request request;
  request.parameters = resolve_parameters(*setting.method, model.set);
  request.slices = model.slices.value_or(0);
  request.steps = model.steps.value_or(0);
  return setting.method->samples_per_pixel(request);
}

TEST(Ladder, OfEveryMethodHasItsDefaultAndALimitBeyondAll) {
  for (const Method& method : methods()) {
    const Settings settings = settings_of(method, 128);
    int defaults = 0, most = 0;
    std::set<std::string> names;
    for (const Setting& setting : settings.ladder) {
      EXPECT_EQ(setting.method, &method);
      EXPECT_TRUE(names.insert(setting.name()).second) << setting.name() << " twice";
      EXPECT_NO_THROW(samples_of(setting)) << setting.name();
      defaults += setting.standard;
      most = std::max(most, samples_of(setting));
    }
    EXPECT_EQ(defaults, 1) << method.name;
    EXPECT_GE(samples_of(settings.limit) * settings.seeds, most) << method.name;
    EXPECT_TRUE(settings.seeds == 1 || settings.seeds % 2 == 0) << method.name;
    const ModelOptions plain, standard = standard_setting(method).applied_to(plain);
    if (method.supports.march) {
      EXPECT_EQ(standard.slices, slices_of(plain.quality));
      EXPECT_EQ(standard.steps, steps_of(plain.quality, false));
    } else {
      EXPECT_EQ(resolve_parameters(method, standard.set), resolve_parameters(method, {}));
    }
  }
}

TEST(Ladder, LabelsSayWhatASettingIs) {
  const auto labels_of = [](const char* method) {
    std::vector<std::string> labels;
    for (const Setting& setting : settings_of(find_method(method), 256).ladder)
      labels.push_back(setting.rung.label);
    labels.push_back(settings_of(find_method(method), 256).limit.rung.label);
    return labels;
  };
  EXPECT_THAT(labels_of("bitmask"),
              testing::IsSupersetOf({"1 x 6", "2 x 16 (standard)", "6 x 48 (final)", "32 x 96"}));
  EXPECT_THAT(labels_of("trace"), testing::ElementsAre("4 rays", "16 rays", "64 rays", "256 rays"));
  EXPECT_THAT(labels_of("sao"), testing::Contains("11 samples, 7 turns"));
}

TEST(Ladder, ASettingTakesThePlaceOfMethodAndQualityAlone) {
  ModelOptions model;
  model.method = "trace";
  model.radius = INFINITY;
  model.thickness = 0.5;
  model.bounces = 3;
  model.set = {"thickness=0.5"};
  const ModelOptions gtao = standard_setting(find_method("gtao")).applied_to(model);
  EXPECT_EQ(gtao.method, "gtao");
  EXPECT_EQ(gtao.bounces, 3);
  EXPECT_THAT(gtao.set, testing::ElementsAre("thickness=0.5", "slices=2", "steps=2"));
  EXPECT_EQ(gtao.thickness, std::nullopt) << "it takes none";
  EXPECT_EQ(gtao.radius, std::nullopt) << "it needs a limit";
  const ModelOptions bitmask = standard_setting(find_method("bitmask")).applied_to(model);
  EXPECT_EQ(bitmask.thickness, 0.5);
  EXPECT_EQ(bitmask.radius, INFINITY);
  EXPECT_EQ(bitmask.slices, 2);
  model.radius = 2;
  EXPECT_EQ(standard_setting(find_method("gtao")).applied_to(model).radius, 2);
}

TEST(Ladder, ReferencesOfLargeFramesHaveFewerRays) {
  EXPECT_EQ(reference_rays(1000), 512);
  EXPECT_EQ(reference_rays(200'000), 128);
  EXPECT_EQ(reference_rays(8'000'000), 64);
}

TEST(Command, IsQuotedForAShell) {
  EXPECT_EQ(shell_word("data/a-b_1.exr:ViewLayer.P"), "data/a-b_1.exr:ViewLayer.P");
  EXPECT_EQ(shell_word("two words"), "'two words'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word("$x"), "'$x'");
  EXPECT_EQ(shell_word(""), "''");
  EXPECT_EQ(shell_word("a\033[2J'\\"), "$'a\\x1b[2J\\'\\\\'");
}

TEST(Command, HasWhatReachesTheSetting) {
  const FrameOptions frame;
  BenchOptions options;
  options.carried = {{"--env", "sky.exr"}, {"--thickness", "2"}, {"--radius", "inf"}};
  const BenchJob job{"shots/a b.exr", frame, options};
  Plan plan;
  plan.make = {"ao", "direct"};
  EXPECT_EQ(command_of(job, standard_setting(find_method("ssao")), plan),
            "ssdo 'shots/a b.exr' --env sky.exr --method ssao --set samples=64 "
            "--products ao,direct -o 'a b_relit.exr'");
  EXPECT_EQ(command_of(job, standard_setting(find_method("bitmask")), plan),
            "ssdo 'shots/a b.exr' --env sky.exr --thickness 2 --radius inf --method bitmask "
            "--prior rules "
            "--slices 2 --steps 16 --products ao,direct -o 'a b_relit.exr'");
}

}  // namespace
}  // namespace ssdo::test::ladder_test
