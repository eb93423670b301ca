// SPDX-License-Identifier: Apache-2.0
//
// A shot of 48 frames as farms have it: two damaged files, a frame that is missing, one that may
// not be read, one that may not be replaced. Every option of a batch, by a plain user: root may do
// all.
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/terminal.h"

namespace ssdo::test::shot_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::StartsWith;

constexpr int kFirst = 1001, kLast = 1048;

/// What is wrong with the shot, in its order.
constexpr int kCutShort = 1005, kFlipped = 1010, kMissing = 1020, kUnreadable = 1030,
              kProtected = 1035;
constexpr int kDone = 1003;  ///< by an earlier run

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class FarmShot : public testing::Test {
 protected:
  FarmShot() {
    fs::create_directory(dir_ / "in");
    fs::create_directory(dir_ / "out");
    for (int frame = kFirst; frame <= kLast; ++frame) write_input(frame);
    // A plain user must reach the tool, wherever it was built, and may write to out/ alone.
    fs::copy(tool_path(), dir_ / "ssdo");
    fs::permissions(dir_.path(), fs::perms(0755));
    fs::permissions(dir_ / "out", fs::perms(0777));
  }

  std::string in(int frame) const { return numbered("in", frame); }
  std::string out(int frame) const { return numbered("out", frame); }
  std::string stats_file() const { return dir_ / "out/stats.json"; }

  /// A window of 40 x 32 that pans over a picture of 96 x 48.
  void write_input(int frame) const {
    const int x = frame - kFirst;
    write_frame(in(frame), frame_of(small_picture({x, 8, x + 40, 40}, {0, 0, 96, 48})));
  }

  void damage() const {
    fs::resize_file(in(kCutShort), fs::file_size(in(kCutShort)) / 2);
    std::fstream file(in(kFlipped), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(std::streamoff(fs::file_size(in(kFlipped)) / 2)) << "\xff\xff\xff\xff";
    fs::remove(in(kMissing));
    fs::permissions(in(kUnreadable), fs::perms::none);
    std::ofstream(out(kProtected)) << "published";
    fs::permissions(out(kProtected), fs::perms(0444));
  }

  void repair() const {
    for (const int frame : {kCutShort, kFlipped, kMissing, kUnreadable}) {
      fs::remove(in(frame));
      write_input(frame);
    }
    fs::remove(out(kProtected));
  }

  Finished run(const std::vector<std::string>& flags, const Surroundings& around = {}) const {
    std::vector<std::string> words = {dir_ / "in/shot.####.exr", "-o", dir_ / "out/shot.####.exr"};
    words.insert(words.end(), flags.begin(), flags.end());
    return run_as_plain_user(words, around);
  }

  Finished run_as_plain_user(std::vector<std::string> words, Surroundings around = {}) const {
    around.binary = dir_ / "ssdo";
    if (geteuid() == 0) {
      words.insert(words.begin(),
                   {"--reuid=65534", "--regid=65534", "--clear-groups", around.binary});
      around.binary = "/usr/bin/setpriv";
    }
    return run_tool(words, around);
  }

  /// The frames of the statistics, in their order.
  std::vector<int> frames_made() const {
    std::vector<int> frames;
    for (const json& frame : parse_json(read_file(stats_file()))) frames.push_back(frame["frame"]);
    return frames;
  }

  /// Those from `first` to `last` but `without`.
  static std::vector<int> frames(int first, int last, const std::vector<int>& without = {}) {
    std::vector<int> found;
    for (int frame = first; frame <= last; ++frame) {
      if (!testing::Value(without, testing::Contains(frame))) found.push_back(frame);
    }
    return found;
  }

  /// A line for each frame that fails, in their order.
  auto are_the_failures() const {
    return ElementsAre(
        StartsWith("ssdo: " + in(kCutShort) + ": is damaged or cut short (part 0: "),
        StartsWith("ssdo: " + in(kFlipped) + ": is damaged or cut short (part 0: "),
        "ssdo: " + in(kMissing) + ": frame " + std::to_string(kMissing) +
            " of the range is missing; render it or leave it out of --frames",
        "ssdo: " + in(kUnreadable) + ": cannot be opened: Permission denied; check its permissions",
        "ssdo: " + out(kProtected) +
            ": cannot be replaced: Permission denied; change its permissions or name another "
            "output");
  }

  TempDir dir_;

 private:
  std::string numbered(const std::string& folder, int frame) const {
    return dir_ / (folder + "/shot." + std::to_string(frame) + ".exr");
  }
};

/// All options of a batch together, and the same once more for what is left to do.
TEST_F(FarmShot, WhatCanBeDoneIsDoneAndTheRestIsNamed) {
  ASSERT_EQ(run({"--frames", std::to_string(kDone)}).code, 0);
  const std::string before = read_file(out(kDone));
  damage();
  std::ofstream(dir_ / "batch.toml") << "frames = \"1001-1048\"\nskip-existing = true\n"
                                        "on-error = \"continue\"\nprogress = \"tractor\"\n"
                                        "products = [\"ao\", \"composite\"]\nstats = \""
                                     << stats_file() << "\"\n";
  const std::vector<int> bad = {kCutShort, kFlipped, kMissing, kUnreadable, kProtected};
  const Finished first = run({"--config", dir_ / "batch.toml"});
  EXPECT_EQ(first.code, 3) << "that of the first frame that failed";
  EXPECT_THAT(lines_of(first.err), are_the_failures());
  std::vector<int> expected = bad;
  expected.push_back(kDone);
  EXPECT_EQ(frames_made(), frames(kFirst, kLast, expected));
  EXPECT_EQ(lines_of(first.out).back(), "TR_PROGRESS 100%");
  EXPECT_EQ(read_file(out(kProtected)), "published");
  EXPECT_TRUE(read_file(out(kDone)) == before);

  repair();
  const Finished second = run({"--config", dir_ / "batch.toml", "--progress", "none"});
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.out + second.err, "");
  EXPECT_EQ(frames_made(), bad);
  EXPECT_EQ(listing(dir_ / "out").size(), 49u) << "48 frames, their statistics, no temporaries";
}

TEST_F(FarmShot, StopsAtTheFirstFailureUnlessToldOtherwise) {
  damage();
  const Finished forward = run({"--frames", "1001-1048", "--stats", stats_file()});
  EXPECT_EQ(forward.code, 3);
  EXPECT_THAT(forward.error_line(), StartsWith("ssdo: " + in(kCutShort)));
  EXPECT_EQ(frames_made(), frames(kFirst, kCutShort - 1));
  const Finished backward =
      run({"--frames", "1048-1001", "--on-error", "stop", "--overwrite", "--stats", stats_file()});
  EXPECT_EQ(backward.code, 5);
  EXPECT_THAT(backward.error_line(), StartsWith("ssdo: " + out(kProtected)));
  EXPECT_EQ(frames_made().size(), std::size_t(kLast - kProtected));
}

/// Each chunk has the code of its own first failure, and does all others of its frames.
TEST_F(FarmShot, GoesInChunks) {
  damage();
  std::vector<int> codes;
  std::vector<std::string> lines;
  for (int first = kFirst; first <= kLast; first += 8) {
    const std::string chunk = std::to_string(first) + "-" + std::to_string(first + 7);
    const Finished done = run({"--frames", chunk, "--skip-existing", "--on-error", "continue"});
    codes.push_back(done.code);
    for (const std::string& line : lines_of(done.err)) lines.push_back(line);
  }
  EXPECT_THAT(codes, ElementsAre(3, 3, 3, 3, 5, 0));
  EXPECT_THAT(lines, are_the_failures());
  EXPECT_EQ(listing(dir_ / "out").size(), 44u) << "and what was published before";
}

/// Frames that are made with those around them read these from the disk where a chunk ends.
TEST_F(FarmShot, HasTheSameBitsHoweverItIsCut) {
  for (const std::vector<std::string>& with :
       {std::vector<std::string>{"--shot", "2"}, {"--method", "gtao"}}) {
    std::map<int, std::string> whole;
    for (const int size : {48, 5, 1}) {
      SCOPED_TRACE(with[0] + ", chunks of " + std::to_string(size));
      for (int first = kFirst; first <= kLast; first += size) {
        std::vector<std::string> flags = with;
        const int last = std::min(first + size - 1, kLast);
        flags.insert(flags.end(), {"--overwrite", "--threads", size == 5 ? "1" : "2", "--frames",
                                   std::to_string(first) + "-" + std::to_string(last)});
        ASSERT_EQ(run(flags).code, 0);
      }
      for (int frame = kFirst; frame <= kLast; ++frame) {
        const std::string bits = read_file(out(frame));
        EXPECT_TRUE(whole.try_emplace(frame, bits).first->second == bits) << frame;
      }
    }
  }
}

/// A range that runs past the end, as OpenCue's #FRAME_END# does.
TEST_F(FarmShot, FramesPastItsEndAreNamed) {
  const Finished done = run({"--frames", "1047-1050", "--on-error", "continue"});
  EXPECT_EQ(done.code, 3);
  EXPECT_THAT(
      lines_of(done.err),
      ElementsAre(StartsWith("ssdo: " + in(1049) + ": frame 1049 of the range is missing"),
                  StartsWith("ssdo: " + in(1050) + ": frame 1050 of the range is missing")));
  EXPECT_TRUE(fs::exists(out(1047)) && fs::exists(out(1048)));
}

TEST_F(FarmShot, AFolderThatMayNotBeUsedIsNamedForEachFrame) {
  const std::vector<std::string> flags = {"--frames", "1001-1002", "--on-error", "continue"};
  fs::permissions(dir_ / "out", fs::perms(0555));
  const Finished read_only = run(flags);
  EXPECT_EQ(read_only.code, 5);
  EXPECT_THAT(lines_of(read_only.err),
              ElementsAre(StartsWith("ssdo: " + out(1001) + ": its folder"),
                          StartsWith("ssdo: " + out(1002) + ": its folder")));
  fs::permissions(dir_ / "out", fs::perms::none);
  std::vector<std::string> skipping = flags;
  skipping.push_back("--skip-existing");
  const Finished closed = run(skipping);
  EXPECT_EQ(closed.code, 5);
  EXPECT_THAT(lines_of(closed.err),
              ElementsAre(StartsWith("ssdo: " + out(1001) + ": cannot be used"),
                          StartsWith("ssdo: " + out(1002) + ": cannot be used")));
  fs::permissions(dir_ / "out", fs::perms(0777));
  fs::permissions(dir_ / "in", fs::perms::none);
  const Finished unseen = run(flags);
  EXPECT_EQ(unseen.code, 3);
  EXPECT_THAT(lines_of(unseen.err),
              ElementsAre(StartsWith("ssdo: " + in(1001) + ": cannot be opened"),
                          StartsWith("ssdo: " + in(1002) + ": cannot be opened")));
  fs::permissions(dir_ / "in", fs::perms(0755));
}

/// What 48 skipped frames say in a style, with "%" for each percent: they have no steps between.
std::string said_of_skipped(const std::string& before, int digits, const std::string& after) {
  std::string text;
  for (int frame = 1; frame <= 48; ++frame) {
    const std::string percent = std::to_string((100 * frame + 24) / 48);
    const int zeros = std::max(0, digits - int(percent.size()));
    text += before + std::string(std::size_t(zeros), '0') + percent + after + "\n";
  }
  return text;
}

TEST_F(FarmShot, TellsItsProgressInFiveStyles) {
  const std::vector<std::string> flags = {"--frames", "1001-1048", "--skip-existing", "--progress"};
  const auto told = [&](const std::string& style) {
    std::vector<std::string> words = flags;
    words.push_back(style);
    const Finished done = run(words);
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.err, "");
    return done.out;
  };
  static const std::regex line(R"(openjd_progress: (\d+))");
  int last = -1;
  const std::vector<std::string> lines = lines_of(told("openjd"));
  EXPECT_GE(lines.size(), 48u);
  for (const std::string& text : lines) {
    std::smatch found;
    ASSERT_TRUE(std::regex_match(text, found, line)) << text;
    EXPECT_GT(std::stoi(found[1]), last);
    last = std::stoi(found[1]);
  }
  EXPECT_EQ(last, 100);
  EXPECT_EQ(told("tractor"), said_of_skipped("TR_PROGRESS ", 3, "%"));
  EXPECT_EQ(told("alfred"), said_of_skipped("ALF_PROGRESS ", 1, "%"));
  EXPECT_EQ(told("openjd"), said_of_skipped("openjd_progress: ", 1, ""));
  EXPECT_EQ(told("none"), "");
  EXPECT_EQ(told("auto"), "") << "no terminal";
  const Finished seen =
      run_on_terminal({dir_ / "in/shot.####.exr", "-o", dir_ / "out/shot.####.exr", "--frames",
                       "1024,1048", "--skip-existing"});
  EXPECT_EQ(seen.out, "\r\033[K[############             ]  50% " + in(1024) +
                          "\r\033[K[#########################] 100% " + in(1048) + "\r\033[K");
}

TEST_F(FarmShot, WhatAKilledRunHasLeftIsRemovedByTheNext) {
  const auto temporary_exists = [&] {
    const auto names = listing(dir_ / "out");
    return std::any_of(names.begin(), names.end(),
                       [](const std::string& n) { return n.find(".tmp") != std::string::npos; });
  };
  const std::vector<std::string> flags = {"-o", dir_ / "out/shot.####.png", "--frames", "1001-1008",
                                          "--skip-existing"};
  fs::copy(tool_path().parent_path() / "ssdo_images.so", dir_ / "ssdo_images.so");
  EXPECT_EQ(run(flags, {.kill_with = SIGKILL, .kill_when = temporary_exists}).code, 137);
  ASSERT_TRUE(temporary_exists());
  std::vector<std::string> dry = flags;
  dry.push_back("--dry-run");
  EXPECT_EQ(run(dry).code, 0);
  EXPECT_TRUE(temporary_exists()) << "a dry run changes nothing";
  std::vector<std::string> again = flags;
  again.push_back("-v");
  EXPECT_THAT(run(again).err, testing::ContainsRegex(
                                  "\\.tmp\\.(exr|png): removed; the run that wrote it was killed"));
  EXPECT_EQ(listing(dir_ / "out").size(), 16u);
}

}  // namespace
}  // namespace ssdo::test::shot_test
