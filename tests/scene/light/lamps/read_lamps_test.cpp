// SPDX-License-Identifier: Apache-2.0
//
// What users say of lamps, in files and on the command line.
#include "scene/light/lamps/read_lamps.h"

#include <gmock/gmock.h>

#include <fstream>
#include <glm/geometric.hpp>

#include "scene/light/lamps/blackbody.h"
#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::read_lamps_test {
namespace {

using testing::HasSubstr;

class LampFile : public testing::Test {
 protected:
  std::vector<Lamp> read(const std::string& text) const {
    std::ofstream(dir_ / "lamps.json") << text;
    return read_lamps(dir_ / "lamps.json");
  }
  /// A file of one lamp.
  Lamp lamp(const std::string& keys) const { return read(R"({"lights": [{)" + keys + "}]}").at(0); }
  TempDir dir_;
};

TEST_F(LampFile, GivesWhatItSays) {
  const std::vector<Lamp> lamps = read(R"({"lights": [
    {"name": "key_1", "type": "sphere", "position": [1, 2, 3], "radius": 0.1, "intensity": 50,
     "exposure": 1, "color": [1, 0.9, 0.8], "soft_falloff": true},
    {"type": "rect", "matrix": [[1, 0, 0, 4], [0, 0, -1, 5], [0, 1, 0, 6], [0, 0, 0, 1]],
     "width": 2, "height": 3, "normalize": true, "cone_angle": 40, "cone_softness": 0.25,
     "cone_by_cosine": true},
    {"type": "disk", "radius": 7, "position": [0, 0, 1], "direction": [0, 0, -5], "up": [0, 2, 1]},
    {"type": "distant", "angle": 2}]})");
  ASSERT_EQ(lamps.size(), 4u);
  EXPECT_EQ(lamps[0].name, "key_1");
  EXPECT_EQ(lamps[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(lamps[0].radius, 0.1);
  EXPECT_LT(glm::distance(lamps[0].value(), glm::dvec3(100, 90, 80)), 1e-9);
  EXPECT_FALSE(lamps[0].has_cone);
  EXPECT_TRUE(lamps[0].soft_falloff);
  EXPECT_EQ(lamps[1].type, LampType::rect);
  EXPECT_EQ(lamps[1].position, glm::dvec3(4, 5, 6));
  EXPECT_EQ(-lamps[1].axes[2], glm::dvec3(0, 1, 0));  // emits along y
  EXPECT_EQ(lamps[1].area(), 6);
  EXPECT_TRUE(lamps[1].normalize && lamps[1].has_cone && lamps[1].cone_by_cosine);
  EXPECT_EQ(lamps[2].axes[2], glm::dvec3(0, 0, 1));
  EXPECT_LT(glm::distance(lamps[2].axes[1], glm::dvec3(0, 1, 0)), 1e-12);
  EXPECT_EQ(lamps[3].intensity, 50000);  // as in UsdLux
}

TEST_F(LampFile, HasAConeWhereOneIsAskedFor) {
  EXPECT_TRUE(lamp(R"("type": "sphere", "cone_by_cosine": true)").has_cone);
  EXPECT_FALSE(lamp(R"("type": "sphere", "cone_by_cosine": false)").has_cone);
}

TEST_F(LampFile, AndTheCommandLineAreAlike) {
  const Lamp in_file = lamp(
      R"("type": "rect", "name": "a", "position": [1,-2,3], "direction": [0,0.5,-1],
         "color": [1,0.9,0.8], "normalize": true, "color_temperature": 3000)");
  const Lamp given = parse_lamp(
      "rect name=a position=1,-2,3  direction=0,.5,-1\tcolor=1,0.9,0.8 normalize=true "
      "color_temperature=3000");
  EXPECT_EQ(in_file.name, given.name);
  EXPECT_EQ(in_file.position, given.position);
  EXPECT_EQ(in_file.axes, given.axes);
  EXPECT_EQ(in_file.color, given.color);
  EXPECT_EQ(in_file.normalize, given.normalize);
  EXPECT_EQ(parse_lamp("sphere name=12").name, "12");
  const Lamp linked = parse_lamp("sphere receive=\"crypto:a ball\"+id:IndexOB=1,5-7 cast=m name=b");
  EXPECT_EQ(linked.receive.terms.at(0).name, "a ball");
  EXPECT_EQ(linked.receive.terms.at(1).ids.size(), 2u);
  EXPECT_EQ(linked.cast.terms.at(0).layer, "m");
  EXPECT_EQ(linked.name, "b");
  EXPECT_EQ(parse_lamp("rect matrix=1,0,0,4,0,1,0,5,0,0,1,6,0,0,0,1").position,
            glm::dvec3(4, 5, 6));
}

/// A lamp that is none, and what its error says; all name the file and the light.
TEST_F(LampFile, WithWhatMeansNoLampIsRefused) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {R"("radius": 1)", "has no type; it is one of sphere, disk, rect, distant"},
      {R"("type": "Sphere")", "type is \"Sphere\"; did you mean sphere?"},
      {R"("type": 3)", "type is 3; it is one of"},
      {R"("type": "sphere", "radios": 1)", "unknown key 'radios'; did you mean radius?"},
      {R"("type": "sphere", "colorTemperature": 1)",
       "unknown key 'colorTemperature'; did you mean color_temperature?"},
      {R"("type": "sphere", "width": 1)", "width: a sphere light has none"},
      {R"("type": "distant", "cone_angle": 1)", "cone_angle: a distant light has none"},
      {R"("type": "sphere", "radius": -1)", "radius is -1; it is a number from 0 to"},
      {R"("type": "sphere", "radius": "1")", "radius is \"1\"; it is a number"},
      {R"("type": "sphere", "radius": null)", "radius is null; it is a number"},
      {R"("type": "sphere", "radius": 1e300)", "radius is 1e+300; it is a number from 0 to"},
      {R"("type": "sphere", "radius": 0)", "radius is 0: it gives no light"},
      {R"("type": "disk", "radius": 0)", "radius is 0: the light has no surface"},
      {R"("type": "rect", "width": 0, "normalize": true)", "width is 0: the light has no surface"},
      {R"("type": "rect", "height": -2)", "height is -2"},
      {R"("type": "distant", "angle": 361)", "angle is 361"},
      {R"("type": "distant", "angle": 0)", "angle is 0: it gives no light"},
      {R"("type": "sphere", "position": [1, 2])", "position is [1,2]; it is three numbers"},
      {R"("type": "sphere", "position": [1, 2, "x"])", "position is [1,2,\"x\"]"},
      {R"("type": "sphere", "position": [1, 2, 1e30])", "position is [1,2,1e+30]"},
      {R"("type": "disk", "direction": [0, 0, 0])", "direction is 0,0,0: it points nowhere"},
      {R"("type": "disk", "direction": [0, 1, 0], "up": [0, -3, 0])",
       "up is parallel to direction"},
      {R"("type": "sphere", "color": [1, -1, 1])", "color is [1,-1,1]"},
      {R"("type": "sphere", "color": 1)", "color is 1; it is three numbers"},
      {R"("type": "sphere", "intensity": -1)", "intensity is -1"},
      {R"("type": "sphere", "intensity": 1e15, "color": [2, 2, 2])",
       "intensity: makes its light 2e+15, and 1e+15 is the most"},
      {R"("type": "sphere", "exposure": 60)", "exposure: makes its light"},
      {R"("type": "sphere", "exposure": 1000)", "exposure is 1000"},
      {R"("type": "sphere", "color_temperature": 100)", "color_temperature is 100"},
      {R"("type": "sphere", "normalize": 1)", "normalize is 1; it is true or false"},
      {R"("type": "sphere", "cone_angle": 0)", "cone_angle is 0: it gives no light"},
      {R"("type": "sphere", "cone_angle": -10)", "cone_angle is -10"},
      {R"("type": "sphere", "cone_softness": 1.5)", "cone_softness is 1.5"},
      {R"("type": "sphere", "name": "")", "name is \"\"; names of lights are"},
      {R"("type": "sphere", "name": "a.b")", "name is \"a.b\""},
      {R"("type": "sphere", "name": "\u00e4")", "name is "},
      {R"("type": "sphere", "name": 3)", "name is 3"},
      {R"("type": "sphere", "name": "env")",
       "light env: name: 'env' is that of the environment map"},
      {R"("type": "rect", "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]])", "matrix is [["},
      {R"("type": "rect", "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]])",
       "matrix: its last row is 1 2 3 1, not 0 0 0 1; one for row vectors"},
      {R"("type": "rect", "matrix": [[2,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])",
       "matrix scales or shears"},
      {R"("type": "rect", "matrix": [[-1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]])", "matrix mirrors"},
      {R"("type": "rect", "matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]], "up": [0,1,0])",
       "up and matrix both place it"},
  };
  for (const auto& [keys, says] : cases) {
    const Error error = error_of([&, keys = keys] { lamp(keys); });
    EXPECT_THAT(error, IsError(ExitCode::input, says)) << keys;
    EXPECT_THAT(std::string(error.what()), HasSubstr("lamps.json: light ")) << keys;
  }
}

TEST_F(LampFile, IsAnObjectWithAnArrayOfObjects) {
  for (const char* text :
       {"", "7", "[]", "{}", R"({"lights": {}})", R"({"lights": null})", R"({"light": []})",
        R"({"lights": [3]})", R"({"lights": [[]]})", R"({"lights": [], "lamps": []})",
        R"({"lights": [{"type": "sphere", "radius": 1e999}]})", "\xff\xfe{",
        R"({"lights": [{"type": "sphere", "radius": NaN}]})"})
    EXPECT_THAT(error_of([&] { read(text); }), IsError(ExitCode::input, "lamps.json: ")) << text;
  EXPECT_TRUE(read(R"({"lights": []})").empty());
  EXPECT_THAT(error_of([&] { read_lamps(dir_.path()); }),
              IsError(ExitCode::input, "file of lights cannot be read"));
  EXPECT_THAT(error_of([&] { read(std::string(2 << 20, ' ')); }),
              IsError(ExitCode::input, "lamps.json"));
  EXPECT_THAT(error_of([&] { read(std::string(500000, '[')); }),
              IsError(ExitCode::input, "lamps.json: not JSON"));
}

TEST(LampText, IsATypeThenKeysAndValues) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"", "is empty"},
      {"   ", "is empty"},
      {"radius=1", "begins with 'radius=1'; the type of the light comes first"},
      {"sphere radius", "'radius' is not KEY=VALUE"},
      {"sphere =1", "'=1' is not KEY=VALUE"},
      {"sphere radius=1 radius=2", "radius is given twice"},
      {"sphere type=disk", "type is given twice"},
      {"sphere radius=nan", "--light sphere: radius is \"nan\""},
      {"sphere radius=inf", "radius is \"inf\""},
      {"sphere radius=1m", "radius is \"1m\""},
      {"sphere radius=", "radius is \"\""},
      {"sphere position=1,2,", "position is [1.0,2.0"},
      {"sphere name=key radius=-1", "--light key: radius is -1"},
  };
  for (const auto& [text, says] : cases) {
    const Error error = error_of([text = text] { parse_lamp(text); });
    EXPECT_THAT(error, IsError(ExitCode::usage, says)) << text;
  }
}

TEST(LampNames, DifferAndAreGivenToThoseWithout) {
  std::vector<Lamp> lamps(3);
  lamps[1].name = "key";
  name_lamps(lamps);
  EXPECT_EQ(lamps[0].name, "light1");
  EXPECT_EQ(lamps[2].name, "light3");
  lamps[0].name = "key", lamps[0].given_by = "a.json: light key", lamps[1].given_by = "--light key";
  EXPECT_THAT(
      error_of([&] { name_lamps(lamps); }),
      IsError(ExitCode::usage, "--light key: name 'key' is also that of a.json: light key"));
  std::vector<Lamp> many(kMostLamps + 1);
  EXPECT_THAT(error_of([&] { name_lamps(many); }),
              IsError(ExitCode::usage, "is light 65 of 65, and 64 is the most"));
  many.pop_back();
  EXPECT_NO_THROW(name_lamps(many));
}

TEST(Blackbody, IsWhiteAt6500AndAsInUsdLux) {
  EXPECT_LT(glm::distance(blackbody_color(6500), glm::dvec3(1)), 1e-9);
  // Rows of the table of UsdLux (after Walker, Colour Rendering of Spectra), with the white of its
  // documentation: over that of 6500 K, and of luminance 1.
  const glm::dvec3 white(1, 0.942771, 0.991642), weights(0.2126, 0.7152, 0.0722);
  const std::vector<std::pair<double, glm::dvec3>> rows = {{2000, {1, 0.256644, 0.008095}},
                                                           {3000, {1, 0.476725, 0.153601}},
                                                           {4500, {1, 0.726878, 0.501606}},
                                                           {9000, {0.638992, 0.716359, 1}}};
  for (const auto& [kelvin, row] : rows) {
    const glm::dvec3 color = row / white, expected = color / glm::dot(color, weights);
    EXPECT_LT(glm::distance(blackbody_color(kelvin), expected), 0.03 * glm::length(expected))
        << kelvin;
    EXPECT_NEAR(glm::dot(blackbody_color(kelvin), weights), 1, 1e-9);
  }
}

}  // namespace
}  // namespace ssdo::test::read_lamps_test
