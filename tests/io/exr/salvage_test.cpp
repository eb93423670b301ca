// SPDX-License-Identifier: Apache-2.0
//
// What is read of a part with missing chunks: all others, bit for bit.
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "io/exr/exr_reader.h"
#include "stopwatch.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::salvage_test {
namespace {

using Imath::Box2i;
using testing::ElementsAre;

constexpr Window kWindow{-2, 3, 62, 83};
const std::vector<std::string> kNames = {"R", "Z", "id"};

Imf::Header header(Imf::Compression compression) {
  return test_header(Box2i({kWindow.x0, kWindow.y0}, {kWindow.x1 - 1, kWindow.y1 - 1}),
                     {{"R", Imf::HALF}, {"Z", Imf::FLOAT}, {"id", Imf::UINT}}, compression);
}

/// A file, how many chunks it has, and the pixels of the second of them.
struct Kind {
  const char* name;
  Imf::Header header;
  std::size_t chunks;
  Window second;
};

Kind lines(const char* name, Imf::Compression compression, int rows) {
  const int top = kWindow.y0 + rows;
  return {name,
          header(compression),
          std::size_t((kWindow.height() + rows - 1) / rows),
          {kWindow.x0, top, kWindow.x1, std::min(top + rows, kWindow.y1)}};
}

Kind tiles(const char* name, Imf::Compression compression) {
  return {name, tiled(header(compression), 16), 20, {kWindow.x0 + 16, 3, kWindow.x0 + 32, 19}};
}

/// Not a constant: OpenEXR's names of types may be initialised after those of this file.
std::vector<Kind> kinds() {
  return {
      lines("none", Imf::NO_COMPRESSION, 1),      lines("rle", Imf::RLE_COMPRESSION, 1),
      lines("zips", Imf::ZIPS_COMPRESSION, 1),    lines("zip", Imf::ZIP_COMPRESSION, 16),
      lines("piz", Imf::PIZ_COMPRESSION, 32),     lines("pxr24", Imf::PXR24_COMPRESSION, 16),
      lines("b44", Imf::B44_COMPRESSION, 32),     lines("b44a", Imf::B44A_COMPRESSION, 32),
      lines("dwaa", Imf::DWAA_COMPRESSION, 32),   tiles("tiles_none", Imf::NO_COMPRESSION),
      tiles("tiles_zip", Imf::ZIP_COMPRESSION),   tiles("tiles_piz", Imf::PIZ_COMPRESSION),
      tiles("tiles_dwab", Imf::DWAB_COMPRESSION),
  };
}

class Salvaged : public testing::TestWithParam<Kind> {
 protected:
  Salvaged() {
    write_test_exr(dir_ / "whole.exr", {GetParam().header});
    bytes_.emplace(dir_ / "whole.exr");
    places_ = bytes_->places(GetParam().chunks);
  }

  ExrReader read_file() {
    bytes_->write(dir_ / "a.exr");
    return ExrReader(dir_ / "a.exr", Salvage::done);
  }

  /// Claims that the second chunk has no bytes at all, in place of its own number.
  void break_second_chunk() {
    const bool is_tiled = GetParam().header.hasType() && GetParam().header.type() == "tiledimage";
    bytes_->put_int(places_[1] + (is_tiled ? 16 : 4), -1);
  }

  /// Against the whole file; `is_missing(x, y)` says which pixels are lost.
  template <class IsMissing>
  void expect_others(const ExrReader& file, const PixelGrid& grid, const IsMissing& is_missing) {
    const auto planes = file.read(0, kNames, grid),
               whole = ExrReader(dir_ / "whole.exr").read(0, kNames, grid);
    const Window window = grid.rows_of(kWindow);
    for (std::size_t c = 0; c < planes.size(); ++c) {
      for (int y = window.y0; y < window.y1; ++y) {
        for (int x = window.x0; x < window.x1; ++x) {
          const std::size_t i = planes[c].index(x - window.x0, y - window.y0);
          ASSERT_EQ(std::isnan(planes[c][i]), is_missing(x, y))
              << kNames[c] << " " << x << " " << y;
          if (!is_missing(x, y)) {
            ASSERT_EQ(planes[c][i], whole[c][i]) << kNames[c] << " " << x << " " << y;
          }
        }
      }
    }
  }

  TempDir dir_;
  std::optional<ExrBytes> bytes_;
  std::vector<std::uint64_t> places_;
};

TEST_P(Salvaged, AllButABrokenChunk) {
  break_second_chunk();
  const ExrReader file = read_file();
  const Window& lost = GetParam().second;
  const auto is_missing = [&](int x, int y) { return lost.contains(x, y); };
  expect_others(file, {}, is_missing);
  expect_others(file, {.y0 = 10, .y1 = 45}, is_missing);
  expect_others(file, {.y0 = lost.y0, .y1 = lost.y0 + 1}, is_missing);
  EXPECT_THAT(file.missing(0).windows, ElementsAre(lost));
  EXPECT_EQ(file.missing(0).count, GetParam().chunks);

  const StoredChannel stored = file.read_stored(0, std::vector<std::string>{"id"})[0];
  for (int y = kWindow.y0; y < kWindow.y1; ++y) {
    for (int x = kWindow.x0; x < kWindow.x1; ++x) {
      std::uint32_t id;
      std::memcpy(&id, &stored.pixels[std::size_t((y - kWindow.y0) * 64 + x - kWindow.x0) * 4], 4);
      ASSERT_EQ(id, is_missing(x, y) ? 0 : std::uint32_t(test_value(2, x, y)));
    }
  }
}

/// Whether the table of chunks is there, or was never written, as by a renderer that was killed.
TEST_P(Salvaged, WhatStandsBeforeTheEndOfACutFile) {
  for (const bool is_killed : {false, true}) {
    bytes_.emplace(dir_ / "whole.exr");
    const std::size_t kept = GetParam().chunks / 2;
    bytes_->cut(std::size_t(places_[kept]) + 9);
    const std::size_t table = bytes_->table(GetParam().chunks);
    for (std::size_t i = 0; is_killed && i < GetParam().chunks; ++i)
      bytes_->put_place(table + 8 * i, 0);
    const ExrReader file = read_file();
    const auto names = std::vector<std::string>{"Z"};
    const Plane<float> z = file.read(0, names)[0];
    EXPECT_EQ(file.missing(0).windows.size(), GetParam().chunks - kept) << is_killed;
    std::size_t lost = 0, missing = 0;
    for (const float value : z.pixels) lost += std::isnan(value);
    for (const Window& chunk : file.missing(0).windows) missing += chunk.area();
    EXPECT_EQ(lost, missing);
    EXPECT_EQ(file.losses().size(), 1u);
  }
}

TEST_P(Salvaged, AFileWithoutAChunkIsAnError) {
  bytes_->cut(std::size_t(places_[0]) + 9);
  const ExrReader file = read_file();
  EXPECT_THAT(error_of([&] { file.read(0, kNames); }), IsError(ExitCode::input, "a.exr: is "));
}

TEST_P(Salvaged, OnlyOnRequest) {
  break_second_chunk();
  bytes_->write(dir_ / "a.exr");
  const Error none = error_of([&] { ExrReader(dir_ / "a.exr").read(0, kNames); }),
              offered =
                  error_of([&] { ExrReader(dir_ / "a.exr", Salvage::offered).read(0, kNames); });
  EXPECT_THAT(none, IsError(ExitCode::input, "render or copy it again"));
  EXPECT_THAT(none, testing::Not(IsError(ExitCode::input, "--allow-partial")));
  EXPECT_THAT(offered, IsError(ExitCode::input, "or take what is there with --allow-partial"));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Salvaged, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST(SalvagedParts, AWholePartStaysSo) {
  const TempDir dir;
  const Imf::Header part = header(Imf::ZIP_COMPRESSION);
  write_test_exr(dir / "a.exr", {named(part, "first"), named(part, "second")});
  ExrBytes bytes(dir / "a.exr");
  bytes.cut(bytes.size() - 10);
  bytes.write(dir / "a.exr");
  const ExrReader file(dir / "a.exr", Salvage::done);
  for (int i = 0; i < 2; ++i) {
    const Plane<float> red = file.read(i, kNames)[0];
    for (const float value : red.pixels) ASSERT_TRUE(i == 1 || !std::isnan(value));
  }
  EXPECT_TRUE(file.missing(0).windows.empty());
  EXPECT_THAT(file.losses(),
              ElementsAre((dir / "a.exr").string() +
                          ": part 1 'second': 16 of 80 rows are missing or damaged, between rows "
                          "67 and 82"));
}

TEST(SalvagedParts, SubsampledChannelsToo) {
  const TempDir dir;
  const auto channels = std::vector<TestChannel>{{"BY", Imf::HALF, 2}, {"Y", Imf::HALF}};
  write_test_exr(dir / "a.exr",
                 {test_header(Box2i({0, 0}, {31, 31}), channels, Imf::NO_COMPRESSION)});
  ExrBytes bytes(dir / "a.exr");
  bytes.cut(bytes.size() - 10);
  bytes.write(dir / "a.exr");
  const ExrReader file(dir / "a.exr", Salvage::done);
  const auto stored = file.read_stored(0, std::vector<std::string>{"BY", "Y"});
  EXPECT_EQ(file.missing(0).windows.size(), 1u);
  half last;
  std::memcpy(&last, &stored[0].pixels[stored[0].pixels.size() - 2], 2);
  EXPECT_EQ(float(last), float(test_value(0, 30, 30)));
  std::memcpy(&last, &stored[1].pixels[stored[1].pixels.size() - 2], 2);
  EXPECT_EQ(float(last), 0.0f);
}

// OpenEXR opens a part again after a chunk that it could not read, in a time that grows with the
// number of chunks: three quarters of 16,000 took 3 s.
TEST(SalvagedParts, OfManyDamagedChunksSoon) {
  constexpr int kRows = 48000, kSound = kRows / 4;
  const TempDir dir;
  write_test_exr(dir / "a.exr", {test_header(Box2i({0, 0}, {31, kRows - 1}), {{"id", Imf::UINT}},
                                             Imf::ZIPS_COMPRESSION)});
  const ExrBytes whole(dir / "a.exr");
  const std::vector<std::uint64_t> places = whole.places(kRows);
  for (const bool in_heads : {false, true}) {
    ExrBytes bytes = whole;
    for (std::size_t row = kSound; row < kRows; ++row)
      bytes.put_int(places[row] + (in_heads ? 0 : 8), -1);
    bytes.write(dir / "a.exr");
    const ExrReader file(dir / "a.exr", Salvage::done);
    Stopwatch watch;
    file.read(0, std::vector<std::string>{"id"});
    EXPECT_LT(watch.lap(), 8000);
    EXPECT_EQ(file.missing(0).windows.size(), std::size_t(kRows - kSound)) << in_heads;
  }
}

}  // namespace
}  // namespace ssdo::test::salvage_test
