// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/advice.h"

#include <gmock/gmock.h>

#include "support/layer_file.h"

namespace ssdo::test::advice_test {
namespace {

using testing::HasSubstr;

Channels vectors(const std::vector<std::string>& layers) {
  Channels channels;
  for (const std::string& layer : layers)
    for (const char* component : {".R", ".G", ".B"}) channels.push_back(layer + component);
  return channels;
}

std::vector<LayerGroup> groups_of(const std::vector<std::string>& layers) {
  const LayerFile file(vectors(layers));
  return group_channels(ExrReader(file.path()), 0);
}

TEST(Advice, NamesTheOneLayerThatIsLikeTheRole) {
  EXPECT_EQ(hint_at(Role::position, groups_of({"MyWorldPosition", "Fog", "ObjectPosition"})),
            "if 'MyWorldPosition' is the position, say --aov \"position=MyWorldPosition\"");
  EXPECT_EQ(hint_at(Role::normal, groups_of({"Shading normal", "N_noice"})),
            "if 'Shading normal' is the normal, say --aov \"normal=Shading normal\"");
  EXPECT_EQ(hint_at(Role::albedo, groups_of({"FinalBaseColor", "specular_albedo"})),
            "if 'FinalBaseColor' is the albedo, say --aov \"albedo=FinalBaseColor\"");
}

TEST(Advice, KnowsShortWords) {
  EXPECT_THAT(hint_at(Role::position, groups_of({"myPosPass", "exposure"})),
              HasSubstr("myPosPass"));
  EXPECT_THAT(hint_at(Role::normal, groups_of({"geo_nrm", "spec"})), HasSubstr("geo_nrm"));
  EXPECT_THAT(hint_at(Role::albedo, groups_of({"char_alb", "spec"})), HasSubstr("char_alb"));
}

TEST(Advice, DoesNotChooseAmongSeveralNorFromOtherSpaces) {
  EXPECT_EQ(hint_at(Role::position, groups_of({"PositionA", "PositionB"})), "");
  EXPECT_EQ(hint_at(Role::position, groups_of({"ObjectPosition", "RestPosition"})), "");
  EXPECT_EQ(hint_at(Role::albedo, groups_of({"specular_albedo", "albedo_mse"})), "");
}

TEST(Advice, ListsWhatAPositionCouldBeIn) {
  EXPECT_THAT(advice_on_position(groups_of({"PositionA", "PositionB", "albedo"})),
              HasSubstr("channels for a position are in 'PositionA', 'PositionB'"));
  std::vector<std::string> many;
  for (int i = 0; i < 9; ++i) many.push_back("light" + std::to_string(i));
  EXPECT_THAT(advice_on_position(groups_of(many)), HasSubstr("'light7' and others"));
  EXPECT_THAT(advice_on_position(groups_of({"albedo"})), testing::EndsWith("depth=LAYER"));
}

}  // namespace
}  // namespace ssdo::test::advice_test
