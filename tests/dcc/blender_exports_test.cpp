// SPDX-License-Identifier: Apache-2.0
//
// One frame in every layout that Blender 3.4 writes: data/blender/export_layouts.py.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::blender_exports_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string exported(const std::string& name) { return data("blender/exports/" + name + ".exr"); }

/// The arguments that make a frame of one file per pass.
std::vector<std::string> passes() {
  std::vector<std::string> words = {exported("node_position"), "--aov", "position=rgba"};
  for (const std::string role : {"normal", "albedo", "depth"}) {
    words.push_back("--aov");
    words.push_back(role + "=" + exported("node_" + role) + ":rgba");
  }
  return words;
}

Plane<float> ao_of(std::vector<std::string> words) {
  TempDir dir;
  const std::vector<std::string> more = {"-o", dir / "out.exr", "--products",
                                         "ao", "--pixel-type",  "float"};
  words.insert(words.end(), more.begin(), more.end());
  const Finished done = run_tool(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return channel(dir / "out.exr", "ao.Y");
}

json info_of(std::vector<std::string> words) {
  words.insert(words.begin(), {"info", "--json"});
  const Finished done = run_tool(words);
  EXPECT_EQ(done.code, 0) << done.err;
  return parse_json(done.out);
}

TEST(BlenderExports, AreRecognised) {
  for (const std::vector<std::string>& words :
       {std::vector{exported("multilayer")}, std::vector{exported("node")}, passes()}) {
    SCOPED_TRACE(words[0]);
    const json found = info_of(words);
    for (const char* role : {"position", "normal", "albedo", "depth"})
      EXPECT_TRUE(found["layers"].contains(role)) << role;
    EXPECT_EQ(found["position"]["space"], "world");
    EXPECT_EQ(found["normals"]["space"], "the space of P");
    EXPECT_EQ(found["depth"]["kind"], "planar");
    EXPECT_NEAR(found["camera"]["hfov_deg"], 45, 1e-3);
    EXPECT_EQ(found["background_pixels"], 868);
  }
}

/// A scene with a compositor has Composite.Combined beside ViewLayer.Combined.
TEST(BlenderExports, AlphaIsThatBesideTheOtherLayers) {
  const json found = info_of({exported("multilayer")});
  EXPECT_EQ(found["layers"]["alpha"]["layer"], "ViewLayer.Combined");
}

TEST(BlenderExports, GiveOneResult) {
  const Plane<float> expected = ao_of({exported("multilayer")});
  EXPECT_EQ(ao_of({exported("node")}).pixels, expected.pixels);
  EXPECT_EQ(ao_of(passes()).pixels, expected.pixels);
}

TEST(BlenderExports, AFileOfOnePassSaysHowToNameIt) {
  const Finished done = run_tool({"info", exported("node_position")});
  EXPECT_EQ(done.code, 4);
  EXPECT_THAT(done.error_line(), HasSubstr("say --aov position=rgba"));
}

}  // namespace
}  // namespace ssdo::test::blender_exports_test
