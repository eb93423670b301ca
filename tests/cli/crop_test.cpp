// SPDX-License-Identifier: Apache-2.0
//
// --crop: outputs hold the display window only, with the values that they have without it.
#include <gmock/gmock.h>

#include <filesystem>

#include "support/crop.h"
#include "support/exr_fixture.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/typed_frame.h"

namespace ssdo::test::crop_test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

const Window kDisplay{0, 0, 64, 48}, kOverscan{-19, -13, 81, 58};

class Crop : public testing::Test {
 protected:
  Crop() { write("in.exr", kOverscan); }

  std::string path(const std::string& name) const { return dir_ / name; }

  void write(const std::string& name, const Window& data) const {
    FramePart part = frame_of(small_picture(data, kDisplay));
    part.data = data, part.display = kDisplay;
    write_frame(path(name), part);
  }

  Finished run(const std::string& in, const std::string& out,
               const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {path(in), "-o", path(out), "--overwrite"};
    words.insert(words.end(), flags.begin(), flags.end());
    return run_tool(words);
  }

  /// Runs with and without --crop, and compares what the two have in the window `shown`.
  void expect_cropped(std::vector<std::string> flags, const Window& data = kOverscan,
                      const Window& shown = kDisplay) const {
    write("in.exr", data);
    flags.insert(flags.end(), {"--pixel-type", "float"});
    ASSERT_EQ(run("in.exr", "whole.exr", flags).code, 0);
    flags.push_back("--crop");
    const Finished done = run("in.exr", "crop.exr", flags);
    ASSERT_EQ(done.code, 0) << done.err;
    const ExrPart part = ExrReader(path("crop.exr")).parts()[0];
    EXPECT_EQ(part.data_window, shown);
    EXPECT_EQ(part.display_window, kDisplay);
    const std::vector<std::string> names = channel_names(path("whole.exr"));
    EXPECT_EQ(channel_names(path("crop.exr")), names);
    const Window part_of_data{shown.x0 - data.x0, shown.y0 - data.y0, shown.x1 - data.x0,
                              shown.y1 - data.y0};
    for (const std::string& name : names) {
      EXPECT_EQ(channel(path("crop.exr"), name).pixels,
                crop(channel(path("whole.exr"), name), part_of_data).pixels)
          << name;
    }
  }
  TempDir dir_;
};

TEST_F(Crop, PixelsOfTheDisplayWindowKeepTheirBits) {
  const std::string sky = data("environments/sky.exr");
  for (const char* filter : {"none", "box", "gaussian", "normal", "depth", "geometry"}) {
    SCOPED_TRACE(filter);
    expect_cropped({"--env", sky, "--env-up", "z", "--filter", filter, "--products",
                    "ao,bent,direct,bounce,composite"});
  }
  expect_cropped({"--env", sky, "--products", "all", "--bounces", "2"});
  expect_cropped({"--method", "ssdo", "--products", "all"});
  expect_cropped({"--env", "0,0,0", "--products", "direct,bounce", "--light",
                  "sphere position=0,0,1.5 radius=0.1 intensity=9"});
  for (const char* method : {"bitmask", "trace", "ssao-fade", "sao"})
    expect_cropped({"--method", method, "--filter", "source", "--products", "ao,direct"});
}

TEST_F(Crop, OfADataWindowThatCoversPartOfTheDisplayWindow) {
  expect_cropped({}, {10, -5, 90, 40}, {10, 0, 64, 40});
  expect_cropped({}, {10, 5, 60, 40}, {10, 5, 60, 40});
}

TEST_F(Crop, ThatWouldLeaveNothingIsRefused) {
  write("in.exr", {64, 0, 120, 48});
  const Finished done = run("in.exr", "out.exr", {"--crop", "--fov", "40"});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.error_line(), AllOf(HasSubstr("in.exr"), HasSubstr("leave out --crop")));
  EXPECT_FALSE(std::filesystem::exists(path("out.exr")));
}

/// The pixels of overscan that no output holds are not estimated, and the plan says so.
TEST_F(Crop, IsInThePlan) {
  const Finished done = run("in.exr", "out.exr", {"--crop", "--dry-run", "-v"});
  EXPECT_THAT(done.out + done.err, HasSubstr("writes 64x48 pixels of 100x71"));
  const Finished inside = run("in.exr", "out.exr", {"--dry-run", "-v"});
  EXPECT_THAT(inside.out + inside.err, Not(HasSubstr("64x48 pixels of")));
}

/// A picture shows the display window, with and without it.
TEST_F(Crop, PicturesStayAsTheyAre) {
  ASSERT_EQ(run("in.exr", "whole.png", {}).code, 0);
  ASSERT_EQ(run("in.exr", "crop.png", {"--crop", "-o", path("crop.exr")}).code, 0);
  EXPECT_EQ(read_file(path("whole.png")), read_file(path("crop.png")));
}

TEST_F(Crop, AnOutputThatExistsIsSkipped) {
  ASSERT_EQ(run("in.exr", "out.exr", {"--crop"}).code, 0);
  const std::string before = read_file(path("out.exr"));
  const Finished done =
      run_tool({path("in.exr"), "-o", path("out.exr"), "--crop", "--skip-existing"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(read_file(path("out.exr")), before);
}

/// Values that differ from pixel to pixel, in a type of their own.
TypedChannel numbers(const Window& window, Imf::PixelType type) {
  if (type == Imf::HALF) {
    std::vector<unsigned short> bits(window.area());
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = static_cast<unsigned short>(5 * i);
    return typed(type, bits);
  }
  std::vector<unsigned> bits(window.area());
  for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = 0xfffffff0u - unsigned(i) * 777u;
  return typed(type, bits);
}

/// The bytes of a channel that `shown` cuts out of `window`.
std::vector<std::byte> cut(const TypedChannel& from, const Window& window, const Window& shown) {
  const std::size_t size = from.bytes.size() / window.area();
  std::vector<std::byte> to;
  for (int y = shown.y0; y < shown.y1; ++y) {
    const std::size_t first = std::size_t(y - window.y0) * std::size_t(window.width()) +
                              std::size_t(shown.x0 - window.x0);
    const auto row = from.bytes.begin() + std::ptrdiff_t(first * size);
    to.insert(to.end(), row, row + std::ptrdiff_t(std::size_t(shown.width()) * size));
  }
  return to;
}

TEST_F(Crop, KeptChannelsAndPartsAreCroppedBitForBit) {
  TypedFrame lead = typed_frame(frame_of(small_picture(kOverscan, kDisplay))), lines, tiles, small;
  lead.header.setName("main");
  lead.header.dataWindow() = box_of(kOverscan);
  lead.header.displayWindow() = box_of(kDisplay);
  lead.channels["id"] = numbers(kOverscan, Imf::UINT);
  const Window other{-3, -9, 70, 40}, shown{0, 0, 64, 40}, inside{8, 4, 30, 20};
  for (TypedFrame* frame : {&lines, &tiles, &small}) frame->header = lead.header;
  for (TypedFrame* frame : {&lines, &tiles}) {
    frame->header.dataWindow() = box_of(other);
    frame->channels["id"] = numbers(other, Imf::UINT);
    frame->channels["half"] = numbers(other, Imf::HALF);
  }
  lines.header.setName("lines");
  lines.header.compression() = Imf::DWAA_COMPRESSION;  // which loses nothing of ids
  tiles.header = tiled(named(tiles.header, "tiles"), 16);
  small.header = tiled(named(small.header, "small"), 16);
  small.header.dataWindow() = box_of(inside);
  small.channels["id"] = numbers(inside, Imf::UINT);
  write_typed(path("in.exr"), {lines, lead, tiles, small});
  const auto done = run("in.exr", "out.exr", {"--crop", "--keep-channels"});
  ASSERT_EQ(done.code, 0) << done.err;

  const ExrReader out(path("out.exr"));
  ASSERT_EQ(out.parts().size(), 4u);
  for (const int part : {0, 2}) {
    EXPECT_EQ(out.parts()[std::size_t(part)].data_window, shown);
    for (const char* name : {"id", "half"}) {
      if (part == 0 && std::string(name) == "half") continue;  // DWAA has lost it before
      EXPECT_EQ(stored(path("out.exr"), name, part).second,
                cut(tiles.channels.at(name), other, shown))
          << name << " of part " << part;
    }
  }
  EXPECT_EQ(out.parts()[0].header.compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(out.parts()[1].data_window, kDisplay);
  EXPECT_EQ(stored(path("out.exr"), "id", 1).second,
            cut(lead.channels.at("id"), kOverscan, kDisplay));
  EXPECT_THAT(channel_names(path("out.exr"), 1), Contains("ao.Y"));
  EXPECT_EQ(out.parts()[3].data_window, inside);
  EXPECT_EQ(out.parts()[3].header.type(), Imf::TILEDIMAGE);  // as it was
  EXPECT_EQ(stored(path("out.exr"), "id", 3).second, small.channels.at("id").bytes);
}

TEST_F(Crop, APartThatTheDisplayWindowDoesNotShowIsRefused) {
  TypedFrame lead = typed_frame(frame_of(small_picture(kOverscan, kDisplay))), other;
  lead.header.setName("main");
  lead.header.dataWindow() = box_of(kOverscan);
  lead.header.displayWindow() = box_of(kDisplay);
  const Window outside{-10, 0, 0, 10};
  other.header = named(lead.header, "other");
  other.header.dataWindow() = box_of(outside);
  other.channels["id"] = numbers(outside, Imf::UINT);
  write_typed(path("in.exr"), {lead, other});
  const Finished done = run("in.exr", "out.exr", {"--crop", "--keep-channels"});
  EXPECT_EQ(done.code, 3);
  EXPECT_THAT(done.error_line(), AllOf(HasSubstr("'other'"), HasSubstr("leave out --crop")));
  EXPECT_THAT(listing(dir_ / ""), Not(Contains(HasSubstr("out.exr"))));
}

}  // namespace
}  // namespace ssdo::test::crop_test
