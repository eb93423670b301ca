// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/repeated_warnings.h"

#include <gmock/gmock.h>

namespace ssdo::test::repeated_warnings_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(RepeatedWarnings, ArePrintedWhereTheyFirstAppearAndSummedUp) {
  RepeatedWarnings warnings;
  for (const int number : {3, 4, 5, 8, 9}) {
    const std::size_t place = std::size_t(number) - 3;
    EXPECT_EQ(warnings.add(place, number, "no albedo"), number == 3);
    if (number == 4) {
      EXPECT_TRUE(warnings.add(place, number, "once"));
    }
  }
  EXPECT_THAT(warnings.summary(), ElementsAre("no albedo: frames 3 to 5, 8 to 9"));
}

TEST(RepeatedWarnings, AreOneKindWithOtherNumbers) {
  RepeatedWarnings warnings;
  EXPECT_TRUE(warnings.add(0, 9, "12 of 'P2' miss by 1.5e-05 px (40 %) in a.0009.exr"));
  EXPECT_FALSE(warnings.add(1, 10, "7 of 'P2' miss by 3 px (-1 %) in a.0010.exr"));
  EXPECT_TRUE(warnings.add(1, 10, "7 of 'P3' miss by 3 px (1 %) in a.0010.exr")) << "a name";
  EXPECT_TRUE(warnings.add(1, 10, "7 of 'P2' miss by 3 px (1 %) in a.0009.exr")) << "another file";
  EXPECT_THAT(
      warnings.summary(),
      ElementsAre("12 of 'P2' miss by 1.5e-05 px (40 %) in a.0009.exr: frames 9 to 10, with "
                  "numbers of their own"));
}

TEST(RepeatedWarnings, KeepNamesThatHaveNumbersApart) {
  RepeatedWarnings warnings;
  EXPECT_TRUE(warnings.add(0, 1, "s01/other.exr: left out"));
  EXPECT_FALSE(warnings.add(1, 2, "s01/other.exr: left out"));
  EXPECT_TRUE(warnings.add(0, 1, "--also 010_side.exr: left out"));
  EXPECT_TRUE(warnings.add(1, 2, "--also 020_side.exr: left out")) << "another view";
  EXPECT_TRUE(warnings.add(0, -3, "in.-0003.exr has 2 pixels"));
  EXPECT_FALSE(warnings.add(1, -2, "in.-0002.exr has 3 pixels"));
}

/// Two views of one frame may both be left out.
TEST(RepeatedWarnings, OfOneFrameAreAllPrinted) {
  RepeatedWarnings warnings;
  EXPECT_TRUE(warnings.add(0, 1, "12 pixels"));
  EXPECT_TRUE(warnings.add(0, 1, "13 pixels"));
  EXPECT_THAT(warnings.summary(), IsEmpty());
}

TEST(RepeatedWarnings, OfManyRangesAreShort) {
  RepeatedWarnings warnings;
  for (int number = 0; number < 40; number += 2)
    warnings.add(std::size_t(number), number, "no albedo");
  EXPECT_THAT(warnings.summary(),
              ElementsAre("no albedo: frames 0, 2, 4, 6, 8, 10, 12, 14 and 12 more"));
}

}  // namespace
}  // namespace ssdo::test::repeated_warnings_test
