// SPDX-License-Identifier: Apache-2.0
//
// Rows of a file, and one pixel of every block.
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include "io/exr/exr_reader.h"
#include "io/size_guard.h"
#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::exr_grid_test {
namespace {

using Imath::Box2i;

const std::vector<TestChannel> kChannels = {{"a", Imf::HALF}, {"b", Imf::FLOAT}};
const std::vector<std::string> kNames = {"b", "a"};
constexpr Window kWindow{-3, -5, 62, 300};

class ExrGrid : public testing::Test {
 protected:
  /// Calls `check(reader)` for files of several kinds.
  template <class Check>
  void for_each_file(const Check& check) const {
    const Box2i box({kWindow.x0, kWindow.y0}, {kWindow.x1 - 1, kWindow.y1 - 1});
    for (const auto compression :
         {Imf::NO_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      for (const bool in_tiles : {false, true}) {
        SCOPED_TRACE(testing::Message() << "compression " << compression << ", tiles " << in_tiles);
        const Imf::Header header = test_header(box, kChannels, compression);
        write_test_exr(dir_ / "a.exr", {in_tiles ? tiled(header, 32) : header});
        check(ExrReader(dir_ / "a.exr"));
      }
    }
  }

  TempDir dir_;
};

TEST_F(ExrGrid, GivesRows) {
  for_each_file([](const ExrReader& reader) {
    for (const auto& [y0, y1] : {std::pair{-5, 20}, {17, 130}, {299, 300}, {200, 900}}) {
      const PixelGrid grid{.y0 = y0, .y1 = y1};
      const Window rows = grid.of(kWindow);
      const auto planes = reader.read(0, kNames, grid);
      ASSERT_EQ(planes[0].height, rows.height());
      ASSERT_EQ(planes[0].width, kWindow.width());
      for (int y = rows.y0; y < rows.y1; ++y) {
        for (int x = rows.x0; x < rows.x1; ++x) {
          ASSERT_EQ(planes[0](x - rows.x0, y - rows.y0), float(test_value(1, x, y)))
              << x << " " << y;
          ASSERT_EQ(planes[1](x - rows.x0, y - rows.y0), float(test_value(0, x, y)))
              << x << " " << y;
        }
      }
    }
  });
}

TEST_F(ExrGrid, GivesTheMiddlesOfBlocks) {
  for_each_file([](const ExrReader& reader) {
    for (const int stride : {3, 8}) {
      const PixelGrid grid{.stride = stride, .origin_x = 1, .origin_y = -2};
      const Window blocks = grid.of(kWindow);
      const auto planes = reader.read(0, kNames, grid);
      ASSERT_EQ(planes[0].width, blocks.width());
      ASSERT_EQ(planes[0].height, blocks.height());
      for (int y = blocks.y0; y < blocks.y1; ++y) {
        for (int x = blocks.x0; x < blocks.x1; ++x) {
          ASSERT_EQ(planes[0](x - blocks.x0, y - blocks.y0),
                    float(test_value(1, grid.middle_x(x), grid.middle_y(y))))
              << x << " " << y;
        }
      }
    }
  });
}

// OpenEXR would take its reader of tiles for one of lines, and crash.
TEST_F(ExrGrid, GivesRowsOfAnOpenFileThatWasReadAsAWhole) {
  for_each_file([](const ExrReader& reader) {
    const PixelGrid grid{.y0 = 17, .y1 = 130};
    const auto rows = reader.read(0, kNames, grid), whole = reader.read(0, kNames),
               rows_again = reader.read(0, kNames, grid);
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      EXPECT_EQ(whole[i](7, 30), float(test_value(i == 0, 4, 25)));
      EXPECT_EQ(rows_again[i].pixels, rows[i].pixels);
    }
  });
}

TEST_F(ExrGrid, GivesNoRowsWhereThereAreNone) {
  for_each_file([](const ExrReader& reader) {
    EXPECT_EQ(reader.read(0, kNames, {.y0 = 400, .y1 = 500})[0].height, 0);
  });
}

/// An overview is small, and the rows of a frame this wide, which it is read from, are not.
TEST_F(ExrGrid, CountsTheRowsThatAnOverviewIsReadFrom) {
  constexpr int kWidth = 1 << 20, kHeight = 8192, kStrip = 64 * kOverviewStride;
  const int count = int(physical_memory() / (4.0 * kWidth * kStrip)) + 1;
  std::vector<TestChannel> channels;
  for (int i = 0; i < count; ++i) channels.push_back({"c" + std::to_string(i), Imf::FLOAT});
  const std::filesystem::path file = dir_ / "wide.exr";
  {
    const Imf::Header header =
        test_header(Box2i({0, 0}, {kWidth - 1, kHeight - 1}), channels, Imf::DWAA_COMPRESSION);
    const Imf::TiledOutputFile begun(file.c_str(), tiled(header, 512));
  }
  std::filesystem::resize_file(file, 64 << 20);  // which might hold so many pixels
  std::vector<std::string> names;
  for (const TestChannel& channel : channels) names.push_back(channel.name);
  const ExrReader reader(file);
  EXPECT_THAT(error_of([&] { reader.read(0, names, PixelGrid{.stride = kOverviewStride}); }),
              IsError(ExitCode::input, "of memory for its pixels"));
}

}  // namespace
}  // namespace ssdo::test::exr_grid_test
