// SPDX-License-Identifier: Apache-2.0
#include "nearest_name.h"

#include <gmock/gmock.h>

namespace ssdo::test::nearest_name_test {
namespace {

const std::vector<std::string> kNames = {"bitmask", "trace", "ssdo",
                                         "ssao",    "gtao",  "env-exposure"};

std::string near(std::string_view wrong, const std::vector<std::string>& names = kNames) {
  return nearest_name(wrong, names).value_or("");
}

TEST(NearestName, ForgivesOneFaultInThreeLetters) {
  EXPECT_EQ(near("bitmusk"), "bitmask") << "a wrong letter";
  EXPECT_EQ(near("bitmsk"), "bitmask") << "a missing one";
  EXPECT_EQ(near("bitmmask"), "bitmask") << "one too many";
  EXPECT_EQ(near("bimtask"), "bitmask") << "two exchanged";
  EXPECT_EQ(near("btimsak"), "bitmask") << "twice";
  EXPECT_EQ(near("bxtxxsk"), "") << "three wrong of seven";
  EXPECT_EQ(near("sauce", {"save"}), "save") << "two of five";
  EXPECT_EQ(near("auce", {"save"}), "") << "two of four";
}

TEST(NearestName, CountsAnExchangeAsOneFault) {
  EXPECT_EQ(near("ab", {"ba"}), "ba");
  EXPECT_EQ(near("ab", {"cd"}), "");
}

TEST(NearestName, TakesTheOneWithTheFewestFaults) {
  EXPECT_EQ(near("ssap"), "ssao");
  EXPECT_EQ(near("ssdp"), "ssdo");
  EXPECT_EQ(near("aces2", {"aces1", "ACES2"}), "ACES2") << "case is no fault";
}

TEST(NearestName, KnowsANameByItsBeginningOrItsEnd) {
  EXPECT_EQ(near("bit"), "bitmask");
  EXPECT_EQ(near("exposure"), "env-exposure");
  EXPECT_EQ(near("Normal", {"ViewLayer.Normalised", "ViewLayer.Normal"}), "ViewLayer.Normal");
  EXPECT_EQ(near("Normals", {"ViewLayer.Depth", "ViewLayer.Normal"}), "ViewLayer.Normal");
  EXPECT_EQ(near("bi"), "") << "too short to tell";
  EXPECT_EQ(near("tma"), "") << "the middle";
  EXPECT_EQ(near("comp", {"compression", "compose"}), "compose") << "the shorter one";
  EXPECT_EQ(near("save", {"save-all", "sabe"}), "sabe") << "a misspelling is nearer";
}

TEST(NearestName, SaysNothingWhereNothingIsNear) {
  EXPECT_EQ(near("magic"), "");
  EXPECT_EQ(near(""), "");
  EXPECT_EQ(near("x", {"y", ""}), "");
  EXPECT_EQ(near("trace", {}), "");
}

TEST(DidYouMean, IsAQuestionOrNothing) {
  EXPECT_EQ(did_you_mean("trase", kNames), "did you mean trace? ");
  EXPECT_EQ(did_you_mean("magic", kNames), "");
}

TEST(SomeOf, NamesTheFirstAndCountsTheRest) {
  EXPECT_EQ(some_of({}), "");
  EXPECT_EQ(some_of({"a"}), "a");
  EXPECT_EQ(some_of({"a", "b"}, 2), "a, b");
  EXPECT_EQ(some_of({"a", "b", "c", "d"}, 2), "a, b and 2 more");
}

}  // namespace
}  // namespace ssdo::test::nearest_name_test
