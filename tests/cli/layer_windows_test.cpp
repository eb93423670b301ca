// SPDX-License-Identifier: Apache-2.0
//
// Layers whose windows differ: issue 12, number 5.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::layer_windows_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kDisplay{0, 0, 64, 48};

class LayerWindows : public testing::Test {
 protected:
  LayerWindows() { write_frame(path("in.exr"), frame_of(small_picture())); }
  std::string path(const std::string& name) const { return dir_ / name; }

  /// Writes a frame with these windows; the pixels outside `data` are left out.
  void write(const std::string& name, const Window& data, const Window& display = kDisplay,
             float aspect = 1) const {
    FramePart part = frame_of(small_picture(data, display));
    part.display = display;
    part.extra.pixelAspectRatio() = aspect;
    write_frame(path(name), part);
  }
  Finished info(const std::vector<std::string>& aovs, const std::string& frame = "in.exr") const {
    std::vector<std::string> words = {"info", path(frame), "--json"};
    for (const std::string& aov : aovs) words.insert(words.end(), {"--aov", aov});
    return run_tool(words);
  }
  std::string from(const std::string& file, const std::string& layer) const {
    return path(file) + ":ViewLayer." + layer;
  }
  /// The warnings of a frame that is taken.
  std::string warnings(const std::vector<std::string>& aovs,
                       const std::string& frame = "in.exr") const {
    const Finished done = info(aovs, frame);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out)["warnings"].dump();
  }
  TempDir dir_;
};

TEST_F(LayerWindows, AnotherDisplayWindowIsAnErrorThatNamesBoth) {
  write("half.exr", {0, 0, 32, 24}, {0, 0, 32, 24});
  for (const char* layer : {"position=ViewLayer.Position", "albedo=ViewLayer.DiffCol",
                            "normal=ViewLayer.Normal", "alpha=ViewLayer.Depth.Z"}) {
    const std::string role = std::string(layer).substr(0, std::string(layer).find('='));
    const std::string name = std::string(layer).substr(role.size() + 1);
    const Finished done = run_tool({path("in.exr"), "-o", path("out.exr"), "--aov",
                                    role + "=" + path("half.exr") + ":" + name});
    EXPECT_EQ(done.code, 4) << layer;
    EXPECT_THAT(done.error_line(), AllOf(HasSubstr("half.exr"), HasSubstr("in.exr"),
                                         HasSubstr("0,0 to 31,23"), HasSubstr("0,0 to 63,47")));
    EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
  }
}

TEST_F(LayerWindows, AnErrorNamesThePartToo) {
  FramePart small = frame_of(small_picture({0, 0, 32, 24}, {0, 0, 32, 24}));
  FramePart other = small;
  small.name = "beauty";
  other.name = "data";
  write_frame(path("half.exr"), {small, other});
  const Finished done = info({"albedo=" + path("half.exr") + ":data.ViewLayer.DiffCol"});
  EXPECT_EQ(done.code, 4);
  EXPECT_THAT(done.error_line(), HasSubstr("in part 1 'data' of " + path("half.exr")));
}

TEST_F(LayerWindows, ADisplayWindowElsewhereIsAnotherOne) {
  write("moved.exr", {100, 0, 164, 48}, {100, 0, 164, 48});
  EXPECT_EQ(info({"albedo=" + from("moved.exr", "DiffCol")}).code, 4);
}

TEST_F(LayerWindows, OverscanIsCutAsBefore) {
  write("overscan.exr", {-8, -8, 72, 56});
  for (const char* layer : {"normal=Normal", "albedo=DiffCol"}) {
    const std::string role = std::string(layer).substr(0, 6);
    EXPECT_THAT(warnings({role + "=" + from("overscan.exr", std::string(layer).substr(7))}),
                Not(HasSubstr("data window")));
  }
}

TEST_F(LayerWindows, SurfacesThatALayerLeavesOutAreCounted) {
  write("crop.exr", {0, 12, 64, 48});
  const Plane<glm::vec3> all = small_picture().position;
  std::size_t above = 0, surfaces = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    surfaces += all[i] != glm::vec3(0);
    above += i < 12 * 64 && all[i] != glm::vec3(0);
  }
  const std::string count = std::to_string(above) + " of " + std::to_string(surfaces) + " surfaces";
  EXPECT_THAT(warnings({"albedo=" + from("crop.exr", "DiffCol")}),
              AllOf(HasSubstr(count), HasSubstr("0,12 to 63,47"), HasSubstr("black")));
  const nlohmann::json found = parse_json(info({"normal=" + from("crop.exr", "Normal")}).out);
  EXPECT_THAT(found["warnings"].dump(), AllOf(HasSubstr(count), HasSubstr("rebuilt from P")));
  EXPECT_EQ(found["surface_pixels"], surfaces);
  EXPECT_EQ(found["bad_pixels"], 0);
  EXPECT_GE(found["normals"]["rebuilt"].get<std::size_t>(), above);
}

/// Without a depth, nothing but the normal would make these pixels background.
TEST_F(LayerWindows, SurfacesWithoutANormalStaySurfaces) {
  write("crop.exr", {0, 12, 64, 48});
  FramePart part = frame_of(small_picture());
  part.channels.erase("ViewLayer.Depth.Z");
  write_frame(path("p.exr"), part);
  const auto surfaces = [&](const std::vector<std::string>& aovs) {
    return parse_json(info(aovs, "p.exr").out)["surface_pixels"].get<int>();
  };
  EXPECT_EQ(surfaces({"normal=" + from("crop.exr", "Normal")}), surfaces({}));
}

TEST_F(LayerWindows, AnAlphaThatEndsBeforeThePositionsIsWarnedOf) {
  FramePart part = frame_of(small_picture({0, 12, 64, 48}, kDisplay));
  part.display = kDisplay;
  part.channels["A"] = Plane<float>(64, 36, 1);
  write_frame(path("alpha.exr"), part);
  EXPECT_THAT(warnings({"alpha=" + path("alpha.exr") + ":A"}),
              AllOf(HasSubstr("surfaces count as background"), HasSubstr("0,12 to 63,47")));
}

TEST_F(LayerWindows, ALayerThatCoversNothingIsWarnedOf) {
  write("beside.exr", {200, 0, 264, 48});
  EXPECT_THAT(warnings({"albedo=" + from("beside.exr", "DiffCol")}),
              HasSubstr("3072 of 3072 surfaces"));
}

TEST_F(LayerWindows, PixelsOfAnotherAspectAreWarnedOfOnce) {
  write("wide.exr", kDisplay, kDisplay, 2);
  const Finished done =
      info({"albedo=" + from("wide.exr", "DiffCol"), "normal=" + from("wide.exr", "Normal")});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto list = parse_json(done.out)["warnings"];
  EXPECT_EQ(
      std::count_if(list.begin(), list.end(),
                    [](const std::string& w) { return w.find("aspect 2") != std::string::npos; }),
      1)
      << list;
}

}  // namespace
}  // namespace ssdo::test::layer_windows_test
