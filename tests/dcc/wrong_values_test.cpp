// SPDX-License-Identifier: Apache-2.0
//
// Layers that cannot be right: they are decoded, left out or counted, and named.
#include <gmock/gmock.h>

#include <cmath>

#include "dcc/data_checks.h"

namespace ssdo::test::wrong_values_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(DataChecks, NormalsWithAGammaAreDecoded) {
  const auto curved = [](const Content& normal, float exponent) -> Content {
    return [=](const ShotPixel& p) {
      glm::vec4 n = normal(p);
      for (int c = 0; c < 3; ++c) n[c] = std::copysign(std::pow(std::abs(n[c]), exponent), n[c]);
      return n;
    };
  };
  const std::vector<std::pair<Content, std::string>> encoded = {
      {curved(world_normal(), 1 / 2.2f), "decoded with n^2.2"},
      {curved(camera_normal(), 2.2f), "decoded with n^(1/2.2)"},
      {curved(as_color(world_normal()), 1 / 2.2f), "decoded with n^2.2"}};
  for (const auto& [normal, text] : encoded) {
    EXPECT_LT(off(with(Role::normal, normal)), 2e-3);
    EXPECT_THAT(said_,
                HasSubstr("normals are encoded with a gamma, as their lengths tell; " + text));
  }
}

TEST_F(DataChecks, LayersThatWereNeverWrittenAreLeftOut) {
  const Content nothing = [](const ShotPixel&) { return glm::vec4(0); };
  EXPECT_LT(off(with(Role::normal, nothing)), 0.05);
  EXPECT_THAT(said_, AllOf(HasSubstr("normal 'N' is 0 everywhere, and is left out"),
                           Not(HasSubstr("0..1"))));
  StoredShot shot = plain_shot();
  shot.layers.push_back({Role::beauty, {"R", "G", "B", "A"}, nothing});
  EXPECT_EQ(off(shot), 0);
  EXPECT_THAT(said_, HasSubstr("alpha 'A' is 0 everywhere, also where other layers show surfaces"));
  EXPECT_EQ(info(shot)["surface_pixels"], info(plain_shot())["surface_pixels"]);
  // Neither hides the other.
  StoredShot both = with(Role::normal, nothing);
  both.layers.push_back({Role::beauty, {"R", "G", "B", "A"}, nothing});
  EXPECT_EQ(info(both)["surface_pixels"], info(plain_shot())["surface_pixels"]);
}

/// The frame is read again without the depth, and without the normals that the first reading left
/// out.
TEST_F(DataChecks, NormalsWithoutANumberBesideAWrongDepthAreRebuilt) {
  StoredShot shot = with(Role::normal, [](const ShotPixel&) { return glm::vec4(NAN); });
  for (auto& layer : shot.layers)
    if (layer.role == Role::depth)
      layer.content = [](const ShotPixel& p) { return glm::vec4(std::abs(p.position.y)); };
  EXPECT_LT(off(shot), 0.05);
  EXPECT_THAT(said_, HasSubstr("depth contradicts P"));
}

TEST_F(DataChecks, ColoursThatCannotBeRightAreCounted) {
  const auto warnings = [&](const Content& albedo) {
    return warnings_of(info(with(Role::albedo, albedo)));
  };
  EXPECT_THAT(warnings(grey()), IsEmpty());
  EXPECT_THAT(warnings([](const ShotPixel& p) { return glm::vec4(p.position.x > 0 ? NAN : 0.5f); }),
              ElementsAre(ContainsRegex("albedo is not finite in [0-9]+ pixels \\([0-9]+ % of the "
                                        "surfaces\\): black there")));
  EXPECT_THAT(
      warnings([](const ShotPixel&) { return glm::vec4(5); }),
      ElementsAre(ContainsRegex("albedo is above 1 in [0-9]+ pixels \\(100 % .*5 at most")));
}

TEST_F(DataChecks, AnAmbientLayerIsAPartOfTheBeauty) {
  for (const float ambient : {0.4f, 4.0f}) {
    StoredShot shot = plain_shot();
    shot.layers.push_back({Role::beauty, {"R", "G", "B", "A"}, grey()});
    shot.layers.push_back({Role::ambient, channels("Sky", "RGB"),
                           [=](const ShotPixel& p) { return glm::vec4(p.surface ? ambient : 0); }});
    result(shot, "ao.Y", {"--products", "ao,composite", "--aov", "ambient=Sky"});
    const bool is_part = ambient < 0.45f;
    EXPECT_THAT(said_, is_part ? testing::Matcher<std::string>("")
                               : HasSubstr("ambient is brighter than the beauty in"));
  }
}

TEST_F(DataChecks, ALensThatTheNormalsContradictIsWarnedOf) {
  for (const Content& normal : {world_normal(kTurn), camera_normal()}) {
    StoredShot shot = with(Role::normal, normal);
    drop(shot, Role::position);
    for (const std::string fov : {"20", "90"})
      EXPECT_THAT(warnings_of(info(shot, {"--fov", fov})),
                  Contains(ContainsRegex("the normals disagree with the depth under the camera "
                                         "\\(--fov .* under --fov (39.[5-9]|40.[0-5])")));
    EXPECT_THAT(warnings_of(info(shot, {"--fov", "40"})), IsEmpty());
  }
}

TEST_F(DataChecks, ADepthThatIsAnotherFunctionOfPIsLeftOut) {
  const auto of_world = [](float (*depth)(const glm::vec3&)) {
    return [=](const ShotPixel& p) {
      return glm::vec4(p.surface ? depth(p.position) : 1e10f, 0, 0, 0);
    };
  };
  const std::vector<std::pair<Content, std::string>> wrong = {
      {of_world([](const glm::vec3& p) { return p.y; }), "it is the y of P"},
      {of_world([](const glm::vec3& p) { return glm::length(p); }),
       "it is the distance from the origin of P"},
      {[](const ShotPixel& p) { return planar_depth(1e10f)(p) - glm::vec4(p.surface ? 4 : 0); },
       "it is the distance from the camera - 4"}};
  const json expected = info(plain_shot())["surface_pixels"];
  for (const auto& [depth, text] : wrong) {
    const StoredShot shot = with(Role::depth, depth);
    const json found = info(shot);
    EXPECT_EQ(found["depth"]["used"], false);
    EXPECT_EQ(found["surface_pixels"], expected);
    EXPECT_THAT(warnings_of(found),
                ElementsAre("depth contradicts P (" + text + ") and is left out"));
    EXPECT_LT(off(shot), 1e-6);
  }
}

TEST_F(DataChecks, APThatNoCameraHasSeenIsRefused) {
  const auto root = [](const ShotPixel& p) {
    const glm::vec3 v = p.position;
    return glm::vec4(glm::sign(v) * glm::sqrt(glm::abs(v)), 0);
  };
  const std::vector<std::pair<Content, std::string>> wrong = {
      {[](const ShotPixel& p) { return glm::max(world_position()(p), glm::vec4(0)); },
       "looks clipped at 0"},
      {root, "looks gamma-encoded: P^2 fits a camera"},
      {world_normal(), "has length 1 everywhere: looks like normals"}};
  for (const auto& [position, text] : wrong) {
    write_shot(input_, with(Role::position, position));
    for (const std::vector<std::string>& flags : {std::vector<std::string>{}, {"--fov", "40"}}) {
      std::vector<std::string> words = {input_, "-o", dir_ / "none.exr"};
      words.insert(words.end(), flags.begin(), flags.end());
      const Finished done = run_tool(words);
      EXPECT_EQ(done.code, 4) << text;
      EXPECT_THAT(done.error_line(), HasSubstr(input_ + ": position 'P' " + text));
    }
  }
}

}  // namespace
}  // namespace ssdo::test::wrong_values_test
