// SPDX-License-Identifier: Apache-2.0
//
// --allow-partial: what is there of a frame that was cut short or damaged.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/exr_bytes.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::partial_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

/// Six chunks of 16 rows.
constexpr Window kWindow{0, 0, 64, 96};
constexpr std::size_t kChunks = 6;

/// Rows that the radius of kPlaced covers at most; the nearest surface is 3.3 from the camera.
constexpr int kReach = 10;

class Partial : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    dir_ = std::make_unique<TempDir>();
    write_frame(path("whole.exr"), frame());
    const nlohmann::json info = parse_json(run_tool({"info", path("whole.exr"), "--json"}).out);
    std::ofstream(path("camera.json")) << info["camera"].dump();
    ASSERT_EQ(run({path("whole.exr")}, "whole_out.exr").code, 0);
  }
  static void TearDownTestSuite() { dir_.reset(); }

  static std::string path(const std::string& name) { return *dir_ / name; }

  static FramePart frame() { return frame_of(small_picture(kWindow, kWindow)); }

  /// A copy of a file that ends within a chunk, counted over all parts.
  static void cut(const std::string& from, const std::string& to, std::size_t chunk,
                  std::size_t chunks = kChunks) {
    ExrBytes bytes(path(from));
    bytes.cut(std::size_t(bytes.places(chunks)[chunk]) + 9);
    bytes.write(path(to));
  }

  /// With what says how a frame lies, so that nothing is left to find out of a part of it.
  static Finished run(const Words& words, const std::string& out) {
    Words all = words;
    for (const std::string& word :
         {std::string("-o"), path(out), std::string("--overwrite"), std::string("--camera"),
          path("camera.json"), std::string("--radius"), std::string("0.2"),
          std::string("--thickness"), std::string("0.3"), std::string("--filter"),
          std::string("none"), std::string("--pixel-type"), std::string("float")})
      all.push_back(word);
    return run_tool(all);
  }

  /// Missing pixels of an output are background, and those beyond the reach of these have the bits
  /// of the whole frame.
  static void expect_partial(const std::string& out, const Window& missing) {
    for (const std::string& name : channel_names(path(out))) {
      const Plane<float> found = channel(path(out), name),
                         whole = channel(path("whole_out.exr"), name);
      const float background = name == "ao.Y" ? 1.0f : 0.0f;
      for (int y = 0; y < found.height; ++y) {
        for (int x = 0; x < found.width; ++x) {
          ASSERT_TRUE(std::isfinite(found(x, y))) << name << " " << x << " " << y;
          if (missing.contains(x, y)) {
            ASSERT_EQ(found(x, y), background) << name << " " << x << " " << y;
          } else if (x < missing.x0 - kReach || x >= missing.x1 + kReach ||
                     y < missing.y0 - kReach || y >= missing.y1 + kReach) {
            ASSERT_EQ(found(x, y), whole(x, y)) << name << " " << x << " " << y;
          }
        }
      }
    }
  }

  static std::unique_ptr<TempDir> dir_;
};

std::unique_ptr<TempDir> Partial::dir_;

TEST_F(Partial, RowsOfACutFrameAreThoseOfTheWholeOne) {
  for (const int sound : {1, 3, 5}) {
    cut("whole.exr", "cut.exr", std::size_t(sound));
    const Finished done = run({path("cut.exr"), "--allow-partial"}, "out.exr");
    EXPECT_EQ(done.code, 3);
    EXPECT_THAT(done.err, HasSubstr("ssdo: " + path("cut.exr") +
                                    ": part 0: " + std::to_string(96 - 16 * sound) +
                                    " of 96 rows are missing or damaged, between rows " +
                                    std::to_string(16 * sound) + " and 95; taken as background\n"));
    expect_partial("out.exr", {0, 16 * sound, 64, 96});
  }
}

TEST_F(Partial, WithoutTheOptionItIsNamed) {
  cut("whole.exr", "cut.exr", 3);
  fs::remove(path("out.exr"));
  const Finished done = run({path("cut.exr")}, "out.exr");
  EXPECT_EQ(done.code, 3);
  EXPECT_THAT(done.error_line(), AllOf(HasSubstr("cut.exr: is damaged or cut short (part 0: "),
                                       HasSubstr("or take what is there with --allow-partial")));
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

TEST_F(Partial, NothingIsSaidOfAWholeFrame) {
  const Finished done = run({path("whole.exr"), "--allow-partial"}, "out.exr");
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, Not(HasSubstr("missing")));
  expect_partial("out.exr", {});
}

TEST_F(Partial, AFrameWithoutAChunkIsAnError) {
  cut("whole.exr", "cut.exr", 0);
  fs::remove(path("out.exr"));
  EXPECT_EQ(run({path("cut.exr"), "--allow-partial"}, "out.exr").code, 3);
  EXPECT_FALSE(fs::exists(path("out.exr")));
}

TEST_F(Partial, ABrokenTileIsAllThatIsLost) {
  FramePart part = frame();
  part.tile_size = 16;
  write_frame(path("tiles.exr"), part);
  ExrBytes bytes(path("tiles.exr"));
  bytes.put_int(std::size_t(bytes.places(24)[9]) + 16, -1);  // the size of its data
  bytes.write(path("tiles.exr"));
  const Finished done = run({path("tiles.exr"), "--allow-partial", "-q"}, "out.exr");
  EXPECT_EQ(done.code, 3);
  EXPECT_THAT(done.error_line(), HasSubstr("part 0: 1 of 24 tiles are missing or damaged, between "
                                           "rows 32 and 47; taken as background"));
  expect_partial("out.exr", {16, 32, 32, 48});
}

/// Layers of a whole part, and what is kept of a part that is not.
TEST_F(Partial, PartsOnTheirOwn) {
  const auto has_color = [](const std::string& name) { return name.find("DiffCol") != name.npos; };
  FramePart geometry = frame(), colors = geometry;
  geometry.name = "geometry", colors.name = "colors";
  std::erase_if(geometry.channels, [&](const auto& c) { return has_color(c.first); });
  std::erase_if(colors.channels, [&](const auto& c) { return !has_color(c.first); });
  colors.channels["mask.Y"] = Plane<float>(64, 96, 1.0f);
  FramePart extra = colors;
  extra.name = "extra", extra.channels = {{"id.Y", Plane<float>(64, 96, 7.0f)}};
  write_frame(path("parts.exr"), {geometry, colors, extra});
  ExrBytes bytes(path("parts.exr"));
  const auto places = bytes.places(18);
  for (const std::size_t chunk : {std::size_t(8), std::size_t(14)})
    bytes.put_int(std::size_t(places[chunk]) + 8, -1);
  bytes.write(path("parts.exr"));

  const Finished done =
      run({path("parts.exr"), "--allow-partial", "--keep-channels"}, "parts_out.exr");
  EXPECT_EQ(done.code, 3);
  for (const char* line : {": part 1 'colors': 16 of 96 rows are missing or damaged, between rows "
                           "32 and 47; taken as background\n",
                           ": part 2 'extra': 16 of 96 rows are missing or damaged, between rows "
                           "32 and 47; taken as background\n"})
    EXPECT_THAT(done.err, HasSubstr(path("parts.exr") + line));
  EXPECT_THAT(done.err, Not(HasSubstr("'geometry'")));
  EXPECT_TRUE(channel(path("parts_out.exr"), "ao.Y").pixels ==
              channel(path("whole_out.exr"), "ao.Y").pixels);
  const Plane<float> red = channel(path("parts_out.exr"), "R"),
                     mask = channel(path("parts_out.exr"), "mask.Y", 1),
                     id = channel(path("parts_out.exr"), "id.Y", 2);
  for (int y = 0; y < 96; ++y) {
    const bool is_lost = y >= 32 && y < 48;
    EXPECT_EQ(mask(3, y), is_lost ? 0 : 1) << y;
    EXPECT_EQ(id(3, y), is_lost ? 0 : 7) << y;
    if (is_lost) {
      EXPECT_EQ(red(32, y), 0) << y;
    }
  }
  EXPECT_EQ(channel(path("parts_out.exr"), "ViewLayer.Position.X").pixels,
            channel(path("whole.exr"), "ViewLayer.Position.X").pixels);
}

TEST_F(Partial, FilesBesideTheFrameToo) {
  cut("whole.exr", "cut.exr", 4);
  const std::string loss =
      "cut.exr: part 0: 32 of 96 rows are missing or damaged, between rows 64 "
      "and 95; taken as background\n";
  for (const Words& words : {Words{"--aov", "normal=" + path("cut.exr") + ":ViewLayer.Normal"},
                             Words{"--also", path("cut.exr")}}) {
    Words all = {path("whole.exr")};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_THAT(run(all, "out.exr").err, HasSubstr("--allow-partial")) << words[0];
    all.push_back("--allow-partial");
    const Finished done = run(all, "out.exr");
    EXPECT_EQ(done.code, 3) << done.err;
    EXPECT_THAT(done.err, HasSubstr(path(loss))) << words[0];
  }
}

class PartialShot : public Partial {
 protected:
  PartialShot() {
    for (const char* name : {"shot.1.exr", "shot.3.exr"})
      fs::copy_file(path("whole.exr"), path(name), fs::copy_options::overwrite_existing);
    cut("whole.exr", "shot.2.exr", 4);
    for (int i = 1; i <= 3; ++i) fs::remove(output(i));
  }
  static std::string output(int i) { return path("shot_out." + std::to_string(i) + ".exr"); }
  static Finished run_shot(const Words& words, const std::string& frames = "1-3") {
    Words all = {path("shot.@.exr"), "--allow-partial", "--frames", frames};
    all.insert(all.end(), words.begin(), words.end());
    return run(all, "shot_out.@.exr");
  }
};

TEST_F(PartialShot, GoesOnAndEndsWith3) {
  for (const char* threads : {"1", "2"}) {
    for (int i = 1; i <= 3; ++i) fs::remove(output(i));
    const Finished done = run_shot({"--threads", threads, "--stats", path("stats.json")});
    EXPECT_EQ(done.code, 3);
    for (int i = 1; i <= 3; ++i) EXPECT_TRUE(fs::exists(output(i))) << i;
    const nlohmann::json stats = parse_json(read_file(path("stats.json")));
    ASSERT_EQ(stats.size(), 3u);
    for (const std::size_t i : {0u, 1u, 2u}) EXPECT_EQ(stats[i]["missing"].size(), i == 1 ? 1 : 0);
  }
}

TEST_F(PartialShot, AnEarlierFailureHasItsOwnStatus) {
  FramePart part = frame();
  part.channels = {{"A", Plane<float>(64, 96, 1.0f)}};
  write_frame(path("shot.1.exr"), part);
  EXPECT_EQ(run_shot({"--on-error", "continue"}).code, 4);
  EXPECT_EQ(run_shot({"--on-error", "continue"}, "2,1").code, 3);
}

TEST_F(PartialShot, ALentFrameToo) {
  const Finished done = run_shot({"--shot", "1"}, "1");
  EXPECT_EQ(done.code, 3);
  EXPECT_THAT(done.err,
              AllOf(HasSubstr("shot.2.exr: part 0: 32 of 96 rows"), Not(HasSubstr("do without"))));
}

TEST_F(PartialShot, AnOutputIsSkippedLikeAnyOther) {
  EXPECT_EQ(run_shot({}).code, 3);
  const Finished again = run_shot({"--skip-existing", "-v"});
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, HasSubstr("shot.2.exr: skipped"));
}

TEST_F(Partial, InfoAndDryRunTellIt) {
  cut("whole.exr", "cut.exr", 4);
  const Finished text = run_tool({"info", path("cut.exr"), "--allow-partial"}),
                 json = run_tool({"info", path("cut.exr"), "--allow-partial", "--json"}),
                 dry = run_tool({path("cut.exr"), "--allow-partial", "--dry-run"});
  for (const Finished& done : {text, json, dry}) {
    EXPECT_EQ(done.code, 3) << done.out;
    EXPECT_THAT(done.err, HasSubstr("32 of 96 rows are missing"));
  }
  EXPECT_THAT(text.out, HasSubstr("  missing   " + path("cut.exr") + ": part 0: 32 of 96 rows"));
  EXPECT_EQ(parse_json(json.out)["missing"].size(), 1u);
  EXPECT_EQ(run_tool({"info", path("cut.exr")}).code, 3);
}

/// Bands read the same rows several times, and through an overview first.
TEST_F(Partial, BandsHaveTheBitsOfOnePiece) {
  const Window window{0, 0, 320, 1600};
  for (const int tile_size : {0, 64}) {
    FramePart part = frame_of(small_picture(window, window));
    part.tile_size = tile_size;
    write_frame(path("large.exr"), part);
    const nlohmann::json info = parse_json(run_tool({"info", path("large.exr"), "--json"}).out);
    std::ofstream(path("large.json")) << info["camera"].dump();
    cut("large.exr", "large.exr", 70, tile_size ? 125 : 100);
    const auto run_large = [&](const std::string& out, const std::string& limit) {
      return run_tool({path("large.exr"),
                       "--allow-partial",
                       "-o",
                       path(out),
                       "--overwrite",
                       "--camera",
                       path("large.json"),
                       "--radius",
                       "0.2",
                       "--thickness",
                       "0.3",
                       "--pixel-type",
                       "float",
                       "--quality",
                       "draft",
                       "--products",
                       "ao,direct",
                       "--mem-limit",
                       limit,
                       "-v"});
    };
    EXPECT_EQ(run_large("large_out.exr", "4G").code, 3);
    const Finished bands = run_large("bands_out.exr", "112M");
    EXPECT_EQ(bands.code, 3);
    EXPECT_THAT(bands.err, testing::ContainsRegex("[0-9] bands? of [0-9]+ rows"));
    EXPECT_TRUE(channel(path("bands_out.exr"), "ao.Y").pixels ==
                channel(path("large_out.exr"), "ao.Y").pixels)
        << tile_size;
  }
}

}  // namespace
}  // namespace ssdo::test::partial_test
