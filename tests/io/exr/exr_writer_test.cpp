// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_writer.h"

#include <ImfChromaticitiesAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <half.h>

#include <cstring>
#include <fstream>
#include <glm/vec3.hpp>

#include "io/files/safe_file.h"
#include "support/error_matchers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test::exr_writer_test {
namespace {

using Imath::Box2i;
using testing::ElementsAre;

const Box2i kWindow({-3, 5}, {36, 44});
const std::vector<TestChannel> kChannels = {
    {"Z", Imf::FLOAT}, {"ao.Y", Imf::HALF}, {"id", Imf::UINT}, {"mask", Imf::HALF}};

std::vector<std::string> names_of(const ExrPart& part) {
  std::vector<std::string> names;
  for (const ExrChannel& c : part.channels) names.push_back(c.name);
  return names;
}

/// An input, and a plane over the data window of its part 0.
class Writer : public testing::Test {
 protected:
  void make_input(const std::vector<Imf::Header>& headers) {
    write_test_exr(dir_ / "in.exr", headers);
    input_.emplace(dir_ / "in.exr");
    const Window window = input_->parts()[0].data_window;
    plane_ = Plane<float>(window.width(), window.height());
    for (std::size_t i = 0; i < plane_.size(); ++i) plane_[i] = 0.001f * float(i) - 0.3f;
  }
  ExrOutput output(Imf::PixelType type = Imf::FLOAT) const {
    ExrOutput o;
    o.input = &*input_;
    o.planes = {{"ao.Y", type, &plane_}};
    return o;
  }
  std::size_t write(const ExrOutput& output) {
    SafeFile file(dir_ / "out.exr", {.overwrite = true, .create_dirs = false});
    const std::size_t clamped = write_exr(file, {output});
    file.commit();
    written_.emplace(dir_ / "out.exr");
    return clamped;
  }
  Plane<float> read(const std::string& name, int part = 0) const {
    return written_->read(part, std::vector{name})[0];
  }
  void expect_same_bits(int part, const std::vector<std::string>& names) const {
    const auto before = input_->read_stored(part, names),
               after = written_->read_stored(part, names);
    for (std::size_t i = 0; i < names.size(); ++i) {
      EXPECT_EQ(before[i].channel.type, after[i].channel.type) << names[i];
      EXPECT_TRUE(before[i].pixels == after[i].pixels) << names[i];
    }
  }

  TempDir dir_;
  std::optional<ExrReader> input_, written_;
  Plane<float> plane_;
};

TEST_F(Writer, TakesOneNumberOfEachPixel) {
  make_input({test_header(kWindow, kChannels)});
  auto vectors = Plane<glm::vec3>::like(plane_);
  for (std::size_t i = 0; i < plane_.size(); ++i) vectors[i] = {-7, plane_[i], 9};
  ExrOutput o = output();
  o.planes[0].pixels = ChannelView(vectors, 1);
  o.planes.push_back({"half", Imf::HALF, ChannelView(vectors, 1)});
  write(o);
  EXPECT_EQ(read("ao.Y").pixels, plane_.pixels);
  const Plane<float> rounded = read("half");
  for (std::size_t i = 0; i < plane_.size(); ++i) EXPECT_EQ(rounded[i], float(half(plane_[i])));
}

TEST_F(Writer, KeepsTheHeaderAndAddsItsOwn) {
  Imf::Header header = test_header(kWindow, kChannels);
  header.displayWindow() = Box2i({0, 0}, {31, 31});
  header.pixelAspectRatio() = 2;
  const Imath::M44f matrix(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  header.insert("worldToCamera", Imf::M44fAttribute(matrix));
  header.insert("cameraTransform", Imf::M44fAttribute(matrix * 2.0f));
  header.insert("chromaticities", Imf::ChromaticitiesAttribute(Imf::Chromaticities({0.7f, 0.3f})));
  header.insert("ssdo/version", Imf::IntAttribute(7));
  make_input({header});
  ExrOutput o = output();
  o.attributes = {{"ssdo/version", "new"}};
  write(o);
  const Imf::Header& kept = written_->parts()[0].header;
  EXPECT_EQ(kept.displayWindow(), header.displayWindow());
  EXPECT_EQ(kept.dataWindow(), kWindow);
  EXPECT_EQ(kept.pixelAspectRatio(), 2);
  EXPECT_EQ(kept.typedAttribute<Imf::M44fAttribute>("worldToCamera").value(), matrix);
  EXPECT_EQ(kept.typedAttribute<Imf::M44fAttribute>("cameraTransform").value(), matrix * 2.0f);
  EXPECT_EQ(kept.typedAttribute<Imf::ChromaticitiesAttribute>("chromaticities").value().red.x,
            0.7f);
  EXPECT_EQ(kept.typedAttribute<Imf::StringAttribute>("ssdo/version").value(), "new");
  EXPECT_THAT(names_of(written_->parts()[0]), ElementsAre("ao.Y"));
}

TEST_F(Writer, FloatComesBackExactlyAndHalfRounded) {
  make_input({test_header(kWindow, kChannels)});
  write(output(Imf::FLOAT));
  EXPECT_EQ(read("ao.Y").pixels, plane_.pixels);
  write(output(Imf::HALF));
  const Plane<float> halves = read("ao.Y");
  for (std::size_t i = 0; i < plane_.size(); ++i) ASSERT_EQ(halves[i], float(half(plane_[i])));
}

TEST_F(Writer, HalfIsClampedAndCounted) {
  make_input({test_header(kWindow, kChannels)});
  plane_[0] = 1e6f, plane_[1] = -INFINITY, plane_[2] = 65504;
  EXPECT_EQ(write(output(Imf::HALF)), 2u);
  EXPECT_EQ(read("ao.Y")[0], 65504);
  EXPECT_EQ(read("ao.Y")[1], -65504);
  EXPECT_EQ(write(output(Imf::FLOAT)), 0u);
  EXPECT_EQ(read("ao.Y")[0], 1e6f);
}

TEST_F(Writer, ALossyCompressionIsUsedOnlyWhereItIsAskedFor) {
  make_input({test_header(kWindow, kChannels, Imf::DWAA_COMPRESSION)});
  ExrOutput o = output();
  EXPECT_EQ(compression_for(o), Imf::ZIP_COMPRESSION) << "the input's would harm data";
  o.compression = Imf::DWAB_COMPRESSION;
  EXPECT_EQ(compression_for(o), Imf::DWAB_COMPRESSION);
  o.keep_channels = true;
  EXPECT_EQ(compression_for(o), Imf::ZIP_COMPRESSION) << "ids keep their bits";
  make_input({test_header(kWindow, kChannels, Imf::PIZ_COMPRESSION)});
  EXPECT_EQ(compression_for(output()), Imf::PIZ_COMPRESSION);
}

/// Files with levels of compression.
class WriterLevels : public Writer {
 protected:
  void make_input(int parts) {
    Imf::Header header = test_header(Box2i({0, 0}, {199, 99}), {{"id", Imf::UINT}});
    header.insert("idManifest", Imf::StringAttribute("{}"));  // which no output keeps
    std::vector<Imf::Header> headers;
    for (int part = 0; part < parts; ++part) {
      header.setName("part " + std::to_string(part));
      headers.push_back(header);
    }
    Writer::make_input(headers);
    for (std::size_t i = 0; i < plane_.size(); ++i)
      plane_[i] = std::round(64 * std::sin(0.3f * float(i % 200) + 0.01f * float(i / 200))) / 64;
  }
  std::uintmax_t size(Imf::Compression compression, std::optional<int> level, bool keep = false) {
    ExrOutput o = output();
    o.compression = compression;
    o.compression_level = level;
    o.keep_channels = keep;
    write(o);
    const bool lossy = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
    EXPECT_EQ(written_->parts()[0].header.compression(),
              lossy && keep ? Imf::ZIP_COMPRESSION : compression);
    EXPECT_EQ(read("ao.Y").pixels == plane_.pixels, !lossy || keep);
    return std::filesystem::file_size(dir_ / "out.exr");
  }
};

TEST_F(WriterLevels, OfZipChangeTheSizeAlone) {
  make_input(1);
  for (const auto compression : {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION}) {
    EXPECT_EQ(size(compression, std::nullopt), size(compression, 1));
    EXPECT_GT(size(compression, 1), size(compression, 6));
    EXPECT_GT(size(compression, 6), size(compression, 12));
  }
}

TEST_F(WriterLevels, GoToOpenExrWhereItWrites) {
  make_input(2);
  EXPECT_GT(size(Imf::ZIP_COMPRESSION, 1, true), size(Imf::ZIP_COMPRESSION, 9, true));
  EXPECT_EQ(size(Imf::ZIP_COMPRESSION, 9, true), size(Imf::ZIP_COMPRESSION, 12, true));
  EXPECT_GT(size(Imf::DWAA_COMPRESSION, 1), size(Imf::DWAA_COMPRESSION, 45));
  EXPECT_EQ(size(Imf::DWAA_COMPRESSION, std::nullopt), size(Imf::DWAA_COMPRESSION, 45));
  EXPECT_GT(size(Imf::DWAB_COMPRESSION, 45), size(Imf::DWAB_COMPRESSION, 500));
}

TEST_F(WriterLevels, OfACompressionThatIsReplacedAreDropped) {
  make_input(1);
  EXPECT_EQ(size(Imf::DWAA_COMPRESSION, 12, true), size(Imf::ZIP_COMPRESSION, std::nullopt, true));
}

TEST_F(Writer, KeptChannelsKeepTheirBitsAndMakeRoom) {
  make_input({test_header(kWindow, kChannels)});
  ExrOutput o = output();
  o.keep_channels = true;
  write(o);
  EXPECT_THAT(names_of(written_->parts()[0]), ElementsAre("Z", "ao.Y", "id", "input.ao.Y", "mask"));
  expect_same_bits(0, {"Z", "id", "mask"});
  EXPECT_EQ(read("input.ao.Y").pixels, input_->read(0, std::vector<std::string>{"ao.Y"})[0].pixels);
  EXPECT_EQ(read("ao.Y").pixels, plane_.pixels);

  // Its own output as input: the first "input.ao.Y" stays, the stale product goes.
  const Plane<float> original = read("input.ao.Y");
  std::filesystem::copy_file(dir_ / "out.exr", dir_ / "in2.exr");
  input_.emplace(dir_ / "in2.exr");
  ExrOutput again = output();
  again.keep_channels = true;
  write(again);
  EXPECT_THAT(names_of(written_->parts()[0]), ElementsAre("Z", "ao.Y", "id", "input.ao.Y", "mask"));
  EXPECT_EQ(read("input.ao.Y").pixels, original.pixels);
}

TEST_F(Writer, OtherPartsAreCopiedOfWhateverKind) {
  const Imf::Header lines = test_header(kWindow, kChannels);
  Imf::Header small =
      test_header(Box2i({0, 10}, {9, 19}), {{"x", Imf::UINT}}, Imf::PIZ_COMPRESSION);
  small.displayWindow() = kWindow;
  const std::vector<Imf::Header> parts = {named(lines, "main"),
                                          named(tiled(lines, 16, Imf::MIPMAP_LEVELS), "tiles"),
                                          named(small, "small")};
  make_input(parts);
  ExrOutput o = output();
  write(o);
  EXPECT_EQ(written_->parts().size(), 1u);
  EXPECT_EQ(written_->parts()[0].name, "main");
  o.keep_channels = true;
  write(o);
  ASSERT_EQ(written_->parts().size(), 3u);
  expect_same_bits(0, {"Z", "id", "mask"});
  expect_same_bits(1, {"Z", "ao.Y", "id", "mask"});
  expect_same_bits(2, {"x"});
  EXPECT_EQ(written_->parts()[1].header.type(), Imf::TILEDIMAGE);
}

TEST_F(Writer, ATiledPartBecomesScanlines) {
  make_input({tiled(test_header(kWindow, kChannels), 16, Imf::RIPMAP_LEVELS)});
  ExrOutput o = output();
  o.keep_channels = true;
  write(o);
  EXPECT_EQ(written_->parts()[0].header.type(), Imf::SCANLINEIMAGE);
  expect_same_bits(0, {"Z", "id", "mask"});
}

TEST_F(Writer, DamageInWhatIsKeptIsTheInputsFault) {
  make_input({test_header(kWindow, kChannels, Imf::NO_COMPRESSION)});
  std::filesystem::resize_file(dir_ / "in.exr", std::filesystem::file_size(dir_ / "in.exr") - 900);
  std::optional<ExrReader> damaged;
  try {
    damaged.emplace(dir_ / "in.exr");
  } catch (const Error&) {
    return;  // found on opening already
  }
  ExrOutput o = output();
  o.input = &*damaged;
  o.keep_channels = true;
  SafeFile file(dir_ / "out.exr", {});
  EXPECT_THAT(error_of([&] { write_exr(file, {o}); }), IsError(ExitCode::input, "in.exr"));
}

}  // namespace
}  // namespace ssdo::test::exr_writer_test
