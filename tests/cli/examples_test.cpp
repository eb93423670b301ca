// SPDX-License-Identifier: Apache-2.0
//
// The examples of README, man pages and --help are pasted into bash, in a folder with small files
// of the names that they use.
#include <OpenImageIO/imagebuf.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <regex>

#include "support/deep_file.h"
#include "support/examples.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::examples_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Blocks that cannot run here, by how they begin, and why.
const std::map<std::string, std::string> kNotRun = {
    {"data/demo.sh ", "builds the tool"},
    {"blender ", "needs Blender; data/blender has what it makes"},
    {R"(\fBProduct )", "a table"},
    {"env = ", "a config file: ConfigFileOfTheManual"},
    {R"(  { "lights")", "a file of lamps"},
    {R"(  "sphere name=rim)", "the value of --light"},
    {"import re, shlex", "a menu of Nuke"},
};

constexpr int kShrunk = 9;  ///< every ninth pixel in x and y: still lifes of 64 x 36

/// Every ninth pixel of all channels of a file of data/: the frame of the same camera, smaller.
FramePart shrunk(const std::string& name) {
  const std::string file = data(name);
  const ExrReader reader(file);
  const ExrPart& part = reader.parts()[0];
  const auto first = [](int x) { return int(std::ceil(double(x - kShrunk / 2) / kShrunk)); };
  const auto scaled = [&](const Window& w) {
    return Window{first(w.x0), first(w.y0), first(w.x1), first(w.y1)};
  };
  FramePart small{"", scaled(part.data_window), {}, {}, Imf::FLOAT, {}};
  const Window& display = part.display_window;
  small.display = {0, 0, display.x1 / kShrunk, display.y1 / kShrunk};
  for (const ExrChannel& c : part.channels) {
    const Plane<float> all = channel(file, c.name);
    Plane<float>& some = small.channels[c.name] =
        Plane<float>(small.data.width(), small.data.height());
    for (int y = 0; y < some.height; ++y) {
      for (int x = 0; x < some.width; ++x) {
        some(x, y) = all((small.data.x0 + x) * kShrunk + kShrunk / 2 - part.data_window.x0,
                         (small.data.y0 + y) * kShrunk + kShrunk / 2 - part.data_window.y0);
      }
    }
  }
  return small;
}

/// The channels whose names begin with `from`, with `to` in its place.
void take(FramePart& into, const FramePart& of, const std::string& from, const std::string& to) {
  into.data = of.data;
  into.display = of.display;
  for (const auto& [name, plane] : of.channels) {
    if (name.starts_with(from)) into.channels[to + name.substr(from.size())] = plane;
  }
}

FramePart part_of(const FramePart& of,
                  const std::vector<std::pair<std::string, std::string>>& names) {
  FramePart part;
  for (const auto& [from, to] : names) take(part, of, from, to);
  return part;
}

/// A pixel's surface, a unit thick.
DeepPart deep_of(const FramePart& frame) {
  DeepPixels pixels(frame.data);
  const Plane<float>& depth = frame.channels.at("ViewLayer.Depth.Z");
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      if (depth(x, y) < 1e9f)
        pixels.at(x + frame.data.x0, y + frame.data.y0) = {{depth(x, y), depth(x, y) + 1, 1}};
    }
  }
  return {.pixels = pixels, .display = frame.display};
}

/// Files of all the names that the examples read.
class Examples : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempDir>();
    for (const char* name : {"still_life", "room_corner", "room_corner_overscan",
                             "still_life_beauty", "truth/still_life/ao_2"}) {
      const std::string file = std::string("data/") + name + ".exr";
      fs::create_directories((*folder_ / file).parent_path());
      write_frame(*folder_ / file, shrunk(std::string(name) + ".exr"));
    }
    for (const char* name : {"data/objects.exr", "set.exr"})
      fs::copy_file(data("objects.exr"), *folder_ / name);
    fs::copy_file(data("still_life.lights.json"), *folder_ / "data/still_life.lights.json");
    for (const auto& entry : fs::directory_iterator(data("blender/exports")))
      fs::copy_file(entry.path(), *folder_ / entry.path().filename());
    write_maps();
    write_frames();
    write_pictures();
  }

  static void TearDownTestSuite() { folder_.reset(); }

  static void write_maps() {
    fs::create_directory_symlink(data("environments"), *folder_ / "data/environments");
    fs::copy_file(data("environments/sky.exr"), *folder_ / "sky.exr");
    OIIO::ImageBuf(data("environments/studio.exr")).write((*folder_ / "stage.hdr").string());
  }

  /// Frames and sequences, and other views of them.
  static void write_frames() {
    const FramePart room = shrunk("room_corner.exr"), still = shrunk("still_life.exr");
    for (int frame = 1001; frame <= 1012; ++frame) {
      write_frame(*folder_ / ("shot." + std::to_string(frame) + ".exr"), room);
      write_deep(*folder_ / ("shot_deep." + std::to_string(frame) + ".exr"), {deep_of(room)});
      FramePart ao = room;
      const Plane<float> half(room.data.width(), room.data.height(), 0.5f);
      ao.channels = {{"ao.Y", half}};
      write_frame(*folder_ / ("ao." + std::to_string(frame) + ".exr"), ao);
      ao.channels = {{"AO.R", half}, {"AO.G", half}, {"AO.B", half}};
      write_frame(*folder_ / ("truth." + std::to_string(frame) + ".exr"), ao);
    }
    for (const char* name : {"shot_pano.exr", "shot_side.exr"}) write_frame(*folder_ / name, room);
    for (const char* name : {"frame.exr", "wide.exr", "still_life_2x.exr", "lamps.exr"})
      write_frame(*folder_ / name, still);
    FramePart shot = still;
    const FramePart beauty = shrunk("still_life_beauty.exr");
    take(shot, beauty, "", "");
    take(shot, beauty, "Ambient.", "EnvReflection.");
    std::erase_if(shot.channels,
                  [](const auto& c) { return c.first.starts_with("ViewLayer.Comb"); });
    write_frame(*folder_ / "shot.exr", shot);
    write_deep(*folder_ / "shot_deep.exr", {deep_of(still)});
    write_frame(*folder_ / "z.exr", part_of(still, {{"ViewLayer.Depth.Z", "Z"}}));
    write_frame(*folder_ / "data.exr", part_of(still, {{"ViewLayer.Position.", "P."}}));
  }

  /// What is compared.
  static void write_pictures() {
    const FramePart ao = part_of(shrunk("truth/still_life/ao_2.exr"), {{"ViewLayer.AO.", "AO."}});
    const FramePart direct =
        part_of(shrunk("truth/still_life/env_direct.exr"), {{"ViewLayer.", "ViewLayer."}});
    write_frame(*folder_ / "truth.exr", ao);
    write_frame(*folder_ / "relit.exr", part_of(ao, {{"AO.R", "ao.Y"}}));
    for (const char* name : {"cycles.exr", "draft.exr", "final.exr"})
      write_frame(*folder_ / name, direct);
  }

  /// Runs the text in bash, in a folder with the files that it reads.
  static Finished paste(const std::string& text, const TempDir& into) {
    const std::vector<std::string> made = outputs(text);
    for (const auto& entry : fs::directory_iterator(folder_->path())) {
      const std::string name = entry.path().filename();
      if (std::ranges::find(made, name) == made.end())
        fs::create_symlink(entry.path(), into / name);
    }
    const std::string path = tool_path().parent_path().string() + ":" + getenv("PATH");
    return run_tool({"-ec", text},
                    {.variables = {{"PATH", path}}, .binary = "/bin/bash", .folder = into.path()});
  }

  /// The files that the text says are written; of a sequence the first.
  static std::vector<std::string> outputs(const std::string& text) {
    static const std::regex output(
        R"(\s(?:(?:-o|--report|--diff|--stats)\s+|--save\s+\w+=)([\w.#-]+))");
    std::vector<std::string> files;
    for (std::sregex_iterator it(text.begin(), text.end(), output), end; it != end; ++it)
      files.push_back(std::regex_replace((*it)[1].str(), std::regex("####"), "1001"));
    return files;
  }

  static inline std::unique_ptr<TempDir> folder_;
};

TEST_F(Examples, WorkWhenPasted) {
  std::map<std::string, int> left_out, run;
  for (const auto& [document, text] : examples()) {
    SCOPED_TRACE(document + ": " + text);
    const auto reason = std::ranges::find_if(
        kNotRun, [&, &t = text](const auto& row) { return t.starts_with(row.first); });
    if (reason != kNotRun.end()) {
      ++left_out[reason->first];
      continue;
    }
    ++run[document];
    const TempDir folder;
    const Finished done = paste(text, folder);
    EXPECT_EQ(done.code, 0) << done.err;
    // The frame of the examples has no overscan to crop.
    if (text.find("--crop") == text.npos) {
      EXPECT_THAT(done.err, testing::Not(HasSubstr("has no effect")));
    }
    for (const std::string& file : outputs(text)) EXPECT_TRUE(fs::exists(folder / file)) << file;
  }
  for (const auto& [begin, reason] : kNotRun)
    EXPECT_GT(left_out[begin], 0) << "no example begins with " << begin;
  for (const auto& [document, least] : std::map<std::string, int>{{"README.md", 6},
                                                                  {"data/blender/README.md", 3},
                                                                  {"man/ssdo.1", 12},
                                                                  {"man/ssdo-methods.7", 9},
                                                                  {"--help", 1}})
    EXPECT_GE(run[document], least) << document << " is not read as it should be";
}

TEST_F(Examples, ConfigFileOfTheManual) {
  for (const auto& [document, text] : examples()) {
    if (!text.starts_with("env = ")) continue;
    const TempDir folder;
    std::ofstream(folder / "look.toml") << text;
    const Finished done = paste("ssdo shot.exr -o out.exr --config look.toml", folder);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_TRUE(fs::exists(folder / "out.exr"));
    return;
  }
  FAIL() << "no example of a config file";
}

}  // namespace
}  // namespace ssdo::test::examples_test
