// SPDX-License-Identifier: Apache-2.0
//
// --mem-limit: a frame that is larger than memory is processed in bands of rows.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "support/analytic_scene.h"
#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::bands_test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Bands : public testing::Test {
 protected:
  /// What a frame of kWindow is too large for.
  inline static const Words kLimit = {"--mem-limit", "124M"};
  static constexpr Window kWindow{0, 0, 320, 1600};
  static constexpr char kBands[] = "[0-9] bands? of (all|[0-9]+) rows";

  static void SetUpTestSuite() {
    dir_ = std::make_unique<TempDir>();
    write("in.exr", kWindow, kWindow);
  }
  static void TearDownTestSuite() { dir_.reset(); }

  static std::string path(const std::string& name) { return *dir_ / name; }

  static void write(const std::string& name, const Window& data, const Window& display) {
    FramePart part = frame_of(small_picture(data, display));
    part.data = data, part.display = display;
    write_frame(path(name), part);
  }

  /// What says how a frame lies, so that nothing is left to find out of a part of it.
  static Words placed(const std::string& in) {
    const nlohmann::json info = parse_json(run_tool({"info", path(in), "--json"}).out);
    std::ofstream(path("camera.json")) << info["camera"].dump();
    return {"--camera", path("camera.json"), "--thickness", "0.3"};
  }

  static Finished run(const std::string& in, const std::string& out, const Words& flags) {
    return run_tool(Words{path(in), "-o", path(out), "--overwrite"} + flags);
  }

  /// Runs in one piece and in bands, and gives the names of the channels.
  static Words make_both(const std::string& in, const Words& flags, const Words& limit = kLimit) {
    const Finished whole = run(in, "whole.exr", flags + Words{"-v"}),
                   bands = run(in, "bands.exr", flags + limit + Words{"-v"});
    EXPECT_EQ(whole.code, 0) << whole.err;
    EXPECT_EQ(bands.code, 0) << bands.err;
    EXPECT_THAT(whole.err, Not(ContainsRegex(kBands)));
    EXPECT_THAT(bands.err, ContainsRegex(kBands));
    bands_ = bands.err;
    if (bands.code != 0) return {};
    EXPECT_EQ(channel_names(path("bands.exr")), channel_names(path("whole.exr")));
    return channel_names(path("whole.exr"));
  }

  static void expect_same_bits(const std::string& in, const Words& flags,
                               const Words& limit = kLimit) {
    const Words names = make_both(in, flags + Words{"--pixel-type", "float"}, limit);
    EXPECT_THAT(bands_, Not(HasSubstr("marches go on")));
    for (const std::string& name : names) {
      EXPECT_TRUE(channel(path("bands.exr"), name).pixels ==
                  channel(path("whole.exr"), name).pixels)
          << name;
    }
  }

  /// Root of the mean square of the difference, over the mean of what is made in one piece.
  static double difference(const std::string& name) {
    const Plane<float> whole = channel(path("whole.exr"), name),
                       bands = channel(path("bands.exr"), name);
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < whole.size(); ++i) {
      squares += std::pow(double(bands[i]) - double(whole[i]), 2);
      sum += double(whole[i]);
    }
    return std::sqrt(squares * double(whole.size())) / sum;
  }

  static std::unique_ptr<TempDir> dir_;
  static std::string bands_;  ///< what the last run in bands said
};

std::unique_ptr<TempDir> Bands::dir_;
std::string Bands::bands_;

TEST_F(Bands, HaveTheSameBitsWithinARadius) {
  const Words flags =
      placed("in.exr") + Words{"--env", data("environments/sky.exr"), "--env-up", "z"};
  expect_same_bits("in.exr", flags + Words{"--radius", "0.2"});
  expect_same_bits("in.exr",
                   flags + Words{"--radius", "0.1", "--bounces", "2", "--products",
                                 "ao,bent,direct,reflection,bounce", "--compression", "piz"},
                   {"--mem-limit", "148M"});
}

TEST_F(Bands, HaveTheSameBitsUnderLampsInTheFrameAndBehindTheCamera) {
  const Words lamps = {"--env",   "0,0,0",
                       "--light", "sphere position=0,0,1.5 radius=0.1 intensity=9",
                       "--light", "rect position=3,-6,4 direction=-0.4,0.8,-0.5 width=1 height=1"};
  expect_same_bits("in.exr",
                   placed("in.exr") + lamps + Words{"--radius", "0.2", "--products", "ao,direct"});
}

/// How much of a sun comes past the border depends on the mean ao of all bands, and on what they
/// show above the horizon.
TEST_F(Bands, OfADenseFrameHaveTheSameBitsUnderASun) {
  const double c = 0.966, s = 0.259;  // walls 15 degrees from the view
  const auto wall = [&](double side) {
    return cut(plane({0, 0, -4}, {side * c, 0, s}), [=](const glm::dvec3& p) {
      return std::sin(2.1 * p.y + side) + std::sin(5.3 * p.y) < 1.7;
    });
  };
  const Surface gorge = all_of({wall(1), wall(-1), plane({0, 0, -6}, {0, 0, 1})});
  const Camera camera =
      look_at(camera_from_ortho_width(2, kWindow, 1), {0, 0, 0}, {0, 0.1, -1}, {0, 1, 0});
  FramePart part = frame_of(take_picture(gorge, camera, kWindow));
  part.data = part.display = kWindow;
  write_frame(path("gorge.exr"), part);
  expect_same_bits("gorge.exr",
                   placed("gorge.exr") + Words{"--env", data("environments/sky.exr"), "--env-up",
                                               "y", "--radius", "1.8", "--products", "ao,direct"});
  const Plane<float> ao = channel(path("whole.exr"), "ao.Y");
  EXPECT_LT(std::accumulate(ao.pixels.begin(), ao.pixels.end(), 0.0) / double(ao.size()), 0.55);
}

/// Where the limit is a little more than the frame takes, marches reach all of it.
TEST_F(Bands, OfAllRowsHaveTheSameBitsWithoutARadius) {
  expect_same_bits("in.exr", placed("in.exr"), {"--mem-limit", "148M"});
}

TEST_F(Bands, HaveTheSameBitsForAnyNumberOfThreads) {
  const Words flags = kLimit + Words{"--env", data("environments/sky.exr")};
  ASSERT_EQ(run("in.exr", "one.exr", flags + Words{"--threads", "1"}).code, 0);
  ASSERT_EQ(run("in.exr", "two.exr", flags + Words{"--threads", "2"}).code, 0);
  EXPECT_TRUE(read_file(path("one.exr")) == read_file(path("two.exr")));
}

/// What is far away is looked at in one pixel of 8 x 8, and the camera is fitted to those.
TEST_F(Bands, WithoutARadiusAreNearlyWhatTheFrameIsInOnePiece) {
  make_both("in.exr", {"--env", data("environments/sky.exr"), "--env-up", "z", "--prior", "rules"});
  EXPECT_LT(difference("ao.Y"), 0.01);
  for (const char* c : {"R", "G", "B"}) {
    EXPECT_LT(difference(std::string("direct.") + c), 0.03);
    EXPECT_LT(difference(std::string("bounce.") + c), 0.12);
    EXPECT_LT(difference(c), 0.03);
  }
}

/// The overview tells a learned prior what the frame shows, and its mean light.
TEST_F(Bands, WithAPriorAreNearlyWhatTheFrameIsInOnePiece) {
  make_both("in.exr",
            {"--env", data("environments/sky.exr"), "--env-up", "z", "--prior", "learned",
             "--products", "ao,bent,direct,bounce"},
            {"--mem-limit", "148M"});
  EXPECT_LT(difference("ao.Y"), 0.02);
  for (const char* c : {"R", "G", "B"}) {
    EXPECT_LT(difference(std::string("direct.") + c), 0.04);
    EXPECT_LT(difference(std::string("bounce.") + c), 0.15);
  }
}

TEST_F(Bands, AreCroppedAsTheFrameIs) {
  const Window display{0, 0, 300, 1500}, data{-20, -30, 310, 1570};
  write("overscan.exr", data, display);
  expect_same_bits("overscan.exr", placed("overscan.exr") + Words{"--crop", "--radius", "0.2",
                                                                  "--products", "ao,composite"});
  EXPECT_EQ(ExrReader(path("bands.exr")).parts()[0].data_window, display);
}

TEST_F(Bands, KeepToTheLimit) {
  ASSERT_EQ(
      run("in.exr", "out.exr", kLimit + Words{"--prior", "rules", "--stats", path("stats.json")})
          .code,
      0);
  const nlohmann::json stats = parse_json(read_file(path("stats.json")))[0];
  EXPECT_LT(stats["peak_rss_bytes"], 116 << 20);
  EXPECT_EQ(stats["width"], kWindow.width());
  EXPECT_EQ(stats["height"], kWindow.height());
}

/// Two frames are in memory at a time.
TEST_F(Bands, OfASequenceHaveHalfOfIt) {
  const Window window{0, 0, 320, 1000};
  for (const char* name : {"s.1.exr", "s.2.exr"}) write(name, window, window);
  const auto lines = [&](const Words& flags) {
    return run("s.@.exr", "o.@.exr", flags + Words{"--dry-run", "--mem-limit", "176M"}).err;
  };
  EXPECT_THAT(lines({"--frames", "1-2", "--threads", "2"}), HasSubstr(" bands of "));
  EXPECT_THAT(lines({"--frames", "1-2", "--threads", "1"}), Not(HasSubstr(" bands of ")));
}

TEST_F(Bands, OfAFrameThatIsDescribed) {
  const Finished done = run_tool({"info", path("in.exr"), "--mem-limit", "124M"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.out, AllOf(HasSubstr("in.exr: 320 x 1600"), HasSubstr(" bands of ")));
}

/// What is smaller than a pixel of the overview does not make a frame.
TEST_F(Bands, OfAFrameWithoutSurfacesAreEmpty) {
  FramePart part = frame_of(small_picture(kWindow, kWindow));
  for (auto& [name, values] : part.channels)
    std::fill(values.pixels.begin(), values.pixels.end(), 0.0f);
  for (const char* c : {"X", "Y", "Z"})
    part.channels.at(std::string("ViewLayer.Position.") + c)(97, 97) = 1;
  part.channels.at("ViewLayer.Depth.Z")(97, 97) = 1;
  part.data = part.display = kWindow;
  write_frame(path("empty.exr"), part);
  const Finished done = run("empty.exr", "out.exr", kLimit);
  EXPECT_EQ(done.code, 0) << done.err;
  for (const float ao : channel(path("out.exr"), "ao.Y").pixels) ASSERT_EQ(ao, 1);
}

TEST_F(Bands, RefuseWhatNeedsTheWholeFrame) {
  const auto refused = [&](const Words& flags, const std::string& what) {
    SCOPED_TRACE(what);
    const Finished done = run("in.exr", "no.exr", kLimit + flags);
    EXPECT_EQ(done.code, 2);
    EXPECT_THAT(done.error_line(), AllOf(HasSubstr("in.exr"), HasSubstr(what + " needs all of"),
                                         HasSubstr("--mem-limit")));
    EXPECT_FALSE(std::filesystem::exists(path("no.exr")));
  };
  refused({"--method", "gtao"}, "method gtao");
  refused({"--keep-channels"}, "--keep-channels");
  refused({"--downsample", "2"}, "--downsample");
  refused({"--products", "ao,guessed"}, "the product guessed");
  refused({"--error", "0.1"}, "the error");
  refused({"--save", "ao=" + path("ao.png")}, "ao.png");
  refused({"--also", path("in.exr")}, "--also");
}

TEST_F(Bands, NeedSomeMemory) {
  const Finished done = run("in.exr", "no.exr", {"--mem-limit", "64M"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.error_line(), AllOf(HasSubstr("in.exr: 320 x 1600 pixels take 0.11 GB"),
                                       HasSubstr("raise --mem-limit")));
}

}  // namespace
}  // namespace ssdo::test::bands_test
