// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_reader.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::exr_reader_test {
namespace {

using Imath::Box2i;

const std::vector<TestChannel> kMixed = {
    {"a.half", Imf::HALF}, {"b.float", Imf::FLOAT}, {"c.uint", Imf::UINT}};
const std::vector<std::string> kMixedNames = {"a.half", "b.float", "c.uint"};

void expect_test_values(const Plane<float>& plane, int channel, const Window& window) {
  ASSERT_EQ(plane.width, window.width());
  ASSERT_EQ(plane.height, window.height());
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      ASSERT_EQ(plane(x, y), float(test_value(channel, window.x0 + x, window.y0 + y)))
          << "channel " << channel << ", pixel " << x << ", " << y;
    }
  }
}

void expect_reads_test_values(const std::filesystem::path& path, int part,
                              const std::vector<std::string>& names) {
  const ExrReader reader(path);
  const std::vector<Plane<float>> planes = reader.read(part, names);
  ASSERT_EQ(planes.size(), names.size());
  for (std::size_t c = 0; c < planes.size(); ++c) {
    expect_test_values(planes[c], int(c), reader.parts()[std::size_t(part)].data_window);
  }
}

TEST(ExrReader, ReadsEveryLosslessCompressionAndLineOrder) {
  const TempDir dir;
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      SCOPED_TRACE(testing::Message() << "compression " << compression << ", order " << order);
      Imf::Header header = test_header(Box2i({-3, -5}, {40, 61}), kMixed, compression);
      header.lineOrder() = order;
      write_test_exr(dir / "a.exr", {header});
      expect_reads_test_values(dir / "a.exr", 0, kMixedNames);
    }
  }
}

TEST(ExrReader, ReadsLossyCompressions) {
  const TempDir dir;
  // Lossless for what they do not touch: uint everywhere, half in PXR24, names without a colour.
  for (const auto compression :
       {Imf::PXR24_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {70, 300}), kMixed, compression)});
    expect_reads_test_values(dir / "a.exr", 0, kMixedNames);
  }
  for (const auto compression : {Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION}) {
    write_test_exr(
        dir / "a.exr",
        {test_header(Box2i({0, 0}, {70, 80}), {{"a", Imf::FLOAT}, {"b", Imf::UINT}}, compression)});
    const std::vector<std::string> names = {"a", "b"};
    expect_reads_test_values(dir / "a.exr", 0, names);
  }
}

TEST(ExrReader, ReadsTheFullResolutionOfTiles) {
  const TempDir dir;
  for (const auto mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y, Imf::RANDOM_Y}) {
      SCOPED_TRACE(testing::Message() << "mode " << mode << ", order " << order);
      Imf::Header header = tiled(test_header(Box2i({-7, 9}, {53, 44}), kMixed), 16, mode);
      header.lineOrder() = order;
      write_test_exr(dir / "a.exr", {header});
      expect_reads_test_values(dir / "a.exr", 0, kMixedNames);
    }
  }
}

TEST(ExrReader, ReadsWindowsAnywhere) {
  const TempDir dir;
  const int far = 1'000'000'000;
  for (const Box2i& box :
       {Box2i({0, 0}, {0, 0}), Box2i({-1, -1}, {-1, -1}), Box2i({far, far}, {far + 8, far + 4}),
        Box2i({-far, -far}, {8 - far, 4 - far})}) {
    SCOPED_TRACE(testing::Message() << "from " << box.min.x << ", " << box.min.y);
    write_test_exr(dir / "lines.exr", {test_header(box, kMixed)});
    expect_reads_test_values(dir / "lines.exr", 0, kMixedNames);
    write_test_exr(dir / "tiles.exr", {tiled(test_header(box, kMixed), 4)});
    expect_reads_test_values(dir / "tiles.exr", 0, kMixedNames);
  }
}

TEST(ExrReader, DescribesItsParts) {
  const TempDir dir;
  Imf::Header left = named(test_header(Box2i({-2, -3}, {5, 6}), {{"layer one.R", Imf::HALF}}), "l");
  left.displayWindow() = Box2i({0, 0}, {9, 9});
  left.setView("left");
  Imf::Header right = named(tiled(test_header(Box2i({1, 1}, {3, 3}), {{"P.X"}, {"P.Y"}}), 8), "r");
  right.displayWindow() = left.displayWindow();
  write_test_exr(dir / "a.exr", {left, right});

  const ExrReader reader(dir / "a.exr");
  ASSERT_EQ(reader.parts().size(), 2u);
  const ExrPart& first = reader.parts()[0];
  EXPECT_EQ(first.name, "l");
  EXPECT_EQ(first.view, "left");
  EXPECT_FALSE(first.deep);
  EXPECT_EQ(first.data_window, (Window{-2, -3, 6, 7}));
  EXPECT_EQ(first.display_window, (Window{0, 0, 10, 10}));
  ASSERT_EQ(first.channels.size(), 1u);
  EXPECT_EQ(first.channels[0].name, "layer one.R");
  EXPECT_EQ(first.channels[0].type, Imf::HALF);
  EXPECT_EQ(reader.parts()[1].view, "");
  EXPECT_EQ(reader.parts()[1].channels[1].name, "P.Y");

  const std::vector<std::string> first_names = {"layer one.R"}, second_names = {"P.X", "P.Y"};
  expect_reads_test_values(dir / "a.exr", 0, first_names);
  expect_reads_test_values(dir / "a.exr", 1, second_names);
}

TEST(ExrReader, SinglePartMayLackAName) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {3, 3}), kMixed)});
  EXPECT_EQ(ExrReader(dir / "a.exr").parts()[0].name, "");
}

TEST(ExrReader, ReadsChannelsInTheOrderAskedForAndRepeatedly) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {7, 7}), kMixed)});
  const ExrReader reader(dir / "a.exr");
  const std::vector<std::string> names = {"c.uint", "a.half", "c.uint"};
  const auto planes = reader.read(0, names);
  const int channel[] = {2, 0, 2};
  for (int i = 0; i < 3; ++i) {
    expect_test_values(planes[std::size_t(i)], channel[i], reader.parts()[0].data_window);
  }
}

// A renderer moves its new frame over the one that is read, or a cleaner removes that.
TEST(ExrReader, ReadsTheFileThatItHasOpened) {
  const TempDir dir;
  const Box2i window({-3, -5}, {40, 61});
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
    const Imf::Header lines = test_header(window, kMixed, compression);
    for (const Imf::Header& header : {lines, tiled(lines, 16)}) {
      SCOPED_TRACE(testing::Message() << "compression " << compression);
      write_test_exr(dir / "a.exr", {header});
      const ExrReader reader(dir / "a.exr");
      const std::vector<Plane<float>> planes = reader.read(0, kMixedNames);
      write_test_exr(dir / "b.exr", {test_header(Box2i({7, 7}, {46, 89}), kMixed, compression)});
      std::filesystem::rename(dir / "b.exr", dir / "a.exr");
      EXPECT_EQ(reader.read(0, kMixedNames)[1].pixels, planes[1].pixels);
      std::ofstream(dir / "empty.exr").close();
      std::filesystem::rename(dir / "empty.exr", dir / "a.exr");
      EXPECT_EQ(reader.read(0, kMixedNames)[1].pixels, planes[1].pixels);
      std::filesystem::remove(dir / "a.exr");
      EXPECT_EQ(reader.read(0, kMixedNames)[1].pixels, planes[1].pixels);
    }
  }
}

TEST(ExrReader, DeepPartsAreRefusedOnlyWhenRead) {
  const TempDir dir;
  Imf::Header deep = named(test_header(Box2i({0, 0}, {7, 7}), {{"A"}, {"Z"}}), "deep");
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.setType(Imf::DEEPSCANLINE);
  write_test_exr(dir / "a.exr", {deep, named(test_header(Box2i({0, 0}, {7, 7}), kMixed), "flat")});

  const ExrReader reader(dir / "a.exr");
  EXPECT_TRUE(reader.parts()[0].deep);
  expect_reads_test_values(dir / "a.exr", 1, kMixedNames);
  const std::vector<std::string> depth = {"Z"};
  EXPECT_THAT(error_of([&] { reader.read(0, depth); }),
              IsError(ExitCode::input, "a.exr: is a deep image (part 0 'deep')"));
}

TEST(ExrReader, ReadsStoredBits) {
  const TempDir dir;
  const std::vector<TestChannel> channels = {
      {"h", Imf::HALF}, {"id", Imf::UINT}, {"sub", Imf::HALF, 2}};
  const Imf::Header header = test_header(Box2i({-4, -4}, {3, 5}), channels);
  write_test_exr(dir / "a.exr", {header});
  const ExrReader reader(dir / "a.exr");
  const std::vector<std::string> names = {"id", "sub"};
  const auto stored = reader.read_stored(0, names);
  ASSERT_EQ(stored[0].pixels.size(), 8u * 10u * 4u);
  ASSERT_EQ(stored[1].pixels.size(), 4u * 5u * 2u);
  std::uint32_t id = 0;
  std::memcpy(&id, stored[0].pixels.data() + 4 * (8 * 2 + 3), 4);
  EXPECT_EQ(id, std::uint32_t(test_value(1, -1, -2)));
  half sub;
  std::memcpy(&sub, stored[1].pixels.data() + 2 * (4 * 3 + 2), 2);
  EXPECT_EQ(float(sub), float(test_value(2, 0, 2)));
  EXPECT_THAT(error_of([&] { reader.read(0, names); }),
              IsError(ExitCode::input, "'sub' of part 0 is subsampled 2x2"));
}

TEST(ExrReader, SaysWhatIsWrongWithTheFile) {
  const TempDir dir;
  EXPECT_THAT(error_of([&] { ExrReader(dir / "none.exr"); }),
              IsError(ExitCode::input, "none.exr: does not exist"));
  EXPECT_THAT(error_of([&] { ExrReader(dir.path()); }), IsError(ExitCode::input, "is a folder"));
  EXPECT_THAT(error_of([&] { ExrReader("/dev/null"); }), IsError(ExitCode::input, "is a device"));
  std::ofstream(dir / "empty.exr");
  EXPECT_THAT(error_of([&] { ExrReader(dir / "empty.exr"); }),
              IsError(ExitCode::input, "is empty"));
  std::ofstream(dir / "text.exr") << "a text";
  EXPECT_THAT(error_of([&] { ExrReader(dir / "text.exr"); }),
              IsError(ExitCode::input, "is not an EXR file"));
  std::ofstream(dir / "short.exr") << "\x76\x2f\x31\x01\x02";
  EXPECT_THAT(error_of([&] { ExrReader(dir / "short.exr"); }),
              IsError(ExitCode::input, "cut short in its header"));
}

TEST(ExrReader, SaysWhatAPartLacks) {
  const TempDir dir;
  write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {3, 3}), kMixed)});
  const ExrReader reader(dir / "a.exr");
  const std::vector<std::string> names = {"R"};
  EXPECT_THAT(error_of([&] { reader.read(0, names); }),
              IsError(ExitCode::input, "has no channel 'R' in part 0"));
  EXPECT_THAT(error_of([&] { reader.read(1, names); }),
              IsError(ExitCode::input, "has no part 1; its parts are 0 to 0"));
}

}  // namespace
}  // namespace ssdo::test::exr_reader_test
