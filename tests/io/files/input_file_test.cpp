// SPDX-License-Identifier: Apache-2.0
#include "io/files/input_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <random>
#include <string>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::input_file_test {
namespace {

std::span<std::byte> bytes_of(std::string& text) { return std::as_writable_bytes(std::span(text)); }

TEST(InputFile, ReadsFromAnyPlaceToTheEnd) {
  const TempDir dir;
  std::ofstream(dir / "a") << "0123456789";
  const InputFile file(dir / "a");
  ASSERT_TRUE(file.is_open());
  EXPECT_EQ(file.bytes(), 10);
  std::string text(4, '?');
  EXPECT_EQ(file.read(3, bytes_of(text)), 4);
  EXPECT_EQ(text, "3456");
  EXPECT_EQ(file.read(8, bytes_of(text)), 2);
  EXPECT_EQ(text, "8956");
  for (const std::uint64_t behind : {std::uint64_t(10), std::uint64_t(1) << 40, ~std::uint64_t(0)})
    EXPECT_EQ(file.read(behind, bytes_of(text)), 0) << behind;
}

TEST(InputFile, WhatTheSystemCannotReadIsAnError) {
  const TempDir dir;
  const InputFile folder(dir.path());
  ASSERT_TRUE(folder.is_open());
  std::string text(4, '?');
  const auto is_folder = IsError(ExitCode::input, "cannot be read at byte 7: Is a directory");
  EXPECT_THAT(error_of([&] { folder.read(7, bytes_of(text)); }), is_folder);
  InputStream stream(folder);
  EXPECT_THAT(error_of([&] {
                stream.seekg(7);
                stream.get();
              }),
              is_folder);
}

TEST(InputFile, APipeInPlaceOfAFileIsNotWaitedFor) {
  const TempDir dir;
  ASSERT_EQ(mkfifo((dir / "pipe").c_str(), 0600), 0);
  std::string text(4, '?');
  EXPECT_THAT(error_of([&] { InputFile(dir / "pipe").read(0, bytes_of(text)); }),
              IsError(ExitCode::input, "cannot be read"));
}

/// What a stream has done: what it read, where it is then, and whether it goes on.
struct Step {
  std::string text;
  std::streamoff place;
  bool good;
  bool operator==(const Step&) const = default;
};

Step step(std::istream& in, int seek_from, std::streamoff to, std::size_t count) {
  in.clear();
  if (seek_from == 0) in.seekg(to);
  if (seek_from == 1) in.seekg(to, std::ios::cur);
  if (seek_from == 2) in.seekg(-to, std::ios::end);
  Step out{std::string(count, '?'), 0, false};
  in.read(out.text.data(), std::streamsize(count));
  out.text.resize(std::size_t(in.gcount()));
  out.good = in.good();
  in.clear();
  out.place = in.tellg();
  return out;
}

TEST(InputStream, DoesWhatAStreamOfTheStandardDoes) {
  const TempDir dir;
  std::mt19937 random(5);
  std::string all(60'000, '?');
  for (char& c : all) c = char('a' + random() % 26);
  std::ofstream(dir / "a") << all;
  const InputFile file(dir / "a");
  InputStream ours(file);
  std::ifstream theirs(dir / "a");
  for (int i = 0; i < 20'000; ++i) {
    const int from = int(random() % 4);  // 3: from where it is
    const auto to = std::streamoff(random() % (i % 2 ? 100 : 70'000)) - (from == 1 ? 50 : 0);
    const std::size_t count = random() % (i % 3 ? 40 : 30'000);
    const Step expected = step(theirs, from, to, count);
    ASSERT_EQ(step(ours, from, to, count), expected)
        << i << ": " << from << " " << to << " " << count;
  }
}

}  // namespace
}  // namespace ssdo::test::input_file_test
