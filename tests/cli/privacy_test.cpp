// SPDX-License-Identifier: Apache-2.0
//
// What outputs say about who made them, who may read them, and what names in headers may not do.
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "io/exr/exr_reader.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::privacy_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string host() {
  char name[256] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

std::string text_in_header(const fs::path& path, const std::string& name) {
  return string_attribute(ExrReader(path).parts()[0].header, name);
}

/// A frame in a folder whose name is nobody's business.
class Privacy : public testing::Test {
 protected:
  Privacy() {
    fs::create_directory(dir_ / "folder_of_the_client");
    write_frame(path("in.exr"), frame_of(small_picture()));
  }

  std::string path(const std::string& name) const { return folder_ / name; }

  TempDir dir_;
  const fs::path folder_ = dir_ / "folder_of_the_client";
};

TEST_F(Privacy, OutputsNameNoFolderUserOrHost) {
  write_frame(path("further.exr"), frame_of(small_picture()));
  fs::copy_file(data("environments/studio.exr"), path("map.exr"));
  fs::copy_file(data("color/config.ocio"), path("config.ocio"));
  std::ofstream(path("settings.toml")) << "radius = 0.5\n";
  std::vector<std::string> outputs = {path("out.exr"), path("out.png"), path("out.tif"),
                                      path("out.jpg"), path("ao.exr")};
  const Finished done = run_tool({path("in.exr"),
                                  "-o",
                                  outputs[0],
                                  "-o",
                                  outputs[1],
                                  "-o",
                                  outputs[2],
                                  "-o",
                                  outputs[3],
                                  "--save",
                                  "ao=" + outputs[4],
                                  "--also",
                                  path("further.exr"),
                                  "--env",
                                  path("map.exr"),
                                  "--config",
                                  path("settings.toml"),
                                  "--ocio",
                                  path("config.ocio"),
                                  "--keep-channels",
                                  "--aov",
                                  "albedo=" + path("further.exr") + ":ViewLayer.DiffCol"});
  ASSERT_EQ(done.code, 0) << done.err;
  const std::string difference = path("difference.exr");
  run_tool({"compare", outputs[0] + ":ao", outputs[4] + ":ao", "--diff", difference});
  outputs.push_back(difference);
  const std::string at_host = "@" + host();
  for (const std::string& output : outputs) {
    const std::string bytes = read_file(output);
    for (const std::string& name : {std::string("folder_of_the_client"), at_host,
                                    std::string("map.exr"), std::string("settings.toml")})
      EXPECT_EQ(bytes.find(name), bytes.npos) << output << " holds " << name;
  }
  EXPECT_THAT(text_in_header(outputs[0], "ssdo/plan"), HasSubstr("further.exr: "))
      << "the plan says what the other view adds";
}

TEST_F(Privacy, HistorySaysWhoRanWhat) {
  const std::string first = path("first run.exr"), second = path("second.exr");
  EXPECT_EQ(run_tool({path("in.exr"), "-o", first, "--keep-channels", "--history"}).code, 0);
  const std::string line = text_in_header(first, "ssdo/history");
  EXPECT_THAT(line, HasSubstr("@" + host() + ": " + tool_path().string() + " " + path("in.exr") +
                              " -o '" + first + "' --keep-channels --history"));
  EXPECT_NE(line[0], '@') << "no user";

  EXPECT_EQ(run_tool({first, "-o", second, "--history", "--keep-channels"}).code, 0);
  const std::string lines = text_in_header(second, "ssdo/history");
  EXPECT_THAT(lines, testing::StartsWith(line + "\n")) << "what was there is kept";
  EXPECT_THAT(lines, HasSubstr(" -o " + second));
}

TEST_F(Privacy, HistoryOfPicturesIsIdle) {
  const Finished done = run_tool({path("in.exr"), "-o", path("out.png"), "--history"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, HasSubstr("--history has no effect: no output is an EXR"));
}

TEST_F(Privacy, EveryFileFollowsTheUmask) {
  const mode_t before = umask(027);
  const Finished done =
      run_tool({path("in.exr"), "-o", path("new/out.exr"), "-o", path("new/out.png"), "--save",
                "ao=" + path("new/ao.tif"), "--stats", path("new/stats.json"), "--create-dirs"});
  umask(before);
  ASSERT_EQ(done.code, 0) << done.err;
  const auto mode = [](const fs::path& file) { return unsigned(fs::status(file).permissions()); };
  EXPECT_EQ(mode(path("new")), 0750u);
  for (const std::string& name : listing(path("new")))
    EXPECT_EQ(mode(path("new/" + name)), 0640u) << name;
}

// Parts, views and layers can be named like files anywhere; only the command line names files.
TEST_F(Privacy, NamesInHeadersAreNoPaths) {
  const std::string up = "../outside", there = (dir_ / "there.exr").string();
  std::vector<FramePart> parts;
  for (const std::string& name : {up, there}) {
    FramePart part = frame_of(small_picture(), name + "/ViewLayer.");
    part.name = name;
    part.extra.insert("view", Imf::StringAttribute(parts.empty() ? "left" : up));
    part.extra.insert("name", Imf::StringAttribute(name));
    part.extra.insert("cameraFile", Imf::StringAttribute(there));
    parts.push_back(part);
  }
  write_frame(path("odd.exr"), parts);
  const auto outside = listing(dir_.path());
  const Finished done = run_tool({path("odd.exr"), "--part", up, "-o", path("out.exr"), "--save",
                                  "ao=" + path("ao.png"), "--keep-channels", "--history"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(run_tool({path("odd.exr"), "--stereo", "left", "-o", path("eye_%V.exr")}).code, 0);
  EXPECT_THAT(listing(dir_.path()), testing::ElementsAreArray(outside));
  EXPECT_THAT(listing(folder_), testing::UnorderedElementsAre("in.exr", "odd.exr", "out.exr",
                                                              "ao.png", "eye_left.exr"));
}

}  // namespace
}  // namespace ssdo::test::privacy_test
