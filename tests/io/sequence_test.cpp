// SPDX-License-Identifier: Apache-2.0
#include "io/sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <climits>
#include <filesystem>
#include <fstream>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::sequence_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

struct FrameList {
  std::string text;
  std::vector<int> frames;
};

void PrintTo(const FrameList& list, std::ostream* out) { *out << "'" << list.text << "'"; }

class Frames : public testing::TestWithParam<FrameList> {};

TEST_P(Frames, AreReadInOrder) { EXPECT_EQ(parse_frames(GetParam().text), GetParam().frames); }

INSTANTIATE_TEST_SUITE_P(
    Ranges, Frames,
    testing::Values(FrameList{"7", {7}}, FrameList{"-7", {-7}}, FrameList{"007", {7}},
                    FrameList{"1-3", {1, 2, 3}}, FrameList{"4-4", {4}},
                    FrameList{"-5--1", {-5, -4, -3, -2, -1}}, FrameList{"-1-1", {-1, 0, 1}},
                    FrameList{"1--1", {1, 0, -1}}, FrameList{"-1--3", {-1, -2, -3}},
                    FrameList{"10-1", {10, 9, 8, 7, 6, 5, 4, 3, 2, 1}}));

INSTANTIATE_TEST_SUITE_P(
    Steps, Frames,
    testing::Values(FrameList{"1-10x3", {1, 4, 7, 10}}, FrameList{"1-10:3", {1, 4, 7, 10}},
                    FrameList{"1-9x3", {1, 4, 7}}, FrameList{"1-3x100", {1}},
                    FrameList{"10-1x3", {10, 7, 4, 1}}, FrameList{"10-1:4", {10, 6, 2}},
                    FrameList{"10-1x-2", {10, 8, 6, 4, 2}}, FrameList{"4-4x-1", {4}},
                    FrameList{"-9--1x4", {-9, -5, -1}}));

INSTANTIATE_TEST_SUITE_P(
    Lists, Frames,
    testing::Values(FrameList{"1-3,5,7-20:4", {1, 2, 3, 5, 7, 11, 15, 19}},
                    FrameList{"1001-1003,1020-1030x5", {1001, 1002, 1003, 1020, 1025, 1030}},
                    FrameList{"1-3 7", {1, 2, 3, 7}}, FrameList{"1-2 -5--4", {1, 2, -5, -4}},
                    FrameList{"3,1,2", {3, 1, 2}}, FrameList{"7 9", {7, 9}},
                    FrameList{"1 , 2 3", {1, 2, 3}}, FrameList{"1\n2\n3\n", {1, 2, 3}}));

INSTANTIATE_TEST_SUITE_P(Spaces, Frames,
                         testing::Values(FrameList{"1 - 3 , 5", {1, 2, 3, 5}},
                                         FrameList{" 1 ,2 ", {1, 2}}, FrameList{"1- 3", {1, 2, 3}},
                                         FrameList{"1 - 5 x 2 9", {1, 3, 5, 9}},
                                         FrameList{"1\t-\t2", {1, 2}},
                                         FrameList{"-3 - -1", {-3, -2, -1}}));

INSTANTIATE_TEST_SUITE_P(Repeats, Frames,
                         testing::Values(FrameList{"1-3,2-5", {1, 2, 3, 4, 5}},
                                         FrameList{"5,1-6", {5, 1, 2, 3, 4, 6}},
                                         FrameList{"3-1,1-3", {3, 2, 1}}, FrameList{"2,2,2", {2}}));

INSTANTIATE_TEST_SUITE_P(
    EndsOfInt, Frames,
    testing::Values(FrameList{"2147483646-2147483647", {INT_MAX - 1, INT_MAX}},
                    FrameList{"-2147483648--2147483647", {INT_MIN, INT_MIN + 1}},
                    FrameList{"-2147483648-2147483647x2147483647", {INT_MIN, -1, INT_MAX - 1}},
                    FrameList{"1--2147483648x-2147483648", {1, -INT_MAX}}));

struct Refusal {
  std::string text, reason;
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << "'" << refusal.text << "'"; }

class RefusedFrames : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedFrames, AreAUsageErrorThatNamesTheReason) {
  EXPECT_THAT(error_of([] { parse_frames(GetParam().text); }),
              IsError(ExitCode::usage, GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    NoList, RefusedFrames,
    testing::Values(Refusal{"", "expected a number"}, Refusal{"  ", "expected a number"},
                    Refusal{"a", "at 'a': expected a number"}, Refusal{"x2", "at 'x2'"},
                    Refusal{"1-", "at its end: expected a number"}, Refusal{"-", "'-'"},
                    Refusal{"1,", "expected a number"}, Refusal{",1", "expected a number"},
                    Refusal{"1,,2", "at ',2': expected a number"}, Refusal{"1-3x", "at its end"},
                    Refusal{"1-3a", "at 'a': expected a comma"}, Refusal{"1.5", "at '.5'"},
                    Refusal{"1-3-5", "at '-5': expected a comma"}, Refusal{"5x2", "at 'x2'"},
                    Refusal{"1-9x2x3", "at 'x3'"}, Refusal{"+1", "at '+1'"},
                    Refusal{"1\na", "at 'a'"}, Refusal{"0x10-0x20", "at 'x10"}));

INSTANTIATE_TEST_SUITE_P(Ambiguous, RefusedFrames,
                         testing::Values(Refusal{"1 -3", "at ' -3': may be a range"},
                                         Refusal{"-5 -3 -1", "write 1-3 or 1,-3"}));

INSTANTIATE_TEST_SUITE_P(Steps, RefusedFrames,
                         testing::Values(Refusal{"1-10x0", "a step of 0"},
                                         Refusal{"10-1:0", "a step of 0"},
                                         Refusal{"1-10x-2", "a step of -2 leads away from 10"}));

INSTANTIATE_TEST_SUITE_P(Overflow, RefusedFrames,
                         testing::Values(Refusal{"2147483648", "32 bits"},
                                         Refusal{"-2147483649", "32 bits"},
                                         Refusal{"1-99999999999999999999", "32 bits"},
                                         Refusal{"1-9x4294967297", "32 bits"}));

INSTANTIATE_TEST_SUITE_P(TooMany, RefusedFrames,
                         testing::Values(Refusal{"1-1000001", "more than 1000000 frames"},
                                         Refusal{"1000001-1", "more than 1000000 frames"},
                                         Refusal{"1-1000000,0", "more than 1000000 frames"},
                                         Refusal{"-2147483648-2147483647", "more than 1000000"}));

TEST(FrameLimit, CountsDifferentFrames) {
  EXPECT_EQ(parse_frames("1-1000000").size(), 1'000'000u);
  EXPECT_EQ(parse_frames("1-1000000,5-9,1000000-1x3").size(), 1'000'000u);
}

struct Expansion {
  std::string pattern;
  int frame;
  std::string path;
};

void PrintTo(const Expansion& e, std::ostream* out) { *out << e.pattern << " at " << e.frame; }

class Expansions : public testing::TestWithParam<Expansion> {};

TEST_P(Expansions, NameTheFrame) {
  const Expansion& e = GetParam();
  EXPECT_EQ(expand_pattern(e.pattern, e.frame), e.path);
  EXPECT_TRUE(is_pattern(e.pattern));
}

INSTANTIATE_TEST_SUITE_P(
    Widths, Expansions,
    testing::Values(Expansion{"a.#.exr", 7, "a.0007.exr"}, Expansion{"a.##.exr", 7, "a.07.exr"},
                    Expansion{"a.###.exr", 7, "a.007.exr"},
                    Expansion{"a.####.exr", 7, "a.0007.exr"},
                    Expansion{"a.#####.exr", 7, "a.00007.exr"}, Expansion{"a.@.exr", 7, "a.7.exr"},
                    Expansion{"a.@@@.exr", 7, "a.007.exr"}, Expansion{"a.%d.exr", 7, "a.7.exr"},
                    Expansion{"a.%04d.exr", 7, "a.0007.exr"},
                    Expansion{"a.%012d.exr", 7, "a.000000000007.exr"},
                    Expansion{"a.##.exr", 1001, "a.1001.exr"},
                    Expansion{"a.@.exr", 1001, "a.1001.exr"}, Expansion{"####", 0, "0000"}));

INSTANTIATE_TEST_SUITE_P(Negative, Expansions,
                         testing::Values(Expansion{"a.####.exr", -7, "a.-0007.exr"},
                                         Expansion{"a.%04d.exr", -7, "a.-007.exr"},
                                         Expansion{"a.%04d.exr", -1234, "a.-1234.exr"},
                                         Expansion{"a.@@.exr", -7, "a.-07.exr"},
                                         Expansion{"a.@.exr", -7, "a.-7.exr"},
                                         Expansion{"a.%d.exr", INT_MIN, "a.-2147483648.exr"}));

INSTANTIATE_TEST_SUITE_P(
    Several, Expansions,
    testing::Values(Expansion{"no_such/%04d/beauty.%04d.exr", 12, "no_such/0012/beauty.0012.exr"},
                    Expansion{"no_such/@/b.####.exr", 12, "no_such/12/b.0012.exr"},
                    Expansion{"a.##.@@@.exr", 5, "a.05.005.exr"},
                    Expansion{"a%d%d.exr", 5, "a55.exr"}));

INSTANTIATE_TEST_SUITE_P(
    BesideText, Expansions,
    testing::Values(Expansion{"sh010####.exr", 7, "sh0100007.exr"},
                    Expansion{"shot-10#.exr", 7, "shot-100007.exr"},
                    Expansion{"50%%.%04d.exr", 7, "50%.0007.exr"},
                    Expansion{"%%d.%d.exr", 7, "%d.7.exr"},
                    Expansion{"./no_such/../a.#.exr", 7, "./no_such/../a.0007.exr"},
                    Expansion{"//no_such//a.#.exr", 7, "//no_such//a.0007.exr"}));

TEST(Pattern, IsNoneWithoutASign) {
  for (const std::string path : {"", "a.exr", "shot/a.0001.exr", "/", "50%%.exr", "%%d.exr"}) {
    EXPECT_FALSE(is_pattern(path)) << path;
    EXPECT_EQ(expand_pattern(path, 7), path);
  }
}

TEST(Pattern, RefusesOtherConversions) {
  for (const std::string bad :
       {"%4d", "%12d", "%f", "%04f", "%04", "%-4d", "%i", "%+d", "%ld", "%00d", "%0d", "%", "% d",
        "%.4d", "%s", "%x", "%0100d", "%99999999999d", "%%%"}) {
    for (const std::string& path :
         {bad + ".exr", "a.####." + bad, "no_such" + bad + "/a.####.exr"}) {
      for (const auto& use : std::vector<std::function<void()>>{[&] { is_pattern(path); },
                                                                [&] { expand_pattern(path, 1); },
                                                                [&] { find_frames(path); }}) {
        EXPECT_THAT(error_of(use), IsError(ExitCode::usage, path)) << path;
      }
    }
  }
}

/// A folder in which files and folders are made by name.
class OnDisk : public testing::Test {
 protected:
  void touch(const std::string& name) {
    fs::create_directories((dir_ / name).parent_path());
    ASSERT_TRUE(std::ofstream(dir_ / name)) << name;
  }
  void make_folder(const std::string& name) { fs::create_directories(dir_ / name); }
  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  std::vector<int> find(const std::string& name) const { return find_frames(path(name)); }
  std::string expand(const std::string& name) const { return expand_pattern(path(name), 7); }

  TempDir dir_;
};

using Literal = OnDisk;

TEST_F(Literal, FileIsNoPattern) {
  for (const std::string name : {"user@home.exr", "a.####.exr", "50%.exr", "a.%04d.exr"}) {
    touch(name);
    EXPECT_FALSE(is_pattern(path(name))) << name;
    EXPECT_EQ(expand(name), path(name));
    EXPECT_THAT(find(name), IsEmpty());
  }
}

TEST_F(Literal, FolderIsNoPattern) {
  make_folder("user@studio/100%/C#");
  const std::string output = path("user@studio/100%/C#/out.exr");
  EXPECT_FALSE(is_pattern(output));
  EXPECT_EQ(expand_pattern(output, 7), output);
  EXPECT_FALSE(is_pattern(path("user@studio/new/out.exr")));
  EXPECT_EQ(expand("user@studio/100%/C#/out.@.exr"), path("user@studio/100%/C#/out.7.exr"));
  EXPECT_EQ(expand("user@studio/@/out.@.exr"), path("user@studio/7/out.7.exr"));
}

TEST_F(Literal, FolderIsAPatternUntilItExists) {
  EXPECT_EQ(expand("user@/out.exr"), path("user7/out.exr"));
  make_folder("user@");
  EXPECT_EQ(expand("user@/out.exr"), path("user@/out.exr"));
}

TEST_F(Literal, FileIsNotTakenForAFolder) {
  touch("user@");
  EXPECT_TRUE(is_pattern(path("user@/out.exr")));
}

TEST_F(Literal, FolderHasFrames) {
  touch("user@studio/a.0003.exr");
  touch("user1studio/a.0004.exr");
  EXPECT_THAT(find("user@studio/a.####.exr"), ElementsAre(3));
}

TEST_F(Literal, PercentSignsOfAFolderStayAsTheyAre) {
  touch("50%%/a.0003.exr");
  EXPECT_THAT(find("50%%/a.%04d.exr"), ElementsAre(3));
  EXPECT_EQ(expand("50%%/a.%04d.exr"), path("50%%/a.0007.exr"));
}

TEST_F(Literal, FolderIsLookedUpByItsRealName) {
  touch("50%/user@/a.0003.exr");
  EXPECT_THAT(find("50%%/user@/a.%04d.exr"), ElementsAre(3));
}

using Found = OnDisk;

TEST_F(Found, FramesAscendWithNegativeOnes) {
  for (const std::string n : {"0010", "-0002", "0001", "-0010", "0000", "0009"})
    touch("a." + n + ".exr");
  EXPECT_THAT(find("a.####.exr"), ElementsAre(-10, -2, 0, 1, 9, 10));
  EXPECT_THAT(find("a.#.exr"), ElementsAre(-10, -2, 0, 1, 9, 10));
  EXPECT_THAT(find("a.@@@@.exr"), ElementsAre(-10, -2, 0, 1, 9, 10));
}

TEST_F(Found, NegativeFramesOfPrintfCountTheirSign) {
  for (const std::string n : {"-001", "-0002", "-1234", "-99", "0003"}) touch("a." + n + ".exr");
  EXPECT_THAT(find("a.%04d.exr"), ElementsAre(-1234, -1, 3));
  EXPECT_THAT(find("a.####.exr"), ElementsAre(-1234, -2, 3));
  EXPECT_THAT(find("a.###.exr"), ElementsAre(-1234, -1));
  EXPECT_THAT(find("a.%d.exr"), ElementsAre(-1234, -99));
}

TEST_F(Found, PaddingIsStrict) {
  for (const std::string n :
       {"0001", "2", "03", "004", "00005", "99999", "-12345", "-006", "-00007"}) {
    touch("a." + n + ".exr");
  }
  EXPECT_THAT(find("a.####.exr"), ElementsAre(-12345, 1, 99999));
  EXPECT_THAT(find("a.##.exr"), ElementsAre(-12345, 3, 99999));
  EXPECT_THAT(find("a.@.exr"), ElementsAre(-12345, 2, 99999));
  EXPECT_THAT(find("a.%d.exr"), ElementsAre(-12345, 2, 99999));
}

TEST_F(Found, NumbersAreInts) {
  for (const std::string n : {"2147483647", "2147483648", "-2147483648", "99999999999999999999",
                              "-0000", "--001", "+001", " 001", "0x01", "1e03", "", "-", "one"}) {
    touch("a." + n + ".exr");
  }
  EXPECT_THAT(find("a.####.exr"), ElementsAre(INT_MIN, INT_MAX));
}

TEST_F(Found, TextAroundIsStrict) {
  for (const std::string name :
       {"a.0001.exr", "a.0001", "a.0002.exr.tmp", "xa.0003.exr", "a_0004.exr", "a.0005.EXR",
        "axb.0006.exr", "a.0007xexr", "a.0008"}) {
    touch(name);
  }
  EXPECT_THAT(find("a.####.exr"), ElementsAre(1));
}

TEST_F(Found, DashBeforeAPatternIsText) {
  touch("shot-0001.exr");
  touch("shot--0002.exr");
  EXPECT_THAT(find("shot-####.exr"), ElementsAre(-2, 1));
  EXPECT_THAT(find("shot####.exr"), ElementsAre(-1));
}

TEST_F(Found, DigitsBesideAPatternAreText) {
  for (const std::string name : {"sh0100001.exr", "sh01012345.exr", "sh0200001.exr"}) touch(name);
  EXPECT_THAT(find("sh010####.exr"), ElementsAre(1, 12345));
  touch("b15.exr");
  touch("b16.exr");
  touch("b155.exr");
  EXPECT_THAT(find("b%d5.exr"), ElementsAre(1, 15));
}

TEST_F(Found, SeveralNumbersOfANameAreTheSame) {
  for (const std::string name :
       {"a.01.001.exr", "a.02.003.exr", "a.04.4.exr", "b1111.exr", "b12.exr"}) {
    touch(name);
  }
  EXPECT_THAT(find("a.##.###.exr"), ElementsAre(1));
  EXPECT_THAT(find("b%d%d.exr"), ElementsAre(11));
}

TEST_F(Found, FolderAndNameAreTheSameFrame) {
  for (const std::string name :
       {"s/0002/b.0002.exr", "s/0001/b.0001.exr", "s/0003/b.0004.exr", "s/5/b.0005.exr",
        "s/0006/c.0006.exr", "s/-007/b.-007.exr", "s/b.0008.exr"}) {
    touch(name);
  }
  make_folder("s/0009/b.0009.exr");
  EXPECT_THAT(find("s/%04d/b.%04d.exr"), ElementsAre(-7, 1, 2));
}

TEST_F(Found, FolderAlone) {
  for (const std::string name : {"s/v1/x/b.exr", "s/v12/x/b.exr", "s/v3/x/c.exr", "s/v4"})
    touch(name);
  EXPECT_THAT(find("s/v@/x/b.exr"), ElementsAre(1, 12));
}

TEST_F(Found, NumberAtTheStartAndAtTheEnd) {
  touch("0001");
  touch("12345");
  EXPECT_THAT(find("####"), ElementsAre(1, 12345));
}

TEST_F(Found, FoldersAndBrokenLinksAreNoFiles) {
  touch("a.0001.exr");
  make_folder("a.0002.exr");
  fs::create_symlink("a.0001.exr", path("a.0003.exr"));
  fs::create_symlink("no_such.exr", path("a.0004.exr"));
  EXPECT_THAT(find("a.####.exr"), ElementsAre(1, 3));
}

TEST_F(Found, NamesExpandBack) {
  const std::vector<std::string> patterns = {"a.####.exr", "a@b.exr", "%02d/%03d.exr", "c-##-.exr"};
  for (const std::string& pattern : patterns) {
    const std::vector<int> frames = {-1000, -10, -1, 0, 1, 9, 10, 99, 100, 12345};
    for (const int frame : frames)
      touch(fs::path(expand_pattern(path(pattern), frame)).lexically_relative(dir_.path()));
    EXPECT_EQ(find(pattern), frames) << pattern;
  }
}

TEST_F(Found, NoneWithoutPatternOrFolder) {
  touch("a.0001.exr");
  EXPECT_THAT(find("a.0001.exr"), IsEmpty());
  EXPECT_THAT(find("no_such/a.####.exr"), IsEmpty());
  EXPECT_THAT(find("a.0001.exr/a.####.exr"), IsEmpty());
  EXPECT_THAT(find_frames(""), IsEmpty());
}

TEST_F(Found, InTheWorkingFolder) {
  const fs::path before = fs::current_path();
  touch("a.0005.exr");
  fs::current_path(dir_.path());
  const auto bare = find_frames("a.####.exr"), dotted = find_frames("./a.####.exr");
  fs::current_path(before);
  EXPECT_THAT(bare, ElementsAre(5));
  EXPECT_THAT(dotted, ElementsAre(5));
}

TEST_F(Found, FolderThatCannotBeListedIsAnInputError) {
  // Root lists every folder, so the process is left without a free descriptor instead.
  rlimit before;
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none = {0, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const Error error = error_of([&] { find("a.####.exr"); });
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_THAT(error, IsError(ExitCode::input, dir_.path().string()));
}

}  // namespace
}  // namespace ssdo::test::sequence_test
