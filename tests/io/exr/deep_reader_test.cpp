// SPDX-License-Identifier: Apache-2.0
#include "io/exr/deep_reader.h"

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <random>

#include "support/deep_file.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/run_tool.h"
#include "support/temp_dir.h"

namespace ssdo::test::deep_reader_test {
namespace {

/// Zero to four samples in a pixel, of values that half stores exactly.
DeepPixels pattern(const Window& window) {
  DeepPixels pixels(window);
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      for (int i = 0; i < test_value(0, x, y) % 5; ++i) {
        const float front = float(test_value(1, x, y) + 8 * i);
        pixels.at(x, y).push_back({front, front + 2, 0.25f * float(i + 1)});
      }
    }
  }
  return pixels;
}

void expect_same(const DeepImage& image, DeepPixels pixels, bool backs = true, bool alphas = true) {
  ASSERT_EQ(image.window, pixels.window);
  for (int y = pixels.window.y0; y < pixels.window.y1; ++y) {
    for (int x = pixels.window.x0; x < pixels.window.x1; ++x) {
      const auto& expected = pixels.at(x, y);
      const auto found = image.at(x, y);
      ASSERT_EQ(found.size(), expected.size()) << x << ", " << y;
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found[i].front, expected[i].front) << x << ", " << y;
        ASSERT_EQ(found[i].back, backs ? expected[i].back : expected[i].front);
        ASSERT_EQ(found[i].alpha, alphas ? expected[i].alpha : 1);
      }
    }
  }
}

const DeepChannels kUsual = {{0, "Z"}, {0, "ZBack"}, {0, "A"}};

TEST(DeepReader, ReadsScanlinesAndTilesOfAnyWindow) {
  const TempDir dir;
  for (const Window& window : {Window{-3, 7, 30, 47}, {0, 0, 1, 1}, {-40, -50, -2, -10}}) {
    for (const bool tiles : {false, true}) {
      for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
        const DeepPixels pixels = pattern(window);
        write_deep(dir / "a.exr",
                   {{.pixels = pixels, .tiles = tiles, .type = type, .display = {0, 0, 64, 64}}});
        const DeepImage image = read_deep(ExrReader(dir / "a.exr"), kUsual);
        expect_same(image, pixels);
        EXPECT_EQ(image.display, (Window{0, 0, 64, 64}));
        EXPECT_EQ(image.half, type == Imf::HALF);
        EXPECT_TRUE(image.at(window.x1, window.y0).empty()) << "nothing outside of the window";
      }
    }
  }
}

TEST(DeepReader, ReadsTheFileThatIsOpen) {
  const TempDir dir;
  const DeepPixels pixels = pattern({-3, 7, 30, 47});
  write_deep(dir / "a.exr", {{.pixels = pixels}});
  const ExrReader file(dir / "a.exr");
  std::filesystem::remove(dir / "a.exr");
  expect_same(read_deep(file, kUsual), pixels);
}

TEST(DeepReader, TakesSurfacesAndOpaqueSamplesWhereNothingElseIsWritten) {
  const TempDir dir;
  const DeepPixels pixels = pattern({0, 0, 20, 20});
  write_deep(dir / "a.exr", {{.pixels = pixels, .back = "", .alpha = ""}});
  expect_same(read_deep(ExrReader(dir / "a.exr"), {{0, "Z"}, {}, {}}), pixels, false, false);
}

TEST(DeepReader, TakesChannelsOfSeveralPartsWithTheSameSamples) {
  const TempDir dir;
  const DeepPixels pixels = pattern({0, 0, 20, 20});
  DeepPart depth{.pixels = pixels, .name = "depth", .alpha = ""},
      color{.pixels = pixels, .name = "color", .front = "", .back = ""};
  write_deep(dir / "a.exr", {depth, color});
  const DeepChannels channels = {{0, "Z"}, {0, "ZBack"}, {1, "A"}};
  expect_same(read_deep(ExrReader(dir / "a.exr"), channels), pixels);
  color.pixels.at(3, 4).push_back({1, 1, 1});
  write_deep(dir / "b.exr", {depth, color});
  EXPECT_THAT(error_of([&] { read_deep(ExrReader(dir / "b.exr"), channels); }),
              IsError(ExitCode::input, "do not hold the same samples"));
}

TEST(DeepReader, RefusesFilesThatAreCutShort) {
  const TempDir dir;
  for (const bool tiles : {false, true}) {
    write_deep(dir / "a.exr", {{.pixels = pattern({0, 0, 64, 64}), .tiles = tiles}});
    std::filesystem::resize_file(dir / "a.exr", std::filesystem::file_size(dir / "a.exr") * 2 / 3);
    EXPECT_THAT(error_of([&] { read_deep(ExrReader(dir / "a.exr"), kUsual); }),
                IsError(ExitCode::input, "a.exr: is "));
  }
}

/// The chunks of pattern({0, 0, 64, 64}), written with one row or 16 x 16 pixels in each.
std::size_t chunks_of(bool tiles) { return tiles ? 16 : 64; }

/// Reads a file that lacks some chunks, and expects all samples of the others, and no more.
void expect_salvaged(const std::filesystem::path& path, const std::string& loss) {
  const ExrReader file(path, Salvage::done);
  DeepPixels expected = pattern({0, 0, 64, 64});
  const DeepImage image = read_deep(file, kUsual);
  for (const Window& gap : file.missing(0).windows) {
    for (int y = gap.y0; y < gap.y1; ++y)
      for (int x = gap.x0; x < gap.x1; ++x) expected.at(x, y).clear();
  }
  expect_same(image, expected);
  EXPECT_THAT(file.losses(), testing::ElementsAre(testing::HasSubstr(loss)));
}

TEST(DeepReader, SalvagesTheChunksThatAreThere) {
  const TempDir dir;
  for (const bool tiles : {false, true}) {
    write_deep(dir / "a.exr", {{.pixels = pattern({0, 0, 64, 64}), .tiles = tiles}});
    ExrBytes bytes(dir / "a.exr");
    const std::vector<std::uint64_t> places = bytes.places(chunks_of(tiles));
    ExrBytes cut = bytes;
    cut.cut(std::size_t(places[places.size() / 2]) + 9);
    cut.write(dir / "a.exr");
    expect_salvaged(dir / "a.exr", tiles ? "8 of 16 tiles are missing or damaged"
                                         : "32 of 64 rows are missing or damaged");
    EXPECT_THAT(error_of([&] { read_deep(ExrReader(dir / "a.exr", Salvage::offered), kUsual); }),
                IsError(ExitCode::input, "--allow-partial"));
    // The second chunk, in its samples: their packed bytes are the last of it.
    bytes.put_text(std::size_t(places[2]) - 6, "\xff\xff\xff\xff\xff\xff");
    bytes.write(dir / "a.exr");
    expect_salvaged(dir / "a.exr", tiles ? "1 of 16 tiles" : "1 of 64 rows");
  }
}

TEST(DeepReader, RefusesFilesOfWhichNothingIsLeft) {
  const TempDir dir;
  for (const bool tiles : {false, true}) {
    write_deep(dir / "a.exr", {{.pixels = pattern({0, 0, 64, 64}), .tiles = tiles}});
    ExrBytes bytes(dir / "a.exr");
    bytes.cut(std::size_t(bytes.places(chunks_of(tiles))[0]) + 9);
    bytes.write(dir / "a.exr");
    EXPECT_THAT(error_of([&] { read_deep(ExrReader(dir / "a.exr", Salvage::done), kUsual); }),
                IsError(ExitCode::input, "none of its chunks can be read"));
  }
}

// OpenEXR makes room for the counts of a whole tile, and multiplies its sides as ints.
TEST(DeepReader, RefusesTilesThatNoFileHolds) {
  const TempDir dir;
  write_deep(dir / "a.exr", {{.pixels = pattern({0, 0, 8, 8}), .tiles = true}});
  std::string bytes = read_file(dir / "a.exr");
  const std::size_t sides = bytes.find("tiles") + sizeof("tiles") + sizeof("tiledesc") + 4;
  const auto read_with_side = [&](std::uint32_t side) {
    std::memcpy(&bytes[sides], &side, 4);
    std::memcpy(&bytes[sides + 4], &side, 4);
    std::ofstream(dir / "b.exr", std::ios::binary) << bytes;
    return error_of([&] { read_deep(ExrReader(dir / "b.exr"), {{0, "Z"}, {}, {}}); });
  };
  const auto refused = IsError(ExitCode::input, "GiB of pixels, which a file of");
  EXPECT_THAT(read_with_side(1 << 13), refused);
  bytes.resize(3 << 20);  // which may hold 6 GiB
  EXPECT_THAT(read_with_side(30000), refused);
}

/// Whatever the bytes are, reading ends in samples or in an ssdo::Error.
TEST(DeepReader, FlippedBytesDoNoHarm) {
  const TempDir dir;
  std::mt19937 random(2026);
  for (const bool tiles : {false, true}) {
    write_deep(dir / "a.exr", {{.pixels = pattern({-2, 3, 30, 41}), .tiles = tiles}});
    const std::string whole = read_file(dir / "a.exr");
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
      std::string bytes = whole;
      const std::size_t range = i % 2 ? whole.size() : std::min<std::size_t>(whole.size(), 600),
                        place = 4 + random() % (range - 4);
      bytes[place] = char(bytes[place] ^ (1 + random() % 255));
      SCOPED_TRACE(testing::Message() << "flip " << i << " at byte " << place);
      std::ofstream(dir / "b.exr", std::ios::binary) << bytes;
      try {
        read_deep(ExrReader(dir / "b.exr"), kUsual);
      } catch (const Error& error) {
        EXPECT_EQ(error.code, ExitCode::input) << error.what();
        ++refused;
      }
    }
    EXPECT_GT(refused, 20);
  }
}

/// OpenEXR allocates the counts of whole tiles.
TEST(DeepReader, RefusesTilesThatTheFileCannotHold) {
  const TempDir dir;
  write_deep(dir / "a.exr", {{.pixels = pattern({0, 0, 4, 4}), .tiles = true}});
  ExrBytes bytes(dir / "a.exr");
  for (const std::size_t side : {0, 4}) bytes.put_int(bytes.value_of("tiles") + side, 30000);
  bytes.write(dir / "a.exr");
  EXPECT_THAT(error_of([&] { read_deep(ExrReader(dir / "a.exr"), kUsual); }),
              IsError(ExitCode::input, "a.exr: is damaged: its header claims 3.4 GiB"));
}

}  // namespace
}  // namespace ssdo::test::deep_reader_test
