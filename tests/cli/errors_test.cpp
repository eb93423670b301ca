// SPDX-License-Identifier: Apache-2.0
//
// Every way to be refused: the exit code, and one line that names the thing and the way out.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::errors_test {
namespace {

using testing::HasSubstr;

void expect_refused(const std::vector<std::string>& arguments, int code, const std::string& says,
                    const Surroundings& around = {}) {
  const Finished done = run_tool(arguments, around);
  EXPECT_EQ(done.code, code) << testing::PrintToString(arguments) << done.err;
  EXPECT_THAT(done.error_line(), HasSubstr(says)) << testing::PrintToString(arguments);
  EXPECT_THAT(done.error_line(), testing::StartsWith("ssdo: "));
  EXPECT_EQ(done.out, "");
}

TEST(Refusals, OfTheCommandLine) {
  const TempDir dir;
  const std::string in = dir / "in.exr", out = dir / "out.exr";
  write_frame(in, frame_of(small_picture()));
  expect_refused({}, 2, "no INPUT");
  expect_refused({in}, 2, "-o OUTPUT");
  expect_refused({"info"}, 2, "no INPUT");
  expect_refused({in, "-o"}, 2, "ssdo --help");
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{"--nonsense"}, "--nonsense"},
      {{"--radius", "0"}, "--radius"},
      {{"--radius", "-1"}, "--radius"},
      {{"--radius", "nan"}, "--radius"},
      {{"--radius", "wide"}, "--radius"},
      {{"--bounces", "9"}, "--bounces"},
      {{"--bounces", "-1"}, "--bounces"},
      {{"--fov", "180"}, "--fov"},
      {{"--fov", "0"}, "--fov"},
      {{"--ortho", "0"}, "--ortho"},
      {{"--fov", "40", "--ortho", "3"}, "--fov"},
      {{"--env-up", "x"}, "--env-up"},
      {{"--env", "-1,0,0"}, "--env"},
      {{"--env-exposure", "1e9"}, "--env-exposure"},
      {{"--method", "magic"}, "bitmask, trace, ssdo"},
      {{"--method", "ssdo", "--set", "samples"}, "samples, bias"},
      {{"--method", "ssdo", "--set", "samples=0"}, "from 1 to 1024"},
      {{"--method", "ssdo", "--set", "sample=4"}, "samples, bias"},
      {{"--set", "samples=4"}, "--set samples=4"},
      {{"--method", "ssdo", "--radius", "inf"}, "needs a limit"},
      {{"--method", "ssdo", "--slices", "3"}, "--slices"},
      {{"--method", "msvo", "--radius", "0.5"}, "takes no --radius"},
      {{"--method", "ssdo", "--error", "0.1"}, "--error"},
      {{"--method", "ssdo", "--steps", "3"}, "--steps"},
      {{"--method", "ssdo", "--thickness", "inf"}, "--thickness"},
      {{"--method", "ssdo", "--products", "bent"}, "these do: bitmask"},
      {{"--method", "ssdo", "--products", "error"}, "these do: bitmask"},
      {{"--method", "ssdo", "--save", "bent=b.exr"}, "these do: bitmask"},
      {{"--radius", "infinity"}, "--radius"},
      {{"--thickness", "nan"}, "--thickness"},
      {{"--thickness", "-inf"}, "--thickness"},
      {{"--slices", "257"}, "--slices"},
      {{"--slices", "2.5"}, "--slices"},
      {{"--steps", "0"}, "--steps"},
      {{"--thickness", "0"}, "--thickness"},
      {{"--thickness", "thin"}, "--thickness"},
      {{"--offscreen", "shut"}, "--offscreen"},
      {{"--quality", "best"}, "--quality"},
      {{"--slices", "0"}, "--slices"},
      {{"--steps", "257"}, "--steps"},
      {{"--error", "0"}, "--error"},
      {{"--error", "nan"}, "--error"},
      {{"--error", "inf"}, "--error"},
      {{"--fov", "nan"}, "--fov"},
      {{"--ortho", "nan"}, "--ortho"},
      {{"--ortho", "inf"}, "--ortho"},
      {{"--env-rotate", "nan"}, "--env-rotate"},
      {{"--env-exposure", "nan"}, "--env-exposure"},
      {{"--background-depth", "nan"}, "--background-depth"},
      {{"--filter", "blur"}, "depth, geometry, source"},
      {{"--products", "ao,glow"}, "'glow'"},
      {{"--products", "ao,direct", "-o", std::string(dir / "p.png")}, "--save PRODUCT=FILE"},
      {{"--save", "ao"}, "PRODUCT=FILE"},
      {{"--save", "glow=a.exr"}, "'glow'"},
      {{"--aov", "position"}, "ROLE=LAYER"},
      {{"--aov", "height=P"}, "ROLE=LAYER"},
      {{"--depth-kind", "near"}, "--depth-kind"},
      {{"--depth-kind", "normalized:1"}, "--depth-kind"},
      {{"--background-depth", "-3"}, "--background-depth"},
      {{"--pixel-type", "uint"}, "--pixel-type"},
      {{"--compression", "gzip"},
       "--compression gzip: did you mean zip? expected one of none, rle, zips[:1..12]"},
      {{"--compression", "zip:13"}, "--compression zip:13: expected a level from 1 to 12"},
      {{"--compression", "piz:3"}, "--compression piz:3: piz has no levels"},
      {{"--bits", "10"}, "--bits"},
      {{"--threads", "0"}, "--threads"},
      {{"--mem-limit", "8"}, "--mem-limit 8: expected a size such as 8G or 500M"},
      {{"--seed", "-1"}, "--seed"},
      {{"--on-error", "wait"}, "--on-error"},
      {{"--progress", "loud"}, "--progress"},
      {{"--frames", "1-3"}, "pattern"},
      {{"-o", "relit.gif"}, ".exr, .png, .jpg or .tif"},
      {{"-o", out}, "named twice"},
      {{"-o", std::string(dir / "a.####.exr")}, "has none"},
      {{"-o", std::string(dir / "p.png"), "--view", "Sepia"}, "ACES SDR Video"},
  };
  for (const auto& [flags, says] : bad) {
    std::vector<std::string> arguments = {in, "-o", out};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    expect_refused(arguments, 2, says);
  }
  expect_refused({in, "-o", out}, 2, "SSDO_THREADS", {.variables = {{"SSDO_THREADS", "many"}}});
  expect_refused({in, "-o", out}, 2, "$SSDO_MEM_LIMIT is '8'; expected a size such as 8G",
                 {.variables = {{"SSDO_MEM_LIMIT", "8"}}});
  expect_refused({in, "-o", out}, 2, "$SSDO_ISA is 'nonsense'",
                 {.variables = {{"SSDO_ISA", "nonsense"}}});
  EXPECT_THAT(listing(dir.path()), testing::ElementsAre("in.exr"));
}

TEST(Refusals, OfWhatCannotBeRead) {
  const TempDir dir;
  const std::string good = dir / "good.exr", out = dir / "out.exr";
  write_frame(good, frame_of(small_picture()));
  std::ofstream(dir / "text.exr") << "not an image";
  std::ofstream(dir / "empty.exr");
  const std::string bytes = read_file(good);
  std::ofstream(dir / "cut.exr", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  std::ofstream(dir / "text.json") << "{ \"fx\": ";
  std::ofstream(dir / "scale.json")
      << R"({"fx": 100, "world_to_camera": [[2,0,0,0],[0,1,0,0],[0,0,1,0]]})";
  std::ofstream(dir / "text.hdr") << "not a map";
  expect_refused({dir / "none.exr", "-o", out}, 3, "none.exr");
  expect_refused({dir.path(), "-o", out}, 3, "folder");
  for (const char* name : {"text.exr", "empty.exr", "cut.exr"})
    expect_refused({dir / name, "-o", out}, 3, name);
  expect_refused({good, "-o", out, "--env", dir / "none.hdr"}, 3, "none.hdr");
  expect_refused({good, "-o", out, "--env", dir / "text.hdr"}, 3, "text.hdr");
  expect_refused({good, "-o", out, "--camera", dir / "none.json"}, 3, "none.json");
  expect_refused({good, "-o", out, "--camera", dir / "text.json"}, 3, "text.json");
  expect_refused({good, "-o", out, "--camera", dir / "scale.json"}, 3, "rotation");
  expect_refused({good, "-o", dir / "out.png", "--ocio", dir / "none.ocio"}, 3, "none.ocio");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(Refusals, OfMissingAndAmbiguousLayers) {
  const TempDir dir;
  const FramePart part = frame_of(small_picture());
  FramePart two = part;
  for (const auto& [name, plane] : frame_of(small_picture(), "Other.").channels)
    two.channels[name] = plane;
  write_frame(dir / "two.exr", two);
  expect_refused({dir / "two.exr", "-o", dir / "out.exr"}, 4,
                 "'Other.Position', 'ViewLayer.Position'");
  expect_refused({dir / "two.exr", "-o", dir / "out.exr", "--aov", "position=Third"}, 4,
                 "'Other.Position'");
  expect_refused({dir / "two.exr", "-o", dir / "out.exr", "--part", "3"}, 4, "no part or view '3'");

  FramePart none = part;
  std::erase_if(none.channels,
                [](const auto& c) { return !c.first.starts_with("ViewLayer.DiffCol"); });
  write_frame(dir / "none.exr", none);
  expect_refused({dir / "none.exr", "-o", dir / "out.exr"}, 4, "--aov position=LAYER");

  FramePart grey = part;
  std::erase_if(grey.channels,
                [](const auto& c) { return c.first.starts_with("ViewLayer.DiffCol"); });
  write_frame(dir / "grey.exr", grey);
  const std::vector<std::string> fit = {"--method", "gtao", "--set", "multi-bounce=1"};
  for (const std::string products : {"direct", "ao,direct"}) {
    std::vector<std::string> arguments = {dir / "grey.exr", "-o", dir / "out.exr", "--products",
                                          products};
    arguments.insert(arguments.end(), fit.begin(), fit.end());
    expect_refused(arguments, 4, "grey.exr: --set multi-bounce=1 needs a layer for albedo");
  }

  FramePart white = part;
  std::erase_if(white.channels,
                [](const auto& c) { return c.first.starts_with("ViewLayer.DiffCol"); });
  write_frame(dir / "white.exr", white);
  expect_refused({dir / "white.exr", "-o", dir / "out.exr", "--products", "bounce"}, 4,
                 "--aov albedo=LAYER");
  expect_refused({dir / "white.exr", "-o", dir / "out.png"}, 4, "--save PRODUCT=FILE");
  EXPECT_EQ(run_tool({dir / "white.exr", "-o", dir / "out.exr"}).code, 0)
      << "ao and direct need no albedo";
  EXPECT_THAT(channel_names(dir / "out.exr"),
              testing::ElementsAre("ao.Y", "direct.B", "direct.G", "direct.R"));
  EXPECT_EQ(
      run_tool({dir / "white.exr", "-o", dir / "out.exr", "--overwrite", "--products", "all"}).code,
      0)
      << "nor do bent and the error of direct";
  EXPECT_THAT(channel_names(dir / "out.exr"),
              testing::ElementsAre("ao.Y", "bent.X", "bent.Y", "bent.Z", "direct.B", "direct.G",
                                   "direct.R", "error.Y", "guessed.Y", "shadow.B", "shadow.G",
                                   "shadow.R", "unshadowed.B", "unshadowed.G", "unshadowed.R"));
}

/// Issue 20: INPUT was that of `info` or of the main job, whichever came last.
TEST(Refusals, OfWordsTooMany) {
  const TempDir dir;
  const std::string in = dir / "in.exr", other = dir / "other.exr";
  for (const std::string& file : {in, other}) write_frame(file, frame_of(small_picture()));
  for (const std::vector<std::string>& words : {std::vector<std::string>{"info", in, other},
                                                {in, "info", other},
                                                {in, "info", "bench"},
                                                {in, other, "-o", std::string(dir / "out.exr")},
                                                {"bench", in, other},
                                                {"compare", in, in, other}})
    expect_refused(words, 2, "not expected");
  expect_refused({in, "compare", in, in}, 2, "compare takes no INPUT");
  expect_refused({"--radius", "3", "compare", in, in}, 2, "compare takes no --radius");
}

/// Issue 20: what a script's unset variable leaves behind counted as not given.
TEST(Refusals, OfEmptyValues) {
  const TempDir dir;
  const std::string in = dir / "in.exr";
  write_frame(in, frame_of(small_picture()));
  for (const char* option :
       {"--frames", "--part", "--camera", "--env", "--ocio", "--colorspace", "--display", "--view",
        "--look", "--stats", "--config", "--compression", "--products", "--aov", "--save",
        "--motion-scale", "--output"})
    expect_refused({in, "-o", dir / "out.exr", option, ""}, 2, option);
  expect_refused({"compare", in, in, "--mask", ""}, 2, "--mask: its value is empty");
  expect_refused({"", "-o", dir / "out.exr"}, 2, "INPUT: its value is empty");
}

/// Issue 20: a file that is not there was taken for the name of a layer; a colon may stand in one.
TEST(Refusals, OfAMissingFileOfALayer) {
  const TempDir dir;
  const std::string in = dir / "in.exr", out = dir / "out.exr";
  FramePart odd = frame_of(small_picture());
  odd.add("a.exr:P", small_picture().position);
  odd.add("sub:P", small_picture().position);
  write_frame(in, odd);
  std::filesystem::create_directory(dir / "sub");
  expect_refused({in, "-o", out, "--aov", "position=gone.exr:ViewLayer.Position"}, 3,
                 "gone.exr: does not exist");
  expect_refused({in, "-o", out, "--aov", "position=sub/gone:P"}, 3, "sub/gone: does not exist");
  expect_refused({in, "-o", out, "--aov", "position=View:Position"}, 4, "no layer 'View:Position'");
  for (const std::string layer : {"a.exr:P", "sub:P"}) {
    const Finished done = run_tool({in, "-o", out, "--overwrite", "--aov", "position=" + layer},
                                   {.folder = dir.path()});
    EXPECT_EQ(done.code, 0) << done.err;
  }
}

TEST(Refusals, OfAMissingOtherPicture) {
  const TempDir dir;
  const std::string in = dir / "in.exr", gone = dir / "gone.exr";
  write_frame(in, frame_of(small_picture()));
  std::ofstream(dir / "text.exr") << "no picture";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{in, "-o", dir / "out.exr"}, {"bench", in}}) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--also", gone});
    expect_refused(words, 3, "gone.exr: does not exist");
    words.back() = dir / "text.exr";
    expect_refused(words, 3, "text.exr: is not an EXR file");
  }
}

TEST(Help, GoesToStandardOutput) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--help"},
                                                    {"info", "--help"},
                                                    {"--version"},
                                                    {"--list-methods"}}) {
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.err, "");
    EXPECT_GT(done.out.size(), 8u);
  }
  EXPECT_THAT(run_tool({"--list-methods"}).out, HasSubstr("bounce-singularity"));
}

}  // namespace
}  // namespace ssdo::test::errors_test
