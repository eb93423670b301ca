// SPDX-License-Identifier: Apache-2.0
//
// Misspelt words of the command line: the message names the word that may be meant, and none where
// none is near.
#include <gmock/gmock.h>

#include <fstream>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::suggestions_test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

class Suggestions : public testing::Test {
 protected:
  Suggestions() { write_frame(in_, frame_of(small_picture())); }

  /// The one line that refuses these words after INPUT and an output.
  std::string refusal(const Words& words, int code = 2) const {
    Words all = {in_, "-o", dir_ / "out.png"};
    all.insert(all.end(), words.begin(), words.end());
    return refusal_of_line(all, code);
  }

  static std::string refusal_of_line(const Words& words, int code = 2) {
    const Finished done = run_tool(words);
    EXPECT_EQ(done.code, code) << done.err;
    EXPECT_EQ(done.out, "");
    return done.error_line();
  }

  const TempDir dir_;
  const std::string in_ = dir_ / "in.exr";
};

TEST_F(Suggestions, OfOptionsNameTheWrongOneAlone) {
  EXPECT_EQ(refusal({"--svae", "3"}),
            "ssdo: --svae: no such option; did you mean --save? see ssdo --help");
  EXPECT_EQ(refusal({"--svae=3"}),
            "ssdo: --svae: no such option; did you mean --save? see ssdo --help");
  EXPECT_EQ(refusal({"--methd", "ssao", "--nonsense"}),
            "ssdo: --methd: no such option; did you mean --method? see ssdo --help");
  EXPECT_EQ(refusal({"-radius", "2"}),
            "ssdo: -radius: no such option; did you mean --radius? see ssdo --help");
  EXPECT_EQ(refusal({"--exposure", "2"}),
            "ssdo: --exposure: no such option; did you mean --env-exposure? see ssdo --help");
  EXPECT_EQ(refusal({"--nonsense"}), "ssdo: --nonsense: no such option; see ssdo --help");
  EXPECT_EQ(refusal({"-x"}), "ssdo: -x: no such option; see ssdo --help");
}

TEST_F(Suggestions, OfOptionsKnowTheCommand) {
  EXPECT_EQ(refusal_of_line({"bench", in_, "--wnat", "3"}),
            "ssdo: --wnat: no such option; did you mean --want? see ssdo bench --help");
  EXPECT_EQ(refusal_of_line({"info", in_, "--raduis", "3"}),
            "ssdo: --raduis: no such option; did you mean --radius? see ssdo info --help");
  EXPECT_EQ(refusal_of_line({"compare", in_, in_, "--msk", in_}),
            "ssdo: --msk: no such option; did you mean --mask? see ssdo compare --help");
  EXPECT_EQ(refusal_of_line({"compare", in_, in_, "--raduis", "3"}),
            "ssdo: --raduis: no such option; see ssdo compare --help")
      << "compare has no --radius";
  EXPECT_EQ(refusal_of_line({"compare", in_, in_, "--radius", "3"}),
            "ssdo: compare takes no --radius; see ssdo compare --help");
  EXPECT_EQ(refusal({"--want", "0.1"}),
            "ssdo: --want: is an option of ssdo bench; see ssdo bench --help");
}

TEST_F(Suggestions, OfCommands) {
  const std::string info = "ssdo: inof: no such command; did you mean ssdo info? see ssdo --help";
  EXPECT_EQ(refusal_of_line({"inof"}), info);
  EXPECT_EQ(refusal_of_line({"inof", in_}), info);
  EXPECT_EQ(refusal_of_line({"inof", in_, "--json"}), info);
  EXPECT_THAT(refusal_of_line({"comprae", in_, in_}), HasSubstr("did you mean ssdo compare?"));
  EXPECT_THAT(refusal_of_line({"shot.exr"}), HasSubstr("shot.exr: no output given"));
  EXPECT_THAT(refusal_of_line({in_, in_}), HasSubstr("in.exr' is not expected after INPUT"));
  EXPECT_THAT(refusal_of_line({"compare", in_, in_, in_}),
              HasSubstr("in.exr' is not expected after A and B; see ssdo compare --help"));
  EXPECT_EQ(run_tool({"inof", "-o", dir_ / "out.exr"}).code, 3) << "the name of a file";
}

TEST_F(Suggestions, OfValues) {
  const std::vector<std::tuple<std::string, std::string, std::string>> wrong = {
      {"--method", "bitmsk", "no such method; did you mean bitmask? there is bitmask, trace"},
      {"--filter", "gausian", "no such filter; did you mean gaussian? there is none, box"},
      {"--filter", "sorce", "did you mean source?"},
      {"--products", "dirct", "'dirct': no such product; did you mean direct? there are ao"},
      {"--save", "bouce=b.exr", "did you mean bounce?"},
      {"--set", "rougness=1", "--set rougness=1: did you mean roughness? method bitmask has"},
      {"--aov", "postion=P", "--aov postion=P: did you mean position? expected ROLE=LAYER"},
      {"--quality", "standart", "--quality standart: did you mean standard? expected one of draft"},
      {"--env-up", "atuo", "did you mean auto?"},
      {"--compression", "zisp:3", "did you mean zips? expected one of none"},
      {"--depth-kind", "plannar", "did you mean planar? expected planar"},
      {"--completions", "bsh", "did you mean bash? expected one of bash, zsh"},
      {"--display", "sRBG",
       "--display sRBG: not in the built-in config; did you mean sRGB? it has"},
      {"--view", "rwa", "did you mean Raw? it has"},
      {"--look", "ACES Gamut Comression", "did you mean ACES Gamut Compression? it has"},
      {"--colorspace", "lin_rec790", "did you mean lin_rec709? it has"},
  };
  for (const auto& [flag, value, says] : wrong)
    EXPECT_THAT(refusal({flag, value}), HasSubstr(says)) << flag;
}

TEST_F(Suggestions, OfProductsThatBenchMeasures) {
  EXPECT_THAT(refusal_of_line({"bench", in_, "--products", "bonce"}),
              HasSubstr("'bonce': did you mean bounce? bench measures ao"));
  EXPECT_THAT(refusal_of_line({"bench", in_, "--want", "bonce=0.1"}),
              HasSubstr("bonce is not measured; did you mean bounce? there is ao"));
}

TEST_F(Suggestions, AreNotMadeWhereNothingIsNear) {
  const std::vector<std::pair<std::string, std::string>> far = {
      {"--method", "magic"},     {"--filter", "median"},    {"--products", "glow"},
      {"--save", "glow=b.exr"},  {"--set", "height=1"},     {"--aov", "zebra=P"},
      {"--quality", "best"},     {"--compression", "lzma"}, {"--depth-kind", "near"},
      {"--display", "P3"},       {"--view", "Filmic"},      {"--look", "Punchy"},
      {"--colorspace", "magic"}, {"--completions", "fish"}};
  for (const auto& [flag, value] : far)
    EXPECT_THAT(refusal({flag, value}), Not(HasSubstr("did you mean"))) << flag;
}

TEST_F(Suggestions, OfLayersAndParts) {
  EXPECT_THAT(refusal({"--aov", "normal=ViewLayer.Nomral"}, 4),
              HasSubstr("did you mean ViewLayer.Normal? the file has"));
  EXPECT_THAT(refusal({"--aov", "normal=Normal"}, 4),
              HasSubstr("did you mean ViewLayer.Normal? the file has"));
  EXPECT_THAT(refusal({"--aov", "normal=Velocity"}, 4), Not(HasSubstr("did you mean")));
  FramePart part = frame_of(small_picture());
  part.name = "utility";
  write_frame(dir_ / "parts.exr", {part});
  EXPECT_THAT(refusal_of_line({dir_ / "parts.exr", "--dry-run", "--part", "utlity"}, 4),
              HasSubstr("no part or view 'utlity'; did you mean utility? the file has"));
  EXPECT_THAT(refusal_of_line({dir_ / "parts.exr", "--dry-run", "--part", "left"}, 4),
              Not(HasSubstr("did you mean")));
  for (const std::string name : {":Nomral", ":ViewLayer.Nomral"}) {
    EXPECT_THAT(refusal_of_line({"compare", in_ + name, in_ + ":Normal"}, 4),
                HasSubstr("did you mean ViewLayer.Normal? there is"));
  }
}

TEST_F(Suggestions, OfKeysOfAConfigFile) {
  std::ofstream(dir_ / "o.toml") << "radus = 3\n";
  EXPECT_THAT(refusal({"--config", dir_ / "o.toml"}),
              HasSubstr("o.toml:1: 'radus' is no option; did you mean radius? keys are"));
  std::ofstream(dir_ / "o.toml") << "hepl = true\n";
  EXPECT_THAT(refusal({"--config", dir_ / "o.toml"}), Not(HasSubstr("did you mean")))
      << "help is no key";
}

}  // namespace
}  // namespace ssdo::test::suggestions_test
