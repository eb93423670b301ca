// SPDX-License-Identifier: Apache-2.0
//
// What the command line sets and refuses, on parse_options() itself.
#include "cli/parse_options.h"

#include <gmock/gmock.h>

#include <cmath>
#include <regex>

namespace ssdo::test::options_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ParsedOptions parse_words(std::vector<std::string> words) {
  words.insert(words.begin(), "ssdo");
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  return parse_options(int(argv.size()), argv.data());
}

/// The main job, from in.exr to out.exr.
Options parse(std::vector<std::string> words) {
  words.insert(words.begin(), {"in.exr", "-o", "out.exr"});
  return parse_words(words).options;
}

/// Why the words are refused; "" where they are not.
std::string refusal(const std::vector<std::string>& words) {
  try {
    parse(words);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::usage);
    return error.what();
  }
}

/// Without the breaks of long lines.
std::string help() {
  static const std::regex breaks("\n {20,}");
  return std::regex_replace(parse_words({"--help-all"}).print.value_or(""), breaks, " ");
}

/// Every name sets its value; another is refused with a list of the names, which the help has too.
template <class T, class Field>
void expect_choices(const std::string& flag, const std::vector<std::pair<std::string, T>>& choices,
                    const Field& field) {
  const std::string message = refusal({flag, "nonsense"});
  EXPECT_THAT(message, HasSubstr(flag + " nonsense"));
  std::string names;
  for (const auto& [name, value] : choices) {
    EXPECT_EQ(field(parse({flag, name})), value) << flag << ' ' << name;
    EXPECT_THAT(message, HasSubstr(name));
    names += (names.empty() ? "" : ",") + name;
  }
  EXPECT_THAT(help(), HasSubstr(flag + " {" + names + "}"));
}

TEST(Options, OfCompressionMayHaveALevel) {
  std::string forms;
  for (const auto& [name, compression, most] :
       {std::tuple<std::string, Imf::Compression, int>{"none", Imf::NO_COMPRESSION, 0},
        {"rle", Imf::RLE_COMPRESSION, 0},
        {"zips", Imf::ZIPS_COMPRESSION, 12},
        {"zip", Imf::ZIP_COMPRESSION, 12},
        {"piz", Imf::PIZ_COMPRESSION, 0},
        {"pxr24", Imf::PXR24_COMPRESSION, 0},
        {"b44", Imf::B44_COMPRESSION, 0},
        {"b44a", Imf::B44A_COMPRESSION, 0},
        {"dwaa", Imf::DWAA_COMPRESSION, 100000},
        {"dwab", Imf::DWAB_COMPRESSION, 100000}}) {
    forms += (forms.empty() ? "" : ", ") + name;
    if (most > 0) forms += "[:1.." + std::to_string(most) + "]";
    EXPECT_EQ(parse({"--compression", name}).output.compression, compression);
    EXPECT_EQ(parse({"--compression", name}).output.compression_level, std::nullopt);
    for (const int level : {1, most}) {
      if (most == 0) continue;
      const OutputOptions o = parse({"--compression", name + ":" + std::to_string(level)}).output;
      EXPECT_EQ(o.compression, compression);
      EXPECT_EQ(o.compression_level, level);
    }
    for (const std::string& level :
         std::vector<std::string>{"0", std::to_string(most + 1), "x", "", "-1", "1.5", "4 "})
      EXPECT_THAT(refusal({"--compression", name + ":" + level}),
                  HasSubstr(most > 0 ? "a level from 1 to " + std::to_string(most)
                                     : name + " has no levels"));
  }
  EXPECT_THAT(refusal({"--compression", "gzip"}), HasSubstr("expected one of " + forms));
}

TEST(Options, OfNamesTakeEachNameAndNoOther) {
  using Up = std::optional<UpAxis>;
  expect_choices<Up>("--env-up", {{"auto", std::nullopt}, {"y", UpAxis::y}, {"z", UpAxis::z}},
                     [](const Options& o) { return o.light.up; });
  expect_choices<bool>("--offscreen", {{"extend", true}, {"open", false}},
                       [](const Options& o) { return o.model.extend_offscreen; });
  using Given = std::optional<Prior>;
  expect_choices<Given>("--prior", {{"rules", Prior::rules}, {"learned", Prior::learned}},
                        [](const Options& o) { return o.model.prior; });
  expect_choices<Quality>(
      "--quality",
      {{"draft", Quality::draft}, {"standard", Quality::standard}, {"final", Quality::final}},
      [](const Options& o) { return o.model.quality; });
  expect_choices<Imf::PixelType>("--pixel-type", {{"half", Imf::HALF}, {"float", Imf::FLOAT}},
                                 [](const Options& o) { return o.output.pixel_type; });
  expect_choices<int>("--bits", {{"8", 8}, {"16", 16}},
                      [](const Options& o) { return o.output.bits; });
  expect_choices<OnError>("--on-error",
                          {{"stop", OnError::stop}, {"continue", OnError::keep_going}},
                          [](const Options& o) { return o.batch.on_error; });
  expect_choices<ProgressStyle>("--progress",
                                {{"auto", ProgressStyle::automatic},
                                 {"none", ProgressStyle::none},
                                 {"tractor", ProgressStyle::tractor},
                                 {"alfred", ProgressStyle::alfred},
                                 {"openjd", ProgressStyle::openjd}},
                                [](const Options& o) { return o.batch.progress; });
}

TEST(Options, OfNamesAreGivenOnce) {
  EXPECT_THAT(refusal({"--bits", "8", "--bits", "16"}), HasSubstr("--bits"));
}

TEST(Options, OfDepthNameAKindOrItsRange) {
  const auto depth = [](const std::string& text) {
    return parse({"--depth-kind", text}).input.gbuffer;
  };
  EXPECT_EQ(depth("planar").depth_kind, DepthKind::planar);
  EXPECT_EQ(depth("ray").depth_kind, DepthKind::ray);
  EXPECT_EQ(depth("inverse").depth_kind, DepthKind::inverse);
  EXPECT_EQ(depth("normalized:2,20").depth_kind, DepthKind::normalized);
  EXPECT_EQ(depth("normalized:2,20").depth_near, 2);
  EXPECT_EQ(depth("normalized:2,20").depth_far, 20);
  for (const std::string text : {"near", "normalized", "normalized:", "normalized:2",
                                 "normalized:2,2", "normalized:2,x", "2,20", "planar:2,20"}) {
    EXPECT_THAT(refusal({"--depth-kind", text}),
                HasSubstr("expected planar, ray, inverse or normalized:NEAR,FAR"))
        << text;
  }
}

TEST(Options, OfNeighboursTakeWholeNumbersFromOneOn) {
  const auto shot = [](const std::string& text) {
    const ShotWindow found = parse({"--shot", text}).model.shot;
    return std::pair(found.count, found.step);
  };
  EXPECT_EQ(parse({}).model.shot.count, 0);
  EXPECT_EQ(shot("2"), std::pair(2, 1));
  EXPECT_EQ(shot("4x2"), std::pair(4, 2));
  for (const std::string text : {"0", "-1", "x2", "2x", "2x0", "2x-1", "1x2x3", "2.5", "a", "2 ",
                                 "+2", "101", "99999999999", "2x99999999999"}) {
    EXPECT_THAT(refusal({"--shot", text}), HasSubstr("--shot " + text + ": expected K or KxSTEP"));
  }
}

TEST(Options, LandInTheirFields) {
  const Options o = parse({"--aov",
                           "position=P",
                           "--aov",
                           "depth=Z",
                           "--part",
                           "beauty",
                           "--motion-scale",
                           "-1,2",
                           "--background-depth",
                           "99",
                           "--fov",
                           "40",
                           "--env",
                           "0.5",
                           "--env-rotate",
                           "30",
                           "--env-exposure",
                           "-2",
                           "--method",
                           "ssao",
                           "--radius",
                           "inf",
                           "--thickness",
                           "0.25",
                           "--slices",
                           "3",
                           "--steps",
                           "7",
                           "--error",
                           "0.01",
                           "--bounces",
                           "4",
                           "--seed",
                           "9",
                           "--set",
                           "samples=8",
                           "--set",
                           "turns=3",
                           "--filter",
                           "box",
                           "--temporal",
                           "-o",
                           "b.png",
                           "--products",
                           "ao,bent",
                           "--save",
                           "ao=ao.exr",
                           "--keep-channels",
                           "--overwrite",
                           "--create-dirs",
                           "--ocio",
                           "c.ocio",
                           "--colorspace",
                           "lin",
                           "--display",
                           "d",
                           "--view",
                           "v",
                           "--look",
                           "l",
                           "--frames",
                           "1-5x2",
                           "--skip-existing",
                           "--threads",
                           "3",
                           "--mem-limit",
                           "1.5GiB",
                           "-v",
                           "--dry-run",
                           "--stats",
                           "s.json"});
  EXPECT_EQ(o.command, Command::relight);
  EXPECT_EQ(o.input_file, "in.exr");
  ASSERT_EQ(o.input.aovs.size(), 2u);
  EXPECT_EQ(o.input.aovs[0].layer, "P");
  EXPECT_EQ(o.input.aovs[1].role, Role::depth);
  EXPECT_EQ(o.input.aovs[1].layer, "Z");
  EXPECT_EQ(o.input.part, "beauty");
  EXPECT_EQ(o.input.gbuffer.motion_scale, glm::vec2(-1, 2));
  EXPECT_EQ(o.input.gbuffer.background_depth, 99);
  EXPECT_EQ(o.camera.fov, 40);
  EXPECT_EQ(o.light.env, "0.5");
  EXPECT_EQ(o.light.rotate_degrees, 30);
  EXPECT_EQ(o.light.exposure_stops, -2);
  EXPECT_EQ(o.model.method, "ssao");
  EXPECT_EQ(o.model.radius, HUGE_VAL);
  EXPECT_EQ(o.model.thickness, 0.25);
  EXPECT_EQ(o.model.slices, 3);
  EXPECT_EQ(o.model.steps, 7);
  EXPECT_EQ(o.model.error, 0.01);
  EXPECT_EQ(o.model.bounces, 4);
  EXPECT_EQ(o.model.seed, 9u);
  EXPECT_THAT(o.model.set, ElementsAre("samples=8", "turns=3"));
  EXPECT_EQ(o.model.filter, "box");
  EXPECT_TRUE(o.model.temporal);
  EXPECT_THAT(o.output.files, ElementsAre("out.exr", "b.png"));
  EXPECT_THAT(o.output.products, ElementsAre("ao", "bent"));
  ASSERT_EQ(o.output.saves.size(), 1u);
  EXPECT_EQ(o.output.saves[0].product, "ao");
  EXPECT_EQ(o.output.saves[0].path, "ao.exr");
  EXPECT_TRUE(o.output.keep_channels && o.output.policy.overwrite && o.output.policy.create_dirs);
  EXPECT_EQ(o.color.ocio + o.color.colorspace + o.color.display + o.color.view + o.color.look,
            "c.ocio"
            "lin"
            "d"
            "v"
            "l");
  EXPECT_THAT(o.batch.frames.value(), ElementsAre(1, 3, 5));
  EXPECT_TRUE(o.batch.skip_existing);
  EXPECT_EQ(o.threads, 3);
  EXPECT_EQ(o.mem_limit, 3u << 29);
  EXPECT_TRUE(o.verbosity.verbose && o.verbosity.dry_run && !o.verbosity.quiet);
  EXPECT_EQ(o.verbosity.stats, "s.json");
}

TEST(Options, NotGivenKeepTheirDefaults) {
  const Options o = parse({});
  EXPECT_EQ(o.threads, std::nullopt);
  EXPECT_EQ(o.mem_limit, std::nullopt);
  EXPECT_EQ(o.model.radius, std::nullopt);
  EXPECT_EQ(o.model.method, ModelOptions().method);
  EXPECT_EQ(o.output.compression, std::nullopt);
  EXPECT_EQ(o.output.bits, 8);
  EXPECT_EQ(o.batch.frames, std::nullopt);
  EXPECT_THAT(o.warnings, ElementsAre());
}

TEST(Options, ChooseTheCommand) {
  EXPECT_EQ(parse_words({"info", "in.exr", "--json"}).options.command, Command::info);
  EXPECT_EQ(parse_words({"--list-methods"}).options.command, Command::list_methods);
  const Options compare = parse_words({"compare", "a", "b", "--fail-above", "0.1"}).options;
  EXPECT_EQ(compare.command, Command::compare);
  EXPECT_EQ(compare.compare.b, "b");
  EXPECT_EQ(compare.compare.fail_above, 0.1);
  const Options shot =
      parse_words({"compare", "a", "--points", "g", "--camera", "c", "--frames", "7-5"}).options;
  EXPECT_EQ(shot.compare.b, "");
  EXPECT_EQ(shot.compare.points, "g");
  EXPECT_EQ(shot.compare.camera, "c");
  EXPECT_THAT(*shot.compare.frames, ElementsAre(7, 6, 5));
  EXPECT_EQ(shot.batch.frames, std::nullopt) << "those of the main job";
}

TEST(Options, OfTheBenchAreKeptForItsCommands) {
  const Options o =
      parse_words({"bench", "in.exr", "--env", "0.5", "--want", "0.05", "--want", "bounce=0.1",
                   "--methods", "ssao,gtao", "--set", "samples=8", "--threads", "2"})
          .options;
  EXPECT_EQ(o.command, Command::bench);
  ASSERT_EQ(o.bench.wants.size(), 2u);
  EXPECT_EQ(o.bench.wants[0].product, "");
  EXPECT_EQ(o.bench.wants[1].product, "bounce");
  EXPECT_EQ(o.bench.wants[1].error, 0.1);
  EXPECT_THAT(o.bench.methods, ElementsAre("ssao", "gtao"));
  EXPECT_THAT(o.bench.carried, testing::UnorderedElementsAre(ElementsAre("--env", "0.5"),
                                                             ElementsAre("--set", "samples=8")));
}

TEST(Options, AreNamedInTheUsageLine) {
  EXPECT_THAT(help(), HasSubstr("ssdo [OPTIONS] [INPUT] [SUBCOMMAND]\n"));
}

}  // namespace
}  // namespace ssdo::test::options_test
