// SPDX-License-Identifier: Apache-2.0
// Damaged files: whatever the bytes are, reading ends in pixels or in an ssdo::Error.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "io/exr/deep_reader.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::exr_damage_test {
namespace {

using Imath::Box2i;

const std::vector<TestChannel> kChannels = {{"R", Imf::HALF}, {"Z", Imf::FLOAT}, {"id", Imf::UINT}};

std::vector<Imf::Header> scanline_file(Imf::Compression compression) {
  return {test_header(Box2i({-2, 3}, {13, 40}), kChannels, compression)};
}

std::vector<Imf::Header> tiled_file() {
  return {tiled(test_header(Box2i({-2, 3}, {29, 40}), kChannels), 8, Imf::MIPMAP_LEVELS)};
}

std::vector<Imf::Header> multi_part_file() {
  Imf::Header deep = named(test_header(Box2i({0, 0}, {7, 7}), {{"A"}, {"Z"}}), "deep");
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.setType(Imf::DEEPSCANLINE);
  Imf::Header lines = named(test_header(Box2i({0, 0}, {9, 9}), kChannels), "lines");
  lines.displayWindow() = deep.displayWindow();
  return {deep, lines};
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Reads all that a file holds. True if it could be read, false after an ssdo::Error.
bool reads(const std::filesystem::path& path) {
  try {
    const ExrReader reader(path);
    for (const ExrPart& part : reader.parts()) {
      if (part.deep) {
        read_deep(reader, {{part.index, "Z"}, {}, {part.index, "A"}});
        continue;
      }
      std::vector<std::string> names;
      for (const ExrChannel& channel : part.channels) names.push_back(channel.name);
      reader.read(part.index, names);
      reader.read_stored(part.index, names);
    }
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::input) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

class DamagedExr : public testing::TestWithParam<std::vector<Imf::Header>> {
 protected:
  DamagedExr() {
    write_test_exr(dir_ / "whole.exr", GetParam());
    whole_ = bytes_of(dir_ / "whole.exr");
  }
  TempDir dir_;
  std::string whole_;
};

TEST_P(DamagedExr, CutShortIsAnError) {
  ASSERT_TRUE(reads(dir_ / "whole.exr"));
  for (std::size_t size = 0; size < whole_.size(); size += 1 + size / 64) {
    write_bytes(dir_ / "cut.exr", whole_.substr(0, size));
    reads(dir_ / "cut.exr");
  }
  write_bytes(dir_ / "cut.exr", whole_.substr(0, whole_.size() * 3 / 4));
  EXPECT_FALSE(reads(dir_ / "cut.exr"));
}

TEST_P(DamagedExr, FlippedBytesDoNoHarm) {
  std::mt19937 random(2024);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string bytes = whole_;
    // Half of the damage goes to the header, where it is most dangerous.
    const std::size_t range = i % 2 ? whole_.size() : std::min<std::size_t>(whole_.size(), 600);
    const std::size_t place = 4 + random() % (range - 4);
    bytes[place] = char(bytes[place] ^ (1 + random() % 255));
    SCOPED_TRACE(testing::Message() << "flip " << i << " at byte " << place);
    write_bytes(dir_ / "flipped.exr", bytes);
    refused += !reads(dir_ / "flipped.exr");
  }
  EXPECT_GT(refused, 20);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, DamagedExr,
    testing::Values(scanline_file(Imf::ZIP_COMPRESSION), scanline_file(Imf::PIZ_COMPRESSION),
                    scanline_file(Imf::RLE_COMPRESSION), scanline_file(Imf::NO_COMPRESSION),
                    scanline_file(Imf::PXR24_COMPRESSION), scanline_file(Imf::B44_COMPRESSION),
                    scanline_file(Imf::DWAA_COMPRESSION), tiled_file(), multi_part_file()));

TEST(DamagedExr, UnfinishedFilesAreIncomplete) {
  const TempDir dir;
  {
    const std::vector<Imf::Header> headers = scanline_file(Imf::ZIP_COMPRESSION);
    Imf::MultiPartOutputFile file((dir / "a.exr").c_str(), headers.data(), 1);
    Imf::OutputPart part(file, 0);
    const TestPixels pixels(headers[0], headers[0].dataWindow());
    part.setFrameBuffer(pixels.frame_buffer());
    part.writePixels(17);
  }
  const std::vector<std::string> names = {"Z"};
  EXPECT_THAT(error_of([&] { ExrReader(dir / "a.exr").read(0, names); }),
              IsError(ExitCode::input, "a.exr: is incomplete"));
}

/// Two parts with a channel "a", the first of them of a type that begins with xxxx.
ExrBytes of_unknown_type(const TempDir& dir) {
  Imf::Header part = test_header({{0, 0}, {7, 7}}, {{"a", Imf::FLOAT}}, Imf::ZIP_COMPRESSION),
              other = part;
  part.setName("part"), other.setName("other");
  write_test_exr(dir / "two_parts.exr", {part, other});
  ExrBytes bytes(dir / "two_parts.exr");
  bytes.put_int(bytes.value_of("type"), 0x78787878);
  return bytes;
}

TEST(DamagedExr, SubsamplingByNothingIsRefusedInPartsOfAnyType) {
  const TempDir dir;
  ExrBytes bytes = of_unknown_type(dir);
  const std::string name_and_end = "a0";
  bytes.put_int(bytes.value_of("channels") + name_and_end.size() + 8, 0);
  bytes.write(dir / "a.exr");
  // OpenEXR 3.4 takes such a list for none.
  EXPECT_THAT(error_of([&] { const ExrReader reader(dir / "a.exr"); }),
              testing::AnyOf(IsError(ExitCode::input, "channel 'a' is subsampled 0x1"),
                             IsError(ExitCode::input, "'channels' attribute not found")));
}

TEST(DamagedExr, PartsOfUnknownTypeHaveNoPixels) {
  const TempDir dir;
  ExrBytes bytes = of_unknown_type(dir);
  bytes.write(dir / "a.exr");
  const ExrReader reader(dir / "a.exr");
  const std::vector<std::string> names = {"a"};
  EXPECT_THAT(error_of([&] { reader.read(0, names); }),
              IsError(ExitCode::input, "part 0 'part' is of the type 'xxxx"));
}

/// OpenEXR takes whole floats, and what is left over as the next attribute.
TEST(DamagedExr, AListOfFloatsHasWholeOnes) {
  const TempDir dir;
  std::string bytes("\x76\x2f\x31\x01\2\0\0\0multiView\0floatvector\0", 30);
  write_bytes(dir / "a.exr", bytes + std::string("\7\0\0\0", 4) + std::string(100, 'x'));
  EXPECT_THAT(error_of([&] { ExrReader reader(dir / "a.exr"); }),
              IsError(ExitCode::input, "'multiView' claims 7 bytes, and its value takes 4"));
}

TEST(DamagedExr, AListOfAQuarterOfAMillionChannelsIsRefused) {
  const TempDir dir;
  const std::size_t size = 5 << 20;
  std::string bytes("\x76\x2f\x31\x01\2\0\0\0channels\0chlist\0", 24);
  for (int i = 0; i < 4; ++i) bytes += char(size >> 8 * i);
  write_bytes(dir / "a.exr", bytes + std::string(size, 'x'));
  EXPECT_THAT(error_of([&] { ExrReader reader(dir / "a.exr"); }),
              IsError(ExitCode::input, "a.exr: lists 5120 KiB of channels"));
}

TEST(DamagedExr, AbsurdSizesAreRefusedBeforeAllocation) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", scanline_file(Imf::ZIP_COMPRESSION));
  std::string bytes = bytes_of(dir / "a.exr");
  const std::size_t window = bytes.find("dataWindow") + sizeof("dataWindow") + sizeof("box2i") + 4;
  const std::int32_t right = 1'000'000'000;
  std::memcpy(&bytes[window + 8], &right, 4);
  write_bytes(dir / "a.exr", bytes);
  const std::vector<std::string> names = {"R"};
  EXPECT_THAT(error_of([&] { ExrReader(dir / "a.exr").read(0, names); }),
              IsError(ExitCode::input, "GiB of pixels, which a file of"));
}

// OpenEXR makes room for a whole row of tiles, however small the image is.
TEST(DamagedExr, AbsurdTilesAreRefusedBeforeAllocation) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", tiled_file());
  std::string bytes = bytes_of(dir / "a.exr");
  const std::size_t side = bytes.find("tiles") + sizeof("tiles") + sizeof("tiledesc") + 4;
  const std::uint32_t absurd = 1 << 15;
  std::memcpy(&bytes[side], &absurd, 4);
  std::memcpy(&bytes[side + 4], &absurd, 4);
  write_bytes(dir / "a.exr", bytes);
  const std::vector<std::string> names = {"R"};
  EXPECT_THAT(error_of([&] { ExrReader(dir / "a.exr").read(0, names); }),
              IsError(ExitCode::input, "claims 10.0 GiB of pixels, which a file of"));
}

TEST(DamagedExr, TilesMayBeLargerThanTheImage) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", {tiled(test_header(Box2i({0, 0}, {7, 7}), kChannels), 4096)});
  EXPECT_TRUE(reads(dir / "a.exr"));
}

}  // namespace
}  // namespace ssdo::test::exr_damage_test
