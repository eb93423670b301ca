// SPDX-License-Identifier: Apache-2.0
//
// `ssdo info` lists what a file holds, whatever fails after.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::info_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class InfoListing : public testing::Test {
 protected:
  InfoListing() {
    write_frame(path("in.exr"), frame_of(small_picture()));
    FramePart none = frame_of(small_picture());
    std::erase_if(none.channels,
                  [](const auto& c) { return !c.first.starts_with("ViewLayer.DiffCol"); });
    write_frame(path("none.exr"), none);
    FramePart two = frame_of(small_picture());
    for (const auto& [name, plane] : frame_of(small_picture(), "Other.").channels)
      two.channels[name] = plane;
    write_frame(path("two.exr"), two);
    const Window window{0, 0, 64, 48};
    const Camera camera = look_at(camera_from_fov(40, window, 1), {0, -4, 3}, {0, 0, 0}, {0, 0, 1});
    write_frame(path("flat.exr"), frame_of(take_picture(plane({}, {0, 0, 1}), camera, window)));
    Imf::Header deep = test_header({{0, 0}, {3, 3}}, {{"Z"}, {"A"}}, Imf::ZIPS_COMPRESSION);
    deep.setType(Imf::DEEPSCANLINE);
    deep.setName("main");
    write_test_exr(path("deep.exr"), {deep});
    const std::string bytes = read_file(path("in.exr"));
    std::ofstream(path("cut.exr"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  }
  std::string path(const std::string& name) const { return dir_ / name; }

  struct Failure {
    std::vector<std::string> words;  ///< file and flags
    int code;
    std::string part, error;
  };
  std::vector<Failure> failures() const {
    return {{{path("none.exr")}, 4, "ViewLayer.DiffCol", "no layer for position"},
            {{path("two.exr")}, 4, "Other.Position", "2 layers could be position"},
            {{path("flat.exr")}, 4, "ViewLayer.Position", "--fov DEGREES"},
            {{path("deep.exr")}, 4, "deep scanlines", "seems to be normalised"},
            {{path("cut.exr")}, 3, "ViewLayer.Position", "cut short"},
            {{path("in.exr"), "--part", "7"}, 4, "ViewLayer.Position", "no part or view"},
            {{path("in.exr"), "--aov", "normal=Up"}, 4, "ViewLayer.Normal", "no layer 'Up'"},
            {{path("in.exr"), "--env", path("no.hdr")}, 3, "ViewLayer.Position", "no.hdr"},
            {{path("in.exr"), "--also", path("no.exr")}, 3, "ViewLayer.Position", "no.exr"},
            {{path("in.exr"), "--camera", path("no.json")}, 3, "ViewLayer.Position", "no.json"}};
  }
  TempDir dir_;
};

// Issue 12, number 16.
TEST_F(InfoListing, ComesBeforeWhateverFails) {
  for (const Failure& failure : failures()) {
    SCOPED_TRACE(testing::PrintToString(failure.words));
    std::vector<std::string> words = failure.words;
    words.insert(words.begin(), "info");
    const Finished done = run_tool(words);
    EXPECT_EQ(done.code, failure.code);
    EXPECT_THAT(done.out, AllOf(HasSubstr(failure.part), HasSubstr("part 0"),
                                HasSubstr("display window 0,0 to")));
    EXPECT_THAT(done.error_line(), HasSubstr(failure.error));
    EXPECT_THAT(done.err, Not(HasSubstr("ssdo info"))) << "it has listed the layers";
  }
  EXPECT_THAT(run_tool({path("none.exr"), "-o", path("out.exr")}).error_line(),
              HasSubstr("'ssdo info' lists the layers"));
}

// Issue 12, number 16.
TEST_F(InfoListing, IsValidJsonWithTheError) {
  for (const Failure& failure : failures()) {
    SCOPED_TRACE(testing::PrintToString(failure.words));
    std::vector<std::string> words = failure.words;
    words.insert(words.begin(), "info");
    words.push_back("--json");
    const Finished done = run_tool(words);
    EXPECT_EQ(done.code, failure.code);
    const json found = parse_json(done.out);
    EXPECT_EQ(found["file"], failure.words[0]);
    EXPECT_EQ(found["parts"].size(), 1u);
    EXPECT_EQ(found["parts"][0]["deep"], failure.part == "deep scanlines");
    EXPECT_EQ(found["error"]["code"], failure.code);
    EXPECT_EQ("ssdo: " + found["error"]["message"].get<std::string>(), done.error_line());
  }
  const json missing = parse_json(run_tool({"info", path("gone.exr"), "--json"}).out);
  EXPECT_EQ(missing["parts"], json::array());
  EXPECT_EQ(missing["error"]["code"], 3);
  EXPECT_FALSE(parse_json(run_tool({"info", path("in.exr"), "--json"}).out).contains("error"));
}

TEST_F(InfoListing, OfASequenceHasAnEntryForEveryFrame) {
  std::filesystem::copy_file(path("in.exr"), path("shot.1.exr"));
  std::filesystem::copy_file(path("none.exr"), path("shot.2.exr"));
  std::filesystem::copy_file(path("in.exr"), path("shot.3.exr"));
  const Finished done = run_tool({"info", path("shot.@.exr"), "--json", "--on-error", "continue"});
  EXPECT_EQ(done.code, 4);
  const json frames = parse_json(done.out);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_TRUE(frames[0].contains("plan") && frames[2].contains("plan"));
  EXPECT_EQ(frames[1]["error"]["code"], 4);
  EXPECT_EQ(frames[1]["parts"][0]["channels"].size(), 3u);
}

/// Windows, views, types and kinds of parts; a line for each layer.
TEST_F(InfoListing, SaysWhatAPartIs) {
  const Imath::Box2i display({0, 0}, {63, 47}), data({-8, 2}, {20, 30});
  const auto part = [&](const std::string& name, const std::vector<TestChannel>& channels) {
    Imf::Header header = named(test_header(data, channels), name);
    header.displayWindow() = display;
    return header;
  };
  Imf::Header beauty = part("rgba.left", {{"R", Imf::HALF},
                                          {"G", Imf::HALF},
                                          {"B", Imf::HALF},
                                          {"A", Imf::FLOAT},
                                          {"id.Y", Imf::UINT}});
  beauty.setView("left");
  Imf::Header deep = part("deep", {{"Z"}, {"A"}});
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.setType(Imf::DEEPSCANLINE);
  write_test_exr(path("parts.exr"),
                 {beauty, tiled(part("P", {{"P.X"}, {"P.Y"}, {"P.Z"}}), 16), deep});
  const std::string out = run_tool({"info", path("parts.exr")}).out;
  for (const char* text :
       {"parts.exr: 3 parts, 10 channels\n",
        "part 0 'rgba.left', view 'left': scanlines, display window 0,0 to 63,47, data window "
        "-8,2 to 20,30\n",
        "R G B half, A float\n", "id  ", "Y uint\n", "part 1 'P': tiles, ", "X Y Z float\n",
        "part 2 'deep': deep scanlines, "}) {
    EXPECT_THAT(out, HasSubstr(text));
  }
}

TEST_F(InfoListing, IsALineForEachOfAHundredLayers) {
  FramePart part = frame_of(small_picture());
  for (int i = 0; i < 100; ++i)
    part.add("light_" + std::to_string(i), Plane<glm::vec3>(64, 48), "RGB");
  write_frame(path("many.exr"), part);
  const std::string out = run_tool({"info", path("many.exr")}).out;
  EXPECT_LT(std::count(out.begin(), out.end(), '\n'), 125);
  EXPECT_THAT(out, HasSubstr("light_99"));
}

TEST_F(InfoListing, ListsTheFilesOfAovsToo) {
  const std::string aov = "albedo=" + path("none.exr") + ":ViewLayer.DiffCol";
  const Finished done = run_tool({"info", path("in.exr"), "--aov", aov});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr(path("none.exr") + ": 1 part, 3 channels"));
  const json found = parse_json(run_tool({"info", path("in.exr"), "--aov", aov, "--json"}).out);
  EXPECT_EQ(found["other_files"][0]["file"], path("none.exr"));
  EXPECT_EQ(found["other_files"][0]["parts"][0]["channels"].size(), 3u);
}

// Issue 12, number 20: control characters of names are never printed raw.
TEST_F(InfoListing, NamesAreSafeToPrint) {
  const std::string odd = "\033]0;owned\a\x9b\n";
  FramePart part = frame_of(small_picture());
  part.add("a" + odd + "Position", small_picture().position);
  part.add("albedo" + odd, small_picture().position, "RGB");
  write_frame(path("odd.exr"), part);
  std::filesystem::copy_file(path("odd.exr"), path("odd" + odd + ".exr"));
  const auto expect_safe = [](const std::string& text) {
    EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](unsigned char c) {
      return c == '\n' || (c >= 0x20 && c < 0x7f);
    })) << text;
  };
  const std::string out = path("out.exr"), other = path("odd" + odd + ".exr");
  const std::vector<std::vector<std::string>> commands = {
      {"info", path("odd.exr")},
      {"info", other},
      {path("odd.exr"), "-v", "-o", out, "--aov", "albedo=albedo" + odd},
      {other, "--dry-run", "--aov", "normal=Up" + odd},
      {other, "-o", path("gone" + odd + "/out.exr")},
      {"compare", path("odd.exr"), path("odd.exr")},
      {"compare", path("odd.exr"), path("odd.exr") + ":none" + odd},
      {other, "-o", out, "--method", odd},
      {odd}};
  for (const auto& words : commands) {
    const Finished done = run_tool(words);
    expect_safe(done.out);
    expect_safe(done.err);
    const auto lines = std::count(done.err.begin(), done.err.end(), '\n');
    EXPECT_TRUE(done.code == 0 || lines == 1) << done.err;
  }
  const Finished found = run_tool({"info", other, "--json"});
  EXPECT_EQ(found.out.find('\033'), std::string::npos) << found.out;
  EXPECT_EQ(parse_json(found.out)["parts"].size(), 1u) << "JSON for all that";
  EXPECT_THAT(run_tool({"info", path("odd.exr")}).out,
              HasSubstr("albedo\\x1b]0;owned\\x07\\x9b\\x0a"));
}

// Issue 12, number 20: rebuilt and turned normals.
TEST_F(InfoListing, MentionsRebuiltNormals) {
  const Picture picture = small_picture();
  FramePart part = frame_of(picture);
  const auto normal_line = [&] {
    write_frame(path("normals.exr"), part);
    const std::string out = run_tool({"info", path("normals.exr")}).out;
    const auto start = out.find("\n  normal ");
    return start == std::string::npos
               ? "none"
               : out.substr(start + 1, out.find('\n', start + 1) - start - 1);
  };
  EXPECT_THAT(normal_line(), AllOf(Not(HasSubstr("rebuilt")), Not(HasSubstr("turned"))));
  const std::size_t row = 40 * 64;
  for (std::size_t i = row; i < row + 10; ++i) {
    for (const char* c : {"X", "Y", "Z"}) {
      part.channels[std::string("ViewLayer.Normal.") + c][i] = NAN;
      part.channels[std::string("ViewLayer.Normal.") + c][i + 20] *= -1;
    }
  }
  EXPECT_THAT(normal_line(), AllOf(HasSubstr("10 rebuilt from P"), HasSubstr("10 turned")));
  std::erase_if(part.channels,
                [](const auto& c) { return c.first.starts_with("ViewLayer.Normal"); });
  EXPECT_THAT(normal_line(), HasSubstr("no layer; rebuilt from P"));
}

}  // namespace
}  // namespace ssdo::test::info_test
