// SPDX-License-Identifier: Apache-2.0
//
// Issue 12, number 11: whatever light comes in, no product of any method holds NaN or infinity.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "estimators/registry.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::light_range_test {
namespace {

using testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNaN = std::numeric_limits<float>::quiet_NaN();

class LightRangeOfTheTool : public testing::Test {
 protected:
  LightRangeOfTheTool() { write_frame(path("in.exr"), frame_of(small_picture())); }
  std::string path(const std::string& name) const { return dir_ / name; }

  /// A map of a dim sky with one texel of this radiance.
  std::string map_with(float texel) const {
    Plane<float> texels(64, 32, 0.5f);
    texels(20, 8) = texel;
    return write_map("map.exr", texels);
  }

  std::string write_map(const std::string& name, const Plane<float>& texels) const {
    const Window window{0, 0, texels.width, texels.height};
    FramePart part{"", window, window, {}, Imf::FLOAT, {}};
    for (const char* c : {"R", "G", "B"}) part.channels[c] = texels;
    write_frame(path(name), part);
    return path(name);
  }

  /// Every product that the method makes of in.exr is finite.
  void expect_finite(const std::string& method, std::vector<std::string> flags) const {
    SCOPED_TRACE(method + " " + testing::PrintToString(flags));
    flags.insert(flags.begin(), {path("in.exr"), "-o", path("out.exr"), "--overwrite", "--method",
                                 method, "--pixel-type", "float"});
    const Finished done = run_tool(flags);
    ASSERT_EQ(done.code, 0) << done.err;
    for (const std::string& name : channel_names(path("out.exr"))) {
      const Plane<float> values = channel(path("out.exr"), name);
      std::size_t broken = 0;
      for (const float value : values.pixels) broken += !std::isfinite(value);
      EXPECT_EQ(broken, 0u) << name;
    }
  }

  TempDir dir_;
};

TEST_F(LightRangeOfTheTool, EveryMethodIsFiniteInTheBrightestLight) {
  for (const Method& method : methods()) {
    const std::string name(method.name);
    expect_finite(name, {"--env", "1e15"});
    expect_finite(name, {"--env", map_with(1e15f)});
    expect_finite(name, {"--env", map_with(1.2e38f)});
    expect_finite(name, {"--env", map_with(1), "--env-exposure", "49"});
  }
  expect_finite("bitmask", {"--env", map_with(1e15f), "--bounces", "8"});
  expect_finite("bitmask", {"--env", map_with(kInfinity), "--bounces", "2"});
  expect_finite("bitmask", {"--env", map_with(kNaN)});
  expect_finite("bitmask", {"--env", write_map("point.exr", Plane<float>(1, 1, 2.0f))});
}

TEST_F(LightRangeOfTheTool, EveryMethodIsFiniteWithBrokenLayers) {
  FramePart part = frame_of(small_picture());
  Plane<float> wild(64, 48, 0.5f);
  wild(10, 10) = kInfinity, wild(20, 20) = -1e30f, wild(30, 30) = 3e38f, wild(40, 40) = 1e15f;
  wild(25, 40) = std::numeric_limits<float>::quiet_NaN();
  for (const char* c : {"ViewLayer.DiffCol.R", "glow.R", "glow.G", "glow.B", "R", "G", "B"})
    part.channels[c] = wild;
  part.channels["A"] = Plane<float>(64, 48, 0.001f);
  write_frame(path("in.exr"), part);
  for (const Method& method : methods()) {
    const std::string name(method.name);
    expect_finite(name, {"--env", "1e15"});
    if (method.products.bounce) expect_finite(name, {"--aov", "radiance=glow"});
    expect_finite(name, {"--aov", "ambient=glow"});
  }
}

TEST_F(LightRangeOfTheTool, AnAbsurdExposureIsRefused) {
  const Finished done = run_tool({path("in.exr"), "-o", path("out.exr"), "--env-exposure", "80"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.error_line(), HasSubstr("give 49 stops or less"));
  EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
}

TEST_F(LightRangeOfTheTool, TexelsThatAreNoLightAreMentioned) {
  for (const float texel : {kInfinity, kNaN}) {
    const Finished done =
        run_tool({path("in.exr"), "-o", path("out.exr"), "--overwrite", "--env", map_with(texel)});
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.err, HasSubstr("map.exr: 1 of 2048 texels are not finite"));
  }
  const Finished info = run_tool({"info", path("in.exr"), "--env", map_with(-1)});
  EXPECT_THAT(info.out, HasSubstr("1 of 2048 texels have negative channels"));
}

/// Issue 12, number 6.
TEST_F(LightRangeOfTheTool, ALayerOfAMapCanBeNamed) {
  const std::string map = map_with(0.5f);
  const Finished info = run_tool({"info", path("in.exr"), "--env", map + ":G"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("64 x 32"));
  EXPECT_EQ(run_tool({"info", path("in.exr"), "--env", map + ":AO"}).code, 4);
  const Finished onto = run_tool({path("in.exr"), "-o", map, "--env", map + ":G", "--overwrite"});
  EXPECT_EQ(onto.code, 5) << "the map is an input";
}

}  // namespace
}  // namespace ssdo::test::light_range_test
