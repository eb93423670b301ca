// SPDX-License-Identifier: Apache-2.0
//
// Which channels of a file light the scene, and where they lie on the sphere. Issue 12, number 6:
// the first three channels of the first part did, whatever they are called, over the data window.
#include "scene/light/environment_map.h"

#include <ImfChromaticitiesAttribute.h>
#include <ImfEnvmapAttribute.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "io/images/image_file.h"
#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::environment_map_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const Window kWindow{0, 0, 8, 4};

class EnvironmentMapFile : public testing::Test {
 protected:
  std::string path(const std::string& name = "map.exr") const { return dir_ / name; }

  /// A part whose channels have the values beside their names everywhere.
  static FramePart part(const std::map<std::string, float>& channels, const std::string& name = "",
                        const Window& data = kWindow) {
    FramePart made{name, data, kWindow, {}, Imf::FLOAT, {}};
    for (const auto& [channel, value] : channels)
      made.channels[channel] = Plane<float>(data.width(), data.height(), value);
    return made;
  }

  /// The first texel of a file of these parts, where `layer` is named or none.
  glm::vec3 light_of(const std::vector<FramePart>& parts, const std::string& layer = "") const {
    write_frame(path(), parts);
    return read_environment_map(layer.empty() ? path() : path() + ":" + layer).texels[0];
  }

  Error refusal(const std::vector<FramePart>& parts, const std::string& layer = "") const {
    return error_of([&] { light_of(parts, layer); });
  }

  TempDir dir_;
};

const std::map<std::string, float> kRgb = {{"R", 1}, {"G", 2}, {"B", 3}};
const std::map<std::string, float> kAo = {{"AO.R", 7}, {"AO.G", 7}, {"AO.B", 7}};

std::map<std::string, float> operator+(std::map<std::string, float> a,
                                       const std::map<std::string, float>& b) {
  a.insert(b.begin(), b.end());
  return a;
}

TEST_F(EnvironmentMapFile, ColoursAreChosenByTheirName) {
  const glm::vec3 rgb(1, 2, 3);
  EXPECT_EQ(light_of({part(kRgb)}), rgb);
  EXPECT_EQ(light_of({part(kRgb + kAo + std::map<std::string, float>{{"A", 9}, {"Depth.Z", 8}})}),
            rgb);
  EXPECT_EQ(light_of({part({{"A.Z", 9},
                            {"AO.R", 7},
                            {"AO.G", 7},
                            {"AO.B", 7},
                            {"ViewLayer.Combined.R", 1},
                            {"ViewLayer.Combined.G", 2},
                            {"ViewLayer.Combined.B", 3}})}),
            rgb);
  EXPECT_EQ(light_of({part({{"Depth.Z", 9}, {"sky.red", 1}, {"sky.green", 2}, {"sky.blue", 3}})}),
            rgb)
      << "the only colours";
}

TEST_F(EnvironmentMapFile, ColoursMayStandInAnyPart) {
  const glm::vec3 rgb(1, 2, 3);
  const std::map<std::string, float> grey = {{"R", 7}, {"G", 7}, {"B", 7}};
  EXPECT_EQ(light_of({part({{"Z", 9}}, "depth"), part(kRgb, "light")}), rgb);
  EXPECT_EQ(light_of({part(grey, "AO"), part(kRgb, "rgba")}), rgb);
  EXPECT_EQ(light_of({part(grey, "AO"), part(kRgb, "light")}, "light"), rgb);
}

TEST_F(EnvironmentMapFile, GreyLightsInGrey) {
  EXPECT_EQ(light_of({part({{"Y", 4}})}), glm::vec3(4));
  EXPECT_EQ(light_of({part({{"Y", 4}, {"A", 1}, {"Depth.Z", 9}})}), glm::vec3(4));
  EXPECT_EQ(light_of({part(std::map<std::string, float>{{"Y", 4}} + kAo)}), glm::vec3(4));
}

TEST_F(EnvironmentMapFile, ALayerCanBeNamed) {
  const auto file = part(kRgb + kAo + std::map<std::string, float>{{"Depth.Z", 9}});
  EXPECT_EQ(light_of({file}, "AO"), glm::vec3(7));
  EXPECT_EQ(light_of({file}, "Depth.Z"), glm::vec3(9)) << "as asked";
  EXPECT_EQ(light_of({file}, "G"), glm::vec3(2));
  EXPECT_THAT(refusal({file}, "sky"), IsError(ExitCode::layer, "has no layer 'sky'; there is"));
  EXPECT_THAT(refusal({part({{"uv.X", 1}, {"uv.Y", 2}})}, "uv"),
              IsError(ExitCode::layer, "layer 'uv' has the channels uv.X, uv.Y"));
}

TEST_F(EnvironmentMapFile, WhatIsAmbiguousOrMissingIsRefused) {
  EXPECT_THAT(
      refusal({part(kAo + std::map<std::string, float>{{"sky.R", 1}, {"sky.G", 1}, {"sky.B", 1}})}),
      IsError(ExitCode::layer, "2 layers could be the environment: 'AO', 'sky'"));
  EXPECT_THAT(refusal({part({{"P.X", 1}, {"P.Y", 1}, {"P.Z", 1}, {"Z", 9}})}),
              IsError(ExitCode::layer, "has no layer with R, G and B"));
  EXPECT_THAT(refusal({part({{"BY", 0}, {"RY", 0}, {"Y", 1}})}),
              IsError(ExitCode::layer, "stores luminance and chroma"));
  Imf::Header deep = test_header(Imath::Box2i({0, 0}, {7, 7}), {{"A"}, {"Z"}});
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.setType(Imf::DEEPSCANLINE);
  write_test_exr(path("deep.exr"), {deep});
  EXPECT_THAT(error_of([&] { read_environment_map(path("deep.exr")); }),
              IsError(ExitCode::input, "deep.exr: holds no flat image"));
}

TEST_F(EnvironmentMapFile, TheSphereIsTheDisplayWindow) {
  write_frame(path("small.exr"), part(kRgb, "", {2, 1, 5, 3}));
  const EnvironmentMap small = read_environment_map(path("small.exr"));
  ASSERT_EQ(small.texels.width, 8);
  ASSERT_EQ(small.texels.height, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 8; ++x) {
      const bool inside = x >= 2 && x < 5 && y >= 1 && y < 3;
      EXPECT_EQ(small.texels(x, y), inside ? glm::vec3(1, 2, 3) : glm::vec3(0)) << x << " " << y;
    }
  }
  FramePart large = part(kRgb, "", {-2, -1, 10, 6});
  for (int y = -1; y < 6; ++y) {
    for (int x = -2; x < 10; ++x) large.channels["R"](x + 2, y + 1) = float(100 + 10 * y + x);
  }
  write_frame(path("large.exr"), large);
  const EnvironmentMap cropped = read_environment_map(path("large.exr"));
  ASSERT_EQ(cropped.texels.width, 8);
  EXPECT_EQ(cropped.texels(0, 0).x, 100);
  EXPECT_EQ(cropped.texels(7, 3).x, 137);
}

/// Issue 12, number 11: such texels were dropped in silence, or ended the process.
TEST_F(EnvironmentMapFile, TexelsThatAreNoLightAreCounted) {
  FramePart file = part(kRgb);
  file.channels["R"][3] = std::numeric_limits<float>::quiet_NaN();
  file.channels["G"][4] = std::numeric_limits<float>::infinity();
  file.channels["B"][5] = 1.2e38f;
  file.channels["R"][6] = -0.5f;
  write_frame(path(), file);
  const EnvironmentMap map = read_environment_map(path());
  for (const std::size_t i : {3u, 4u, 5u}) EXPECT_EQ(map.texels[i], glm::vec3(0));
  EXPECT_EQ(map.texels[6], glm::vec3(0, 2, 3));
  EXPECT_EQ(map.texels[7], glm::vec3(1, 2, 3));
  EXPECT_THAT(map.warnings, ElementsAre(HasSubstr("map.exr: 3 of 32 texels are not finite"),
                                        HasSubstr("map.exr: 1 of 32 texels have negative")));
  write_frame(path(), part(kRgb));
  EXPECT_THAT(read_environment_map(path()).warnings, IsEmpty());
}

TEST_F(EnvironmentMapFile, OtherKindsHaveOneLayer) {
  SafeFile png(path("map.png"), {});
  write_image(png, {2, 1, 4, 8, 1}, std::vector<float>{0.2f, 0.4f, 0.6f, 0.5f, 1, 1, 1, 1});
  png.commit();
  const EnvironmentMap map = read_environment_map(path("map.png"));
  EXPECT_NEAR(map.texels[0].y, 0.1329, 1e-4) << "decoded from sRGB, whatever its alpha";
  EXPECT_THAT(map.warnings, ElementsAre(HasSubstr("map.png: stores integers, encoded as ")));
  EXPECT_EQ(read_environment_map(path("map.png") + ":A").texels[0], glm::vec3(128 / 255.0f));
}

TEST_F(EnvironmentMapFile, EncodedColoursAreDecoded) {
  FramePart file = part({{"R", 0.5f}, {"G", 0.25f}, {"B", 2}});
  file.extra.insert("oiio:ColorSpace", Imf::StringAttribute("sRGB"));
  write_frame(path(), file);
  const EnvironmentMap map = read_environment_map(path());
  EXPECT_NEAR(map.texels[0].x, 0.21404, 1e-5);
  EXPECT_GT(map.texels[0].z, 4) << "brighter than white";
  EXPECT_THAT(map.converted, ElementsAre("decoded from sRGB"));
  EXPECT_THAT(map.warnings, IsEmpty());
  file.extra.insert("colorInteropID", Imf::StringAttribute("ACEScct"));
  write_frame(path(), file);
  const EnvironmentMap unknown = read_environment_map(path());
  EXPECT_EQ(unknown.texels[0].x, 0.5f);
  EXPECT_THAT(unknown.warnings, ElementsAre(HasSubstr("colours are ACEScct, whose curve is not")));
}

/// Its directions were those of a lat-long map.
TEST_F(EnvironmentMapFile, ACubeMapIsConverted) {
  const Window cube{0, 0, 4, 24};
  FramePart file = part(kRgb, "", cube);
  file.display = cube;
  for (int y = 4; y < 24; ++y) {
    for (int x = 0; x < 4; ++x)
      for (auto& [name, plane] : file.channels) plane(x, y) = 0;
  }
  file.extra.insert("envmap", Imf::EnvmapAttribute(Imf::ENVMAP_CUBE));
  write_frame(path(), file);
  const EnvironmentMap map = read_environment_map(path());
  const int columns = map.texels.width, rows = map.texels.height;
  EXPECT_EQ(columns, 2 * rows);
  const auto at = [&](float longitude) {  // atan2(x, z), on the horizon
    return map.texels(int((0.5f - longitude / 360) * float(columns)), rows / 2);
  };
  EXPECT_LT(glm::distance(at(90), glm::vec3(1, 2, 3)), 1e-4f) << "+X";
  for (const float dark : {-90.0f, 0.0f, 179.0f, 40.0f, 140.0f}) EXPECT_EQ(at(dark).x, 0) << dark;
  EXPECT_THAT(map.converted, ElementsAre("from a cube map of 4 x 24"));
  file.data = file.display = {0, 0, 4, 20};
  for (auto& [name, plane] : file.channels) plane = Plane<float>(4, 20, 1);
  write_frame(path(), file);
  EXPECT_THAT(error_of([&] { read_environment_map(path()); }),
              IsError(ExitCode::input, "map.exr: its header says envmap = cube"));
}

/// Crosses, strips and probes were lit as lat-long maps without a word.
TEST_F(EnvironmentMapFile, ShapesOfOtherMapsAreNamed) {
  const auto read = [&](int width, int height, bool grey = false) {
    const Window window{0, 0, width, height};
    FramePart file = part(kRgb, "", window);
    file.display = window;
    if (!grey) file.channels["R"][0] = 9;
    write_frame(path(), file);
    return read_environment_map(path()).warnings;
  };
  EXPECT_THAT(error_of([&] { read(16, 96); }), IsError(ExitCode::input, "in a column"));
  EXPECT_THAT(error_of([&] { read(96, 16); }), IsError(ExitCode::input, "in a row"));
  EXPECT_THAT(error_of([&] { read(48, 64); }), IsError(ExitCode::input, "in a cross"));
  EXPECT_THAT(error_of([&] { read(64, 48); }), IsError(ExitCode::input, "in a cross"));
  EXPECT_THAT(read(64, 64), ElementsAre(HasSubstr("is it a light probe")));
  EXPECT_THAT(read(64, 16), ElementsAre(HasSubstr("if it shows a part of them")));
  for (const auto& [width, height] : {std::pair(64, 32), {1, 1}, {5, 3}, {2, 2}, {100, 53}})
    EXPECT_THAT(read(width, height), IsEmpty()) << width << " x " << height;
  EXPECT_THAT(read(64, 64, true), IsEmpty()) << "one colour from everywhere";
}

TEST_F(EnvironmentMapFile, TellsItsPrimaries) {
  FramePart file = part(kRgb);
  write_frame(path(), file);
  EXPECT_FALSE(read_environment_map(path()).primaries);
  file.extra.insert("chromaticities", Imf::ChromaticitiesAttribute(
                                          Imf::Chromaticities({0.68f, 0.32f}, {0.265f, 0.69f})));
  write_frame(path(), file);
  EXPECT_EQ(read_environment_map(path()).primaries.value()[0], 0.68f);
}

}  // namespace
}  // namespace ssdo::test::environment_map_test
