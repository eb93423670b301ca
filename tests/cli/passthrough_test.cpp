// SPDX-License-Identifier: Apache-2.0
//
// What of the input reaches the output: its header always, its channels and parts on request, all
// of them bit for bit.
#include <ImfChromaticitiesAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>

#include "support/exr_fixture.h"
#include "support/run_tool.h"
#include "support/typed_frame.h"

namespace ssdo::test::passthrough_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsSupersetOf;
using testing::Not;

constexpr int kPixels = 64 * 48;

/// Bits that a conversion on the way would change: ids beyond the integers of a float, a NaN with
/// a payload, infinities, the smallest halves.
std::vector<unsigned> ids() {
  std::vector<unsigned> values(kPixels);
  for (unsigned i = 0; i < kPixels; ++i) values[i] = 0xfffffff0u - 77777u * i;
  return values;
}
std::vector<unsigned> odd_floats() {
  std::vector<unsigned> values(kPixels);
  for (unsigned i = 0; i < kPixels; ++i) values[i] = i % 2 ? 0x7fc12345u : 0x7f800000u ^ (i << 3);
  return values;
}
std::vector<unsigned short> halves() {
  std::vector<unsigned short> values(kPixels);
  for (unsigned i = 0; i < kPixels; ++i) values[i] = static_cast<unsigned short>(i * 21u);
  return values;
}

TypedFrame frame_with_odd_channels() {
  TypedFrame frame = typed_frame(frame_of(small_picture()));
  frame.channels["id"] = typed(Imf::UINT, ids());
  frame.channels["crypto00.R"] = typed(Imf::FLOAT, odd_floats());
  frame.channels["beauty.R"] = typed(Imf::HALF, halves());
  return frame;
}

void expect_same_bits(const std::filesystem::path& a, const std::string& name,
                      const std::filesystem::path& b, const std::string& name_in_b, int part = 0) {
  EXPECT_TRUE(stored(a, name, part) == stored(b, name_in_b, part)) << name << " of part " << part;
}

Finished relight(const std::vector<std::string>& arguments) {
  const Finished done = run_tool(arguments);
  EXPECT_EQ(done.code, 0) << done.err;
  return done;
}

TEST(Passthrough, KeptChannelsKeepTheirBits) {
  const TempDir dir;
  write_typed(dir / "in.exr", {frame_with_odd_channels()});
  for (const std::string compression : {"zip", "dwaa"}) {
    const auto out = dir / (compression + ".exr");
    relight({dir / "in.exr", "-o", out, "--keep-channels", "--compression", compression});
    for (const char* name : {"id", "crypto00.R", "beauty.R", "ViewLayer.Position.X"})
      expect_same_bits(dir / "in.exr", name, out, name);
  }
  relight({dir / "in.exr", "-o", dir / "plain.exr"});
  EXPECT_THAT(channel_names(dir / "plain.exr"), Not(Contains("id")));
}

TEST(Passthrough, OtherPartsAreCopiedAsTheyAre) {
  const TempDir dir;
  TypedFrame lead = typed_frame(frame_of(small_picture())), extra, tiles;
  lead.header.setName("main");
  for (TypedFrame* other : {&extra, &tiles}) {
    other->header = lead.header;
    other->header.dataWindow() = {{-3, 2}, {60, 49}};
    other->channels["id"] = typed(Imf::UINT, ids());
    other->channels["extra.R"] = typed(Imf::HALF, halves());
  }
  extra.header.setName("extra");
  extra.header.compression() = Imf::PIZ_COMPRESSION;
  tiles.header = tiled(named(tiles.header, "tiles"), 16);
  write_typed(dir / "in.exr", {extra, lead, tiles});
  relight({dir / "in.exr", "-o", dir / "out.exr", "--keep-channels", "--compression", "rle"});

  const ExrReader out(dir / "out.exr");
  ASSERT_EQ(out.parts().size(), 3u);
  for (const int part : {0, 2}) {
    expect_same_bits(dir / "in.exr", "id", dir / "out.exr", "id", part);
    expect_same_bits(dir / "in.exr", "extra.R", dir / "out.exr", "extra.R", part);
    EXPECT_EQ(out.parts()[std::size_t(part)].data_window, (Window{-3, 2, 61, 50}));
  }
  EXPECT_EQ(out.parts()[0].header.compression(), Imf::PIZ_COMPRESSION);
  EXPECT_EQ(out.parts()[1].header.compression(), Imf::RLE_COMPRESSION);
  EXPECT_EQ(out.parts()[2].header.type(), Imf::TILEDIMAGE);
  EXPECT_THAT(channel_names(dir / "out.exr", 1), IsSupersetOf({"R", "ao.Y"}));
  for (const int part : {0, 2}) {
    EXPECT_THAT(channel_names(dir / "out.exr", part), ElementsAre("extra.R", "id"));
  }
  relight({dir / "in.exr", "-o", dir / "plain.exr"});
  ASSERT_EQ(ExrReader(dir / "plain.exr").parts().size(), 1u);
  EXPECT_EQ(ExrReader(dir / "plain.exr").parts()[0].name, "main");
}

TEST(Passthrough, TheHeaderIsKept) {
  const TempDir dir;
  TypedFrame frame = typed_frame(frame_of(small_picture()));
  const Imf::Chromaticities acescg({0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f},
                                   {0.32168f, 0.33767f});
  const Imath::M44f pose(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  Imf::addChromaticities(frame.header, acescg);
  frame.header.insert("worldToCamera", Imf::M44fAttribute(pose));
  frame.header.insert("studio/shot", Imf::StringAttribute("ab 0010"));
  frame.header.insert("ssdo/version", Imf::StringAttribute("of an earlier run"));
  frame.header.pixelAspectRatio() = 1.25f;
  frame.header.screenWindowWidth() = 3;
  frame.header.lineOrder() = Imf::DECREASING_Y;
  frame.header.compression() = Imf::PIZ_COMPRESSION;
  write_typed(dir / "in.exr", {frame});
  relight({dir / "in.exr", "-o", dir / "out.exr"});
  const ExrReader out(dir / "out.exr");
  const Imf::Header& header = out.parts()[0].header;
  EXPECT_EQ(header.pixelAspectRatio(), 1.25f);
  EXPECT_EQ(header.screenWindowWidth(), 3);
  EXPECT_EQ(header.compression(), Imf::PIZ_COMPRESSION) << "the input's, as it is lossless";
  EXPECT_EQ(header.typedAttribute<Imf::ChromaticitiesAttribute>("chromaticities").value().red,
            acescg.red);
  EXPECT_EQ(header.typedAttribute<Imf::M44fAttribute>("worldToCamera").value(), pose);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("studio/shot").value(), "ab 0010");
  EXPECT_THAT(header.typedAttribute<Imf::StringAttribute>("ssdo/version").value(),
              Not("of an earlier run"));
  EXPECT_EQ(out.parts()[0].data_window, (Window{0, 0, 64, 48}));
}

TEST(Passthrough, ALossyInputDoesNotMakeTheOutputLossy) {
  const TempDir dir;
  TypedFrame frame = typed_frame(frame_of(small_picture()));
  frame.header.compression() = Imf::DWAB_COMPRESSION;
  write_typed(dir / "in.exr", {frame});
  relight({dir / "in.exr", "-o", dir / "out.exr"});
  EXPECT_EQ(ExrReader(dir / "out.exr").parts()[0].header.compression(), Imf::ZIP_COMPRESSION);
}

TEST(Passthrough, TilesLinesAndPartsHoldTheSameFrame) {
  const TempDir dir;
  const TypedFrame lines = typed_frame(frame_of(small_picture()));
  TypedFrame tiles = lines, upwards = lines;
  tiles.header = tiled(lines.header, 16);
  upwards.header.lineOrder() = Imf::DECREASING_Y;
  TypedFrame whole = lines, other = lines;
  whole.header.setName("whole"), other.header.setName("other");
  other.channels.clear();
  other.channels["id"] = typed(Imf::UINT, ids());
  const std::vector<std::pair<std::string, std::vector<TypedFrame>>> files = {
      {"lines", {lines}}, {"tiles", {tiles}}, {"upwards", {upwards}}, {"parts", {other, whole}}};
  for (const auto& [name, frames] : files) {
    write_typed(dir / (name + ".exr"), frames);
    relight({dir / (name + ".exr"), "-o", dir / (name + "_out.exr"), "--pixel-type", "float"});
    for (const char* channel : {"R", "A", "ao.Y", "direct.G", "bounce.B"})
      expect_same_bits(dir / "lines_out.exr", channel, dir / (name + "_out.exr"), channel);
  }
}

TEST(Passthrough, AnOutputCanBeAnInputAgain) {
  const TempDir dir;
  write_typed(dir / "in.exr", {frame_with_odd_channels()});
  relight({dir / "in.exr", "-o", dir / "once.exr", "--keep-channels"});
  relight({dir / "once.exr", "-o", dir / "twice.exr", "--keep-channels"});
  EXPECT_EQ(channel_names(dir / "twice.exr"), channel_names(dir / "once.exr"))
      << "products give way to those of their names";
  for (const char* name : {"R", "ao.Y", "bounce.G", "id"})
    expect_same_bits(dir / "once.exr", name, dir / "twice.exr", name);
}

}  // namespace
}  // namespace ssdo::test::passthrough_test
