// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/picture_layers.h"

#include <gmock/gmock.h>

#include <fstream>

#include "support/error_matchers.h"
#include "support/layer_file.h"
#include "support/run_tool.h"

namespace ssdo::test::picture_layers_test {
namespace {

using testing::ElementsAre;

std::vector<std::string> channels_of(const LayerFile& file, const std::string& name) {
  return LayeredPicture(file.path().string()).find(name).channels;
}

Error refusal(const LayerFile& file, const std::string& name) {
  return error_of([&] { channels_of(file, name); });
}

TEST(PictureName, SplitsAtTheLastColonUnlessItIsAFile) {
  const TempDir dir;
  const std::string file = (dir / "a:b.exr").string();
  std::ofstream(file) << "x";
  EXPECT_EQ(parse_picture_name(file).file, file);
  EXPECT_EQ(parse_picture_name(file).layer, "");
  EXPECT_EQ(parse_picture_name(file + ":AO").file, file);
  EXPECT_EQ(parse_picture_name(file + ":AO").layer, "AO");
  EXPECT_EQ(parse_picture_name("gone.exr").layer, "");
  EXPECT_EQ(parse_picture_name(std::string(5000, 'x') + ":AO").layer, "AO");  // no file's name
}

TEST(LayeredPicture, GroupsChannelsInTheOrderOfColoursAndCoordinates) {
  const LayerFile file({"A", "B", "G", "R", "View.N.X", "View.N.Y", "View.N.Z", "View.Mist.Y"});
  const LayeredPicture picture(file.path().string());
  ASSERT_EQ(picture.layers().size(), 3u);
  EXPECT_EQ(picture.names(), "R,G,B,A, View.Mist, View.N");
  EXPECT_THAT(picture.layers()[0].components, ElementsAre("R", "G", "B", "A"));
  EXPECT_THAT(channels_of(file, "N"), ElementsAre("View.N.X", "View.N.Y", "View.N.Z"));
  EXPECT_EQ(picture.window(picture.layers()[0]), (Window{0, 0, 2, 2}));
}

TEST(LayeredPicture, FindsLayersAndChannelsByFullNameBeforeLastWords) {
  const LayerFile file({"AO.Y", "View.AO.Y", "View.N.X", "View.N.Y", "Z"});
  EXPECT_THAT(channels_of(file, "AO"), ElementsAre("AO.Y"));
  EXPECT_THAT(channels_of(file, "View.AO"), ElementsAre("View.AO.Y"));
  EXPECT_THAT(channels_of(file, "View.N.Y"), ElementsAre("View.N.Y"));
  EXPECT_THAT(channels_of(file, "Z"), ElementsAre("Z"));
}

TEST(LayeredPicture, FindsLayersOfAPartByItsName) {
  const LayerFile file(std::vector<LayerPart>{{"left", {"AO.Y"}}, {"right", {"AO.Y", "N.X"}}});
  EXPECT_EQ(LayeredPicture(file.path().string()).find("right.AO").part, 1);
  EXPECT_THAT(refusal(file, "AO"), IsError(ExitCode::layer, "2 layers are called 'AO'"));
}

TEST(LayeredPicture, SaysWhichLayersThereAre) {
  const LayerFile file(Channels{"View.AO.Y", "View.N.X"});
  EXPECT_THAT(refusal(file, "depth"),
              IsError(ExitCode::layer, "no layer 'depth'; there is View.AO, View.N"));
}

TEST(LayeredPicture, OfOtherFormatsIsOneLayerOfColours) {
  const LayeredPicture picture(data("pictures/still_life.jpg"));
  EXPECT_TRUE(picture.integers());
  ASSERT_EQ(picture.layers().size(), 1u);
  const auto planes = picture.read(picture.layers()[0]);
  ASSERT_EQ(planes.size(), 3u);
  EXPECT_EQ(planes[0].size(), picture.window(picture.layers()[0]).area());
}

}  // namespace
}  // namespace ssdo::test::picture_layers_test
