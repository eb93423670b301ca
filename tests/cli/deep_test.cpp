// SPDX-License-Identifier: Apache-2.0
//
// Deep images through the real binary: as INPUT, and beside a frame with --also.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/boxes.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::deep_test {
namespace {

using testing::HasSubstr;
using testing::Not;

const Window kWindow{0, 0, 64, 48};

class Deep : public testing::Test {
 protected:
  Deep() {
    camera_ = look_at(camera_from_fov(40, kWindow, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
    write_frame(path("in.exr"), frame_of(take_picture(all_of(elements()), camera_, kWindow)));
    write_deep(path("deep.exr"), {{.pixels = deep()}});
  }

  /// A ground, a card before a box, and the box.
  static std::vector<Surface> elements() {
    return {plane({}, {0, 0, 1}), Box{{-0.7, -1.5, 0.4}, {0.6, -1.45, 1.5}}.surface(),
            Box{{-0.4, -0.6, 0}, {0.5, 0.1, 0.6}}.surface()};
  }
  DeepPixels deep() const { return merged(elements(), camera_, kWindow); }

  std::string path(const std::string& name) const { return dir_ / name; }

  Finished run(std::vector<std::string> words, const Surroundings& around = {}) const {
    if (words[0] != "info" && words[0] != "bench")
      words.insert(words.end(), {"-o", path("out.exr"), "--overwrite", "--pixel-type", "float"});
    return run_tool(words, around);
  }

  void refused(const std::vector<std::string>& words, int code, const std::string& says) const {
    const Finished done = run(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
  }

  /// RMSE of ao between out.exr and another output.
  double difference(const Plane<float>& before) const {
    const Plane<float> now = channel(path("out.exr"), "ao.Y");
    double sum = 0;
    for (std::size_t i = 0; i < now.size(); ++i) sum += std::pow(now[i] - before[i], 2);
    return std::sqrt(sum / double(now.size()));
  }

  Camera camera_;
  TempDir dir_;
};

/// Its samples have no names: what would be left of an object cannot be told.
TEST_F(Deep, RefusesObjectsThatCastNothing) {
  const std::string says = "--no-cast: deep samples do not say what they are of; leave the deep";
  for (const Words& words :
       {Words{path("in.exr"), "--also", path("deep.exr")}, Words{path("deep.exr"), "--fov", "40"}})
    refused(words + Words{"--no-cast", path("in.exr") + ":ViewLayer.Depth"}, 2, says);
  refused({path("in.exr"), "--also", path("deep.exr"), "--shadow-of", "ViewLayer.Depth"}, 2,
          "--shadow-of: deep samples");
  refused({path("in.exr"), "--also", path("deep.exr"), "--light",
           "sphere name=key position=0,0,3 cast=ViewLayer.Depth"},
          2, "key: cast: deep samples");
}

TEST_F(Deep, CountsSamplesThatAreNoNumbers) {
  DeepPixels pixels = deep();
  for (std::size_t i = 0; i < 30; ++i)
    for (DeepSample& s : pixels.samples[10 * i]) s.front = NAN;
  write_deep(path("broken.exr"), {{.pixels = pixels}});
  const Finished done = run({"info", path("broken.exr"), "--fov", "40"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("deep samples have a Z or alpha that is no number"));
  EXPECT_THAT(done.out, HasSubstr(", 30 broken)"));
}

TEST_F(Deep, BesideAFrameMeasuresWhatIsHidden) {
  ASSERT_EQ(run({path("in.exr")}).code, 0);
  const Plane<float> alone = channel(path("out.exr"), "ao.Y");
  const Finished done = run({path("in.exr"), "--also", path("deep.exr"), "-v"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("measured solids behind "));
  EXPECT_THAT(done.err, WarnsOfNothing());
  EXPECT_GT(difference(alone), 0.002);

  // Tiles, half and parts of the elements give about the same.
  const Plane<float> measured = channel(path("out.exr"), "ao.Y");
  write_deep(path("tiles.exr"), {{.pixels = deep(), .tiles = true}});
  ASSERT_EQ(run({path("in.exr"), "--also", path("tiles.exr")}).code, 0);
  EXPECT_EQ(difference(measured), 0);
  write_deep(path("layer.exr"), {{.pixels = deep(), .front = "depth.Z", .back = "depth.ZBack"}});
  ASSERT_EQ(run({path("in.exr"), "--also", path("layer.exr")}).code, 0);
  EXPECT_EQ(difference(measured), 0);
  write_deep(path("half.exr"), {{.pixels = deep(), .type = Imf::HALF}});
  ASSERT_EQ(run({path("in.exr"), "--also", path("half.exr")}).code, 0);
  EXPECT_LT(difference(measured), 0.003);
  std::vector<std::string> words = {path("in.exr")};
  for (int i : {2, 0, 1}) {
    words.insert(words.end(), {"--also", path(fmt::format("{}.exr", i))});
    write_deep(words.back(), {{.pixels = merged({elements()[std::size_t(i)]}, camera_, kWindow)}});
  }
  ASSERT_EQ(run(words).code, 0);
  EXPECT_EQ(difference(measured), 0) << "elements that are not merged";
}

/// Where a part of its samples is lost, a frame is what is left of it: rows of an INPUT without any
/// are background.
TEST_F(Deep, ThatIsCutShortGivesWhatIsThere) {
  ExrBytes bytes(path("deep.exr"));
  bytes.cut(std::size_t(bytes.places(48)[36]) + 9);
  bytes.write(path("cut.exr"));
  const std::string loss =
      "cut.exr: part 0 'deep': 12 of 48 rows are missing or damaged, between rows 36 "
      "and 47; taken as background\n";
  for (const std::vector<std::string>& words :
       {std::vector{path("in.exr"), std::string("--also"), path("cut.exr")},
        std::vector{path("cut.exr"), std::string("--fov"), std::string("40")}}) {
    refused(words, 3, "--allow-partial");
    std::vector<std::string> all = words;
    all.push_back("--allow-partial");
    const Finished done = run(all);
    EXPECT_EQ(done.code, 3) << done.err;
    EXPECT_THAT(done.err, HasSubstr(path(loss)));
    ASSERT_TRUE(std::filesystem::exists(path("out.exr"))) << done.err;
    const Plane<float> found = channel(path("out.exr"), "ao.Y");
    EXPECT_LT(found(32, 20), 1);
    std::filesystem::remove(path("out.exr"));
    if (words.size() == 3 && words[1] == "--also") continue;
    EXPECT_EQ(found(32, 40), 1);
  }
}

TEST_F(Deep, GivesTheSameBitsOnAnyNumberOfThreads) {
  ASSERT_EQ(run({path("in.exr"), "--also", path("deep.exr"), "--threads", "1"}).code, 0);
  const std::string one = read_file(path("out.exr"));
  ASSERT_EQ(run({path("in.exr"), "--also", path("deep.exr"), "--threads", "3"}).code, 0);
  EXPECT_TRUE(one == read_file(path("out.exr")));
}

TEST_F(Deep, AsInputShowsItsNearestSurfaces) {
  FramePart flat = frame_of(take_picture(all_of(elements()), camera_, kWindow));
  std::erase_if(flat.channels, [](const auto& c) { return c.first.find("Depth") == c.first.npos; });
  write_frame(path("flat.exr"), flat);
  ASSERT_EQ(run({path("flat.exr"), "--fov", "40", "--also", path("deep.exr")}).code, 0);
  const Plane<float> from_flat = channel(path("out.exr"), "ao.Y");
  for (const bool tiles : {false, true}) {
    write_deep(path("deep.exr"), {{.pixels = deep(), .tiles = tiles}});
    const Finished done = run({path("deep.exr"), "--fov", "40", "-v"});
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("measured solids behind "));
    EXPECT_LT(difference(from_flat), 1e-4) << "but for the rounding of the depth";
    EXPECT_FALSE(ExrReader(path("out.exr")).parts()[0].deep);
  }
  std::filesystem::remove(path("out.exr"));
  refused({path("deep.exr")}, 4, "--fov");
}

TEST_F(Deep, AsInputMayStandBesideFlatParts) {
  FramePart flat = frame_of(take_picture(all_of(elements()), camera_, kWindow));
  std::erase_if(flat.channels,
                [](const auto& c) { return c.first.find("DiffCol") == c.first.npos; });
  write_frame(path("flat.exr"), flat);
  const Finished done =
      run({path("deep.exr"), "--fov", "40", "--aov",
           "albedo=" + path("flat.exr") + ":ViewLayer.DiffCol", "--keep-channels"});
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(channel_names(path("out.exr")), testing::IsSupersetOf({"bounce.R", "ao.Y", "R"}));
  EXPECT_THAT(channel_names(path("out.exr")), Not(testing::Contains("Z")));
}

TEST_F(Deep, IsDescribed) {
  const Finished text = run({"info", path("in.exr"), "--also", path("deep.exr")});
  EXPECT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("deep scanlines"));
  EXPECT_THAT(text.out, HasSubstr("measured solids behind "));
  const Finished done = run({"info", "--json", path("deep.exr"), "--fov", "40"});
  ASSERT_EQ(done.code, 0) << done.err;
  const auto found = parse_json(done.out);
  EXPECT_EQ(found["layers"]["depth"]["channels"][0], "Z");
  const Finished bench = run({"bench", path("in.exr"), "--also", path("deep.exr"), "--methods",
                              "ssao", "--report", path("r.json")});
  EXPECT_EQ(bench.code, 0) << bench.err;
  EXPECT_THAT(read_file(path("r.json")), HasSubstr("measured solids behind "));
}

TEST_F(Deep, IsRefusedWhereItCannotBeUsed) {
  const std::string in = path("in.exr");
  write_deep(path("no_z.exr"), {{.pixels = deep(), .front = ""}});
  refused({in, "--also", path("no_z.exr")}, 4, "no_z.exr: its deep samples have no Z");
  refused({path("no_z.exr"), "--fov", "40"}, 4, "no_z.exr: its deep samples have no Z");
  write_deep(path("large.exr"), {{.pixels = deep(), .display = {0, 0, 128, 96}}});
  refused({in, "--also", path("large.exr")}, 4, "large.exr: has the display window 0,0 to 127,95");
  std::filesystem::copy_file(path("deep.exr"), path("cut.exr"));
  std::filesystem::resize_file(path("cut.exr"), std::filesystem::file_size(path("cut.exr")) / 2);
  refused({in, "--also", path("cut.exr")}, 3, "cut.exr: is ");
  refused({path("cut.exr"), "--fov", "40"}, 3, "cut.exr: is ");
  std::ofstream(path("empty.exr"));
  refused({in, "--also", path("empty.exr")}, 3, "empty.exr: is empty");
}

TEST_F(Deep, WithoutSamplesAddsNothing) {
  write_deep(path("none.exr"), {{.pixels = DeepPixels(kWindow)}});
  ASSERT_EQ(run({path("in.exr")}).code, 0);
  const Plane<float> alone = channel(path("out.exr"), "ao.Y");
  const Finished done = run({path("in.exr"), "--also", path("none.exr")});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("none.exr: holds no deep sample in any pixel"));
  EXPECT_EQ(difference(alone), 0);
  const Finished black = run({path("none.exr"), "--fov", "40"});
  EXPECT_EQ(black.code, 0) << black.err;
  EXPECT_THAT(black.err, HasSubstr("the frame shows no surface"));
}

TEST_F(Deep, HasNoEffectOnMethodsThatSeeOneLayer) {
  const Finished done = run({path("in.exr"), "--method", "ssao", "--also", path("deep.exr")});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("--also has no effect: method ssao"));
}

}  // namespace
}  // namespace ssdo::test::deep_test
