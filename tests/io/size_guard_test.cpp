// SPDX-License-Identifier: Apache-2.0
#include "io/size_guard.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test {
namespace {

TEST(SizeGuard, RefusesMorePixelsThanTheFileCanHold) {
  const TempDir dir;
  const std::filesystem::path file = dir / "hundred.exr";
  std::ofstream(file) << std::string(100, 'x');
  EXPECT_NO_THROW(check_decoded_size(file, 1000, 0, 10));
  EXPECT_THAT(error_of([&] { check_decoded_size(file, 1001, 0, 10); }),
              IsError(ExitCode::input, "cannot hold"));
  EXPECT_NO_THROW(check_decoded_size(file, 100 * kLargestRatio, 0));
}

TEST(SizeGuard, RefusesMoreThanTheMemoryOfTheMachine) {
  const TempDir dir;
  const std::filesystem::path file = dir / "hundred.exr";
  std::ofstream(file) << std::string(100, 'x');
  EXPECT_THAT(error_of([&] { check_decoded_size(file, 1000, 1e18); }),
              IsError(ExitCode::input, "memory"));
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

}  // namespace
}  // namespace ssdo::test
