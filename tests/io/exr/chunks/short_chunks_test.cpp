// SPDX-License-Identifier: Apache-2.0
//
// Chunks that hold fewer bytes than their pixels take: OpenEXR may leave the others as they were in
// memory, and says nothing.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "io/exr/deep_reader.h"
#include "io/exr/exr_reader.h"
#include "support/deep_file.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::short_chunks_test {
namespace {

using Imath::Box2i;

constexpr int kSide = 64;

struct Kind {
  const char* name;
  Imf::Compression compression;
  int rows;  ///< of a chunk of scanlines
  std::vector<TestChannel> channels = {{"R", Imf::HALF}, {"Z", Imf::FLOAT}, {"id", Imf::UINT}};
};

Imf::Header header(const Kind& kind) {
  return test_header(Box2i({0, 0}, {kSide - 1, kSide - 1}), kind.channels, kind.compression);
}

std::vector<std::string> names(const Kind& kind) {
  std::vector<std::string> names;
  for (const TestChannel& channel : kind.channels) names.push_back(channel.name);
  return names;
}

const std::vector<Kind> kKinds = {
    {"none", Imf::NO_COMPRESSION, 1},
    {"rle", Imf::RLE_COMPRESSION, 1},
    {"zips", Imf::ZIPS_COMPRESSION, 1},
    {"zip", Imf::ZIP_COMPRESSION, 16},
    {"piz", Imf::PIZ_COMPRESSION, 32},
    {"pxr24", Imf::PXR24_COMPRESSION, 16},
    {"b44", Imf::B44_COMPRESSION, 32},
    {"b44a", Imf::B44A_COMPRESSION, 32},
    {"dwaa", Imf::DWAA_COMPRESSION, 32},
    {"dwab", Imf::DWAB_COMPRESSION, 256},
    // What DWA deflates, stores as runs, and transforms.
    {"dwaa_deflated", Imf::DWAA_COMPRESSION, 32, {{"P.X"}, {"Z"}, {"id", Imf::UINT}}},
    {"dwaa_runs", Imf::DWAA_COMPRESSION, 32, {{"A", Imf::HALF}}},
    {"dwaa_colors",
     Imf::DWAA_COMPRESSION,
     32,
     {{"B", Imf::HALF}, {"G", Imf::HALF}, {"R", Imf::HALF}}},
};

class ShortChunks : public testing::TestWithParam<Kind> {
 protected:
  std::size_t chunks() const {
    return std::size_t((kSide + GetParam().rows - 1) / GetParam().rows);
  }

  ExrBytes bytes_of_lines() const {
    write_test_exr(dir_ / "whole.exr", {header(GetParam())});
    return ExrBytes(dir_ / "whole.exr");
  }
  ExrBytes bytes_of_tiles() const {
    write_test_exr(dir_ / "whole.exr", {tiled(header(GetParam()), 8)});
    return ExrBytes(dir_ / "whole.exr");
  }

  ExrReader file_of(const ExrBytes& bytes, Salvage salvage = Salvage::none) const {
    bytes.write(dir_ / "a.exr");
    return ExrReader(dir_ / "a.exr", salvage);
  }

  void expect_damaged(const ExrBytes& bytes) const {
    const ExrReader file = file_of(bytes);
    EXPECT_THAT(error_of([&] { file.read(0, names(GetParam())); }),
                IsError(ExitCode::input, "a.exr: is damaged"));
    EXPECT_THAT(error_of([&] { file.read_stored(0, names(GetParam())); }),
                IsError(ExitCode::input, "a.exr: is damaged"));
  }

  TempDir dir_;
};

TEST_P(ShortChunks, OfTilesThatClaimToBeLarger) {
  ExrBytes bytes = bytes_of_tiles();
  for (const int side : {9, 16, 64, 4096}) {
    SCOPED_TRACE(side);
    bytes.put_int(bytes.value_of("tiles"), side);
    bytes.put_int(bytes.value_of("tiles") + 4, side);
    expect_damaged(bytes);
  }
}

TEST_P(ShortChunks, OfLinesThatClaimToBeWider) {
  // Decoded to as many values as there are pixels, from zeros where the bits end.
  if (GetParam().compression == Imf::PIZ_COMPRESSION) return;
  ExrBytes bytes = bytes_of_lines();
  for (const int width : {kSide + 1, 2 * kSide, 100 * kSide}) {
    SCOPED_TRACE(width);
    bytes.put_int(bytes.value_of("dataWindow") + 8, width - 1);
    expect_damaged(bytes);
  }
}

TEST_P(ShortChunks, OfNoBytes) {
  ExrBytes lines = bytes_of_lines();
  lines.put_int(lines.places(chunks()).back() + 4, 0);
  expect_damaged(lines);
  ExrBytes tiles = bytes_of_tiles();
  tiles.put_int(tiles.places(64)[1] + 16, 0);
  expect_damaged(tiles);
}

// Of a renderer that was killed, whose table of chunks OpenEXR has to make.
TEST_P(ShortChunks, OfFilesWithoutTable) {
  ExrBytes bytes = bytes_of_tiles();
  const std::size_t table = bytes.table(64);
  for (std::size_t i = 0; i < 64; ++i) bytes.put_place(table + 8 * i, 0);
  bytes.put_int(bytes.value_of("tiles"), 9);
  bytes.put_int(bytes.value_of("tiles") + 4, 9);
  EXPECT_THAT(error_of([&] { file_of(bytes).read(0, names(GetParam())); }),
              IsError(ExitCode::input, "a.exr: is incomplete"));
}

TEST_P(ShortChunks, AreMissing) {
  ExrBytes bytes = bytes_of_tiles();
  bytes.put_int(bytes.places(64)[1] + 16, 0);
  const ExrReader file = file_of(bytes, Salvage::done);
  const Plane<float> plane = file.read(0, names(GetParam()))[0];
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x)
      ASSERT_EQ(std::isnan(plane(x, y)), y < 8 && x >= 8 && x < 16) << x << " " << y;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, ShortChunks, testing::ValuesIn(kKinds),
                         [](const auto& kind) { return kind.param.name; });

// The table of a part stands behind those of the parts before it, with all their levels.
TEST(ShortChunksOfParts, ThatComeSecond) {
  const std::map<Imf::LevelMode, std::size_t> chunks_of_first = {
      {Imf::ONE_LEVEL, 64}, {Imf::MIPMAP_LEVELS, 88}, {Imf::RIPMAP_LEVELS, 324}};
  const Kind kind{"zip", Imf::ZIP_COMPRESSION, 16};
  for (const auto& [mode, chunks] : chunks_of_first) {
    const TempDir dir;
    write_test_exr(dir / "a.exr",
                   {named(tiled(header(kind), 8, mode), "first"), named(header(kind), "second")});
    ExrBytes bytes(dir / "a.exr");
    bytes.put_int(bytes.places(chunks + 4)[chunks + 1] + 8, 0);
    bytes.write(dir / "a.exr");
    const ExrReader file(dir / "a.exr");
    file.read(0, names(kind));
    EXPECT_THAT(error_of([&] { file.read(1, names(kind)); }),
                IsError(ExitCode::input, "a chunk holds fewer bytes than its pixels take"));
  }
}

/// A deep image with some samples in every pixel, in lines or tiles of 64 x 64.
ExrBytes deep_bytes(const TempDir& dir, bool tiles) {
  DeepPixels pixels({0, 0, kSide, kSide});
  for (std::size_t i = 0; i < pixels.samples.size(); ++i) pixels.samples[i].resize(i % 3);
  write_deep(dir / "whole.exr", {{.pixels = pixels, .tiles = tiles}});
  return ExrBytes(dir / "whole.exr");
}

void expect_damaged_counts(const TempDir& dir, const ExrBytes& bytes) {
  bytes.write(dir / "a.exr");
  const ExrReader file(dir / "a.exr");
  EXPECT_THAT(error_of([&] {
                read_deep(file, {{0, "Z"}, {}, {}});
              }),
              IsError(ExitCode::input, "a chunk holds fewer bytes than its pixels take"));
}

TEST(ShortDeepChunks, OfLinesThatClaimToBeWider) {
  const TempDir dir;
  ExrBytes bytes = deep_bytes(dir, false);
  bytes.put_int(bytes.value_of("dataWindow") + 8, 2 * kSide - 1);
  expect_damaged_counts(dir, bytes);
}

TEST(ShortDeepChunks, OfTilesThatClaimToBeLarger) {
  const TempDir dir;
  ExrBytes bytes = deep_bytes(dir, true);
  bytes.put_int(bytes.value_of("tiles"), 128);
  bytes.put_int(bytes.value_of("tiles") + 4, 128);
  expect_damaged_counts(dir, bytes);
}

// Of a tile that the image fills in part, as many bytes may be packed as a whole one takes.
TEST(ShortDeepChunks, OfTilesThatAreLargerThanTheImage) {
  const TempDir dir;
  const DeepPixels pixels({0, 0, 4, 4});
  write_deep(dir / "whole.exr", {{.pixels = pixels, .tiles = true}});
  ExrBytes bytes(dir / "whole.exr");
  const std::string empty_block("\0\0\0\xff\xff", 5), last_block("\1\0\0\xff\xff", 5),
      checksum("\0\0\0\1", 4);
  std::string table = "\x78\x01";
  while (table.size() < sizeof(std::uint32_t) * pixels.window.area()) table += empty_block;
  table += last_block + checksum;
  const std::size_t tile = bytes.places(1)[0], sizes = tile + 16;
  bytes.cut(sizes + 24);
  bytes.put_place(sizes, table.size());
  for (const std::size_t samples : {8, 16}) bytes.put_place(sizes + samples, 0);
  bytes.append(table);
  expect_damaged_counts(dir, bytes);
}

}  // namespace
}  // namespace ssdo::test::short_chunks_test
