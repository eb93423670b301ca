// SPDX-License-Identifier: Apache-2.0
//
// Files of our own chunks against OpenEXR: it reads their pixels, and their headers are those that
// it writes.
#include "io/exr/zip_output.h"

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <random>

#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::zip_output_test {
namespace {

using Imath::Box2i;

const std::vector<TestChannel> kChannels = {
    {"a.half", Imf::HALF}, {"b.float", Imf::FLOAT}, {"c.uint", Imf::UINT}, {"d.half", Imf::HALF}};

/// Values of all channels over a window.
class Pixels {
 public:
  explicit Pixels(const Imf::Header& header) {
    const Box2i& window = header.dataWindow();
    const auto area = std::size_t(window.size().x + 1) * std::size_t(window.size().y + 1);
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const Imf::PixelType type = c.channel().type;
      auto& bytes = values.emplace_back(area * (type == Imf::HALF ? 2 : 4));
      slices.insert(c.name(), Imf::Slice::Make(type, bytes.data(), window));
    }
  }
  std::vector<std::vector<std::byte>> values;
  Imf::FrameBuffer slices;
};

int lines_of(const Imf::Header& header) { return header.dataWindow().size().y + 1; }

void write_zip(const std::filesystem::path& path, const Imf::Header& header,
               const Imf::FrameBuffer& slices, int rows_at_once) {
  Imf::StdOFStream stream(path.c_str());
  ZipOutput out(stream, header);
  for (int y = 0; y < lines_of(header); y += rows_at_once)
    out.write(slices, std::min(rows_at_once, lines_of(header) - y));
  out.finish();
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(ZipOutput, IsReadByOpenExr) {
  const TempDir dir;
  std::mt19937 random(11);
  for (const auto compression : {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
    for (const Box2i& window : {Box2i({-3, -5}, {41, 61}), Box2i({0, 0}, {0, 0}),
                                Box2i({5, 2}, {132, 33}), Box2i({0, 0}, {600, 100})}) {
      // Any bits, which do not get smaller; few different ones; the same everywhere.
      for (const unsigned kinds : {0xffu, 0x03u, 0u}) {
        SCOPED_TRACE(testing::Message() << compression << ", " << window.max.x << ", " << kinds);
        const Imf::Header header = test_header(window, kChannels, compression);
        ASSERT_TRUE(ZipOutput::takes(header));
        Pixels written(header), found(header);
        for (auto& channel : written.values)
          for (std::byte& b : channel) b = std::byte(random() & kinds);
        write_zip(dir / "a.exr", header, written.slices, 32);
        Imf::MultiPartInputFile file((dir / "a.exr").c_str());
        EXPECT_TRUE(file.partComplete(0));
        Imf::InputPart part(file, 0);
        part.setFrameBuffer(found.slices);
        part.readPixels(window.min.y, window.max.y);
        EXPECT_EQ(found.values, written.values);
      }
    }
  }
}

constexpr std::size_t kChunks = 5;

/// All before the table of chunks, which begins with the place right behind it.
std::string header_of(const std::string& bytes) {
  for (std::size_t table = 0; table + 8 < bytes.size(); ++table) {
    std::uint64_t first = 0;
    std::memcpy(&first, &bytes[table], sizeof first);
    if (first == table + 8 * kChunks) return bytes.substr(0, table);
  }
  return "";
}

TEST(ZipOutput, HasTheHeaderThatOpenExrWrites) {
  const TempDir dir;
  Imf::Header header = test_header(Box2i({-3, -5}, {41, 61}), kChannels);
  header.insert("owner", Imf::StringAttribute("someone"));
  header.insert(std::string(40, 'n'),
                Imf::StringAttribute("a long name, which files have to flag"));
  for (const bool long_names : {false, true}) {
    if (long_names) header.channels().insert(std::string(60, 'z'), Imf::Channel(Imf::HALF));
    const Pixels black(header);
    write_zip(dir / "ours.exr", header, black.slices, 16);
    {
      Imf::MultiPartOutputFile file((dir / "theirs.exr").c_str(), &header, 1);
      Imf::OutputPart part(file, 0);
      part.setFrameBuffer(black.slices);
      part.writePixels(lines_of(header));
    }
    const std::string ours = bytes_of(dir / "ours.exr"), theirs = bytes_of(dir / "theirs.exr");
    EXPECT_EQ(header_of(ours), header_of(theirs));
    EXPECT_NE(header_of(ours), "");
  }
}

TEST(ZipOutput, LeavesOtherFilesToOpenExr) {
  const Box2i window({0, 0}, {31, 31});
  Imf::Header upwards = test_header(window, {{"Z"}});
  upwards.lineOrder() = Imf::DECREASING_Y;
  EXPECT_FALSE(ZipOutput::takes(upwards));
  EXPECT_FALSE(ZipOutput::takes(tiled(test_header(window, {{"Z"}}), 16)));
  EXPECT_FALSE(ZipOutput::takes(test_header(window, {{"Z"}}, Imf::PIZ_COMPRESSION)));
  EXPECT_FALSE(ZipOutput::takes(test_header(window, {{"Y", Imf::HALF, 2}, {"Z"}})));
}

}  // namespace
}  // namespace ssdo::test::zip_output_test
