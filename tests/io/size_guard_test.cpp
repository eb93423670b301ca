// SPDX-License-Identifier: Apache-2.0
#include "io/size_guard.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::size_guard_test {
namespace {

TEST(SizeGuard, RefusesMorePixelsThanTheFileCanHold) {
  EXPECT_NO_THROW(check_decoded_size("a.exr", 100, 1000, 0, 10));
  EXPECT_THAT(error_of([&] { check_decoded_size("a.exr", 100, 1001, 0, 10); }),
              IsError(ExitCode::input, "cannot hold"));
  EXPECT_NO_THROW(check_decoded_size("a.exr", 100, 100 * kLargestRatio, 0));
}

TEST(SizeGuard, RefusesMoreThanTheMemoryOfTheMachine) {
  EXPECT_THAT(error_of([&] { check_decoded_size("a.exr", 100, 1000, 1e18); }),
              IsError(ExitCode::input, "memory"));
}

TEST(SizeGuard, RefusesPicturesOfMoreMemoryThanTheRunMayUse) {
  const std::filesystem::path file = "map.exr";
  limit_memory(1 << 30);
  EXPECT_NO_THROW(check_picture_size(file, 0, 1 << 30));
  const Error error = error_of([&] { check_picture_size(file, 0, 1.5 * (1 << 30)); });
  limit_memory(physical_memory());
  EXPECT_THAT(error, IsError(ExitCode::input,
                             "map.exr: needs 1.5 GiB of memory for its pixels, and the run may use "
                             "1.0 GiB; reduce the image or raise --mem-limit"));
}

TEST(SizeGuard, RefusesTextsThatAreLargerThanTheirKind) {
  const TempDir dir;
  const std::filesystem::path file = dir / "text";
  std::ofstream(file) << std::string(4096, 'x');
  EXPECT_NO_THROW(check_text_size(file, 4096, ExitCode::usage));
  EXPECT_NO_THROW(check_text_size(dir / "none", 1, ExitCode::usage));
  EXPECT_THAT(error_of([&] { check_text_size(file, 2048, ExitCode::usage); }),
              IsError(ExitCode::usage, "text: has 4 KiB, and a file of its kind 2 KiB at most"));
}

/// Pipes do not tell their size.
TEST(SizeGuard, ReadsNoMoreOfATextThanItsKindHas) {
  std::istringstream enough(std::string(2048, 'x')), endless(std::string(4096, 'x'));
  EXPECT_EQ(read_text(enough, "pipe", 2048, ExitCode::usage), std::string(2048, 'x'));
  EXPECT_THAT(error_of([&] { read_text(endless, "pipe", 2048, ExitCode::usage); }),
              IsError(ExitCode::usage, "pipe: has more than 2 KiB"));
  EXPECT_LT(endless.tellg(), 4096);
}

}  // namespace
}  // namespace ssdo::test::size_guard_test
