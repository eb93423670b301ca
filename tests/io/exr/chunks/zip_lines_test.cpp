// SPDX-License-Identifier: Apache-2.0
//
// Chunks of ZIP and ZIPS by our own code against OpenEXR's reader, bit for bit.
#include "io/exr/chunks/zip_lines.h"

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "io/exr/exr_reader.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::zip_lines_test {
namespace {

using Imath::Box2i;

using Bytes = std::vector<std::byte>;

/// The channels of the first part in the types of `to`, by one reader or the other.
std::vector<Bytes> buffers(const ExrPart& part, std::vector<ChannelRows>& to) {
  std::vector<Bytes> read;
  for (ChannelRows& rows : to) {
    const bool two_bytes = rows.channel.type == Imf::HALF && !rows.as_float;
    read.emplace_back(part.data_window.area() * (two_bytes ? 2 : 4));
    rows.pixels = read.back().data();
  }
  return read;
}

/// The same with one not-a-number: some processors mark it where they turn half into float, which
/// OpenEXR from 3.1.13 on leaves to them.
std::vector<Bytes> with_one_nan(std::vector<Bytes> read, const ChannelRows& form) {
  if (!form.as_float) return read;
  for (Bytes& bytes : read) {
    for (std::size_t i = 0; i + sizeof(float) <= bytes.size(); i += sizeof(float)) {
      float value;
      std::memcpy(&value, &bytes[i], sizeof value);
      if (std::isnan(value)) value = std::numeric_limits<float>::quiet_NaN();
      std::memcpy(&bytes[i], &value, sizeof value);
    }
  }
  return read;
}

std::vector<Bytes> by_openexr(const ExrReader& reader, std::vector<ChannelRows> to) {
  const ExrPart& part = reader.parts().front();
  std::vector<Bytes> read = buffers(part, to);
  Imf::FrameBuffer frame_buffer;
  for (const ChannelRows& rows : to)
    frame_buffer.insert(rows.channel.name,
                        Imf::Slice::Make(rows.as_float ? Imf::FLOAT : rows.channel.type,
                                         rows.pixels, part.header.dataWindow()));
  Imf::InputPart lines(reader.file(), 0);
  lines.setFrameBuffer(frame_buffer);
  lines.readPixels(part.data_window.y0, part.data_window.y1 - 1);
  return read;
}

/// Writes one part with these values in every channel.
void write_pixels(const std::filesystem::path& path, const Imf::Header& header,
                  const std::vector<Bytes>& channels) {
  Imf::MultiPartOutputFile file(path.c_str(), &header, 1);
  Imf::OutputPart part(file, 0);
  Imf::FrameBuffer frame_buffer;
  std::size_t k = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++k)
    frame_buffer.insert(
        c.name(), Imf::Slice::Make(c.channel().type, channels[k].data(), header.dataWindow()));
  part.setFrameBuffer(frame_buffer);
  part.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
}

const std::vector<TestChannel> kChannels = {
    {"a.half", Imf::HALF}, {"b.float", Imf::FLOAT}, {"c.uint", Imf::UINT}, {"d.half", Imf::HALF}};

/// Each channel of a part once as it is stored and, but for uint, once as float.
std::vector<ChannelRows> all_forms(const ExrPart& part) {
  std::vector<ChannelRows> to;
  for (const ExrChannel& channel : part.channels) {
    to.push_back({channel, nullptr, false});
    if (channel.type != Imf::UINT) to.push_back({channel, nullptr, true});
  }
  return to;
}

TEST(ZipLines, AreThoseOfOpenExr) {
  const TempDir dir;
  std::mt19937 random(7);
  const Box2i windows[] = {Box2i({-3, -5}, {41, 61}), Box2i({0, 0}, {0, 0}),
                           Box2i({5, 2}, {132, 17}), Box2i({0, 0}, {6, 100})};
  for (const auto compression : {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
    for (const Box2i& window : windows) {
      // Any bits, not-a-number and denormals among them; few different ones, which compress; and
      // both within a file, so that some chunks are stored as they are.
      for (const unsigned kinds : {0xffu, 0x03u, 0u}) {
        SCOPED_TRACE(testing::Message() << compression << ", " << window.max.x << ", " << kinds);
        const Imf::Header header = test_header(window, kChannels, compression);
        const auto area = std::size_t(window.size().x + 1) * std::size_t(window.size().y + 1);
        std::vector<Bytes> values;
        for (const TestChannel& channel : kChannels) {
          Bytes& bytes = values.emplace_back(area * (channel.type == Imf::HALF ? 2 : 4));
          for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = std::byte(random() & (kinds ? kinds : 2 * i < bytes.size() ? 0xff : 1));
        }
        write_pixels(dir / "a.exr", header, values);
        const ExrReader reader(dir / "a.exr");
        const ExrPart& part = reader.parts().front();
        // Whatever is read beside it, a float is read in one form only: by name, as OpenEXR does.
        for (const ChannelRows& form : all_forms(part)) {
          std::vector<ChannelRows> to = {form};
          const std::vector<Bytes> found = buffers(part, to);
          ASSERT_TRUE(read_zip_lines(reader, part, part.data_window, to));
          EXPECT_EQ(with_one_nan(found, form), with_one_nan(by_openexr(reader, to), form))
              << form.channel.name << form.as_float;
        }
        std::vector<ChannelRows> to;
        for (const ExrChannel& channel : part.channels) to.push_back({channel, nullptr, false});
        const std::vector<Bytes> found = buffers(part, to);
        ASSERT_TRUE(read_zip_lines(reader, part, part.data_window, to));
        EXPECT_EQ(found, values);
      }
    }
  }
}

TEST(ZipLines, ArePartsOfAFile) {
  const TempDir dir;
  const Imf::Header header = test_header(Box2i({0, 0}, {20, 40}), kChannels);
  write_test_exr(dir / "a.exr", {named(header, "one"), named(header, "two")});
  const ExrReader reader(dir / "a.exr");
  const ExrPart& part = reader.parts()[1];
  std::vector<ChannelRows> to = {{part.channels[1], nullptr, true}};
  const std::vector<Bytes> found = buffers(part, to);
  ASSERT_TRUE(read_zip_lines(reader, part, part.data_window, to));
  float value;
  std::memcpy(&value, &found[0][4 * (3 * 21 + 5)], 4);
  EXPECT_EQ(value, float(test_value(1, 5, 3)));
}

/// Whether the last channel of a file is read without OpenEXR's reader.
bool reads_last_channel(const std::filesystem::path& path, bool as_float) {
  const ExrReader reader(path);
  const ExrPart& part = reader.parts().front();
  std::vector<ChannelRows> to = {{part.channels.back(), nullptr, as_float}};
  const std::vector<Bytes> found = buffers(part, to);
  return read_zip_lines(reader, part, part.data_window, to);
}

TEST(ZipLines, LeaveOtherPartsToOpenExr) {
  const TempDir dir;
  const Box2i window({0, 0}, {31, 31});
  const Imf::Header zip = test_header(window, {{"Z"}}),
                    piz = test_header(window, {{"Z"}}, Imf::PIZ_COMPRESSION),
                    subsampled = test_header(window, {{"Y", Imf::HALF, 2}, {"Z"}}),
                    tiles = tiled(zip, 16), ids = test_header(window, {{"Z", Imf::UINT}});
  const auto reads = [&](const Imf::Header& header) {
    write_test_exr(dir / "a.exr", {header});
    return reads_last_channel(dir / "a.exr", true);
  };
  EXPECT_TRUE(reads(zip));
  EXPECT_FALSE(reads(piz));
  EXPECT_FALSE(reads(subsampled));
  EXPECT_FALSE(reads(tiles));
  EXPECT_FALSE(reads(ids));
}

TEST(ZipLines, AreNotReadFromDamagedChunks) {
  const TempDir dir;
  constexpr int kLastRow = 32, kRows = 4;  // of the last chunk
  const Imf::Header header = test_header(Box2i({0, 0}, {31, kLastRow + kRows - 1}), {{"Z"}});
  write_test_exr(dir / "a.exr", {header});
  std::ifstream stream(dir / "a.exr", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  const auto reads = [&](const std::string& bytes) {
    std::ofstream(dir / "b.exr", std::ios::binary) << bytes;
    return reads_last_channel(dir / "b.exr", false);
  };
  EXPECT_TRUE(reads(whole));
  std::string flipped = whole;
  flipped[whole.size() - 10] = char(~flipped[whole.size() - 10]);
  EXPECT_FALSE(reads(flipped)) << "the checksum of the stream tells";
  EXPECT_FALSE(reads(whole.substr(0, whole.size() - 8)));

  const auto number_at = [&](std::size_t place) {
    int number = 0;
    std::memcpy(&number, &whole[place], sizeof number);
    return number;
  };
  std::size_t chunk = whole.size() - 8;
  while (number_at(chunk) != kLastRow ||
         chunk + 8 + std::size_t(number_at(chunk + 4)) != whole.size())
    ASSERT_GT(--chunk, 0u);
  // More than its rows have, but not more than those of a whole chunk; and less than nothing.
  for (const int size : {kRows * 32 * 4 + 1, -1}) {
    std::string resized = whole + std::string(1000, '\0');
    std::memcpy(&resized[chunk + 4], &size, sizeof size);
    EXPECT_FALSE(reads(resized)) << size;
  }
}

}  // namespace
}  // namespace ssdo::test::zip_lines_test
