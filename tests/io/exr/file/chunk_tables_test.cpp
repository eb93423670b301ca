// SPDX-License-Identifier: Apache-2.0
//
// Where a place is missing in a table, OpenEXR looks for all chunks: what it finds has to be found.
#include "io/exr/file/chunk_tables.h"

#include <gmock/gmock.h>

#include "io/exr/exr_reader.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::chunk_tables_test {
namespace {

using Imath::Box2i;

constexpr int kRows = 8;
constexpr std::uint64_t kHalf = std::uint64_t(1) << 63;  // of all numbers of 64 bits

/// Deep scanlines without the place of one, and a head of a chunk before the first.
class ChunkTablesOfDeepLines : public testing::Test {
 protected:
  ChunkTablesOfDeepLines() {
    Imf::Header deep = test_header(Box2i({0, 0}, {3, kRows - 1}), {{"Z"}}, Imf::ZIPS_COMPRESSION);
    deep.setType(Imf::DEEPSCANLINE);
    write_test_exr(dir_ / "whole.exr", {deep});
  }

  /// How many of the chunks are found behind a head of these sizes, the head too.
  std::size_t found_behind(std::uint64_t counts, std::uint64_t samples, std::int32_t row = 3) {
    const ExrBytes whole(dir_ / "whole.exr");
    const std::vector<std::uint64_t> places = whole.places(kRows);
    const std::size_t table = whole.table(kRows);
    ExrBytes bytes = whole;
    bytes.cut(places[0]);
    bytes.append(std::string(kHead, '\0'));
    bytes.put_int(places[0], row);
    bytes.put_place(places[0] + 4, counts);
    bytes.put_place(places[0] + 12, samples);
    bytes.append(whole.slice(places[0], whole.size()));
    for (std::size_t i = 0; i < kRows; ++i)
      bytes.put_place(table + 8 * i, i == kGone ? 0 : places[i] + kHead);
    return found_in(bytes);
  }

  std::size_t found_in(const ExrBytes& bytes) {
    bytes.write(dir_ / "a.exr");
    const ExrReader file(dir_ / "a.exr");
    return file.chunk_tables().found(file.parts()[0]).size();
  }

  static constexpr std::size_t kHead = 4 + 3 * 8, kGone = 5;
  TempDir dir_;
};

TEST_F(ChunkTablesOfDeepLines, AreSearchedBehindAnEmptyChunk) {
  EXPECT_EQ(found_behind(0, 0), std::size_t(kRows));
}

/// The sizes are 0 together, modulo 2^64, and none is for OpenEXR.
TEST_F(ChunkTablesOfDeepLines, AreSearchedBehindSizesThatWrap) {
  EXPECT_EQ(found_behind(kHalf, kHalf), std::size_t(kRows));
}

TEST_F(ChunkTablesOfDeepLines, AreNotSearchedBehindTheFile) {
  EXPECT_EQ(found_behind(kHalf / 2, 0), 1u);
}

TEST_F(ChunkTablesOfDeepLines, AreNotSearchedBackwards) {
  EXPECT_EQ(found_behind(0, std::uint64_t(0) - kHead), 1u);
}

TEST_F(ChunkTablesOfDeepLines, AreNotSearchedBehindAChunkOfNoRow) {
  EXPECT_EQ(found_behind(0, 0, kRows), 0u);
}

/// OpenEXR takes its place before it reads its sizes.
TEST_F(ChunkTablesOfDeepLines, KnowAChunkThatEndsBeforeItsSizes) {
  const ExrBytes whole(dir_ / "whole.exr");
  ExrBytes bytes = whole;
  bytes.put_place(whole.table(kRows) + 8 * kGone, 0);
  EXPECT_EQ(found_in(bytes), std::size_t(kRows));
  bytes.cut(whole.places(kRows)[kGone] + 4 + 8);
  EXPECT_EQ(found_in(bytes), kGone + 1);
  bytes.cut(whole.places(kRows)[kGone] + 3);
  EXPECT_EQ(found_in(bytes), kGone);
}

TEST(ChunkTables, AreNotSearchedWhereTheyAreComplete) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {7, 7}), {{"R"}})});
  const ExrReader file(dir / "a.exr");
  EXPECT_TRUE(file.chunk_tables().found(file.parts()[0]).empty());
}

}  // namespace
}  // namespace ssdo::test::chunk_tables_test
