// SPDX-License-Identifier: Apache-2.0
// What the writer passes through from unusual inputs, and what a full disk leaves behind.
#include <ImfDeepScanLineInputPart.h>
#include <ImfHeader.h>
#include <ImfMultiPartInputFile.h>
#include <ImfMultiView.h>
#include <ImfPartType.h>
#include <ImfPreviewImageAttribute.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>

#include "io/exr/exr_writer.h"
#include "io/files/temporary_table.h"
#include "io/threads.h"
#include "support/error_matchers.h"
#include "support/exr_bytes.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace fs = std::filesystem;

namespace ssdo::test::exr_passthrough_test {
namespace {

using Imath::Box2i;

std::string bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Plane<float> ramp(const Window& window) {
  Plane<float> plane(window.width(), window.height());
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = float(i % 2048);
  return plane;
}

/// Adds the plane `name` to a part of `input`.
void add_plane(const std::string& name, const ExrReader& input, const fs::path& output,
               bool keep_channels, Imf::PixelType type = Imf::HALF, int part = 0) {
  const Plane<float> plane = ramp(input.parts()[std::size_t(part)].data_window);
  ExrOutput out;
  out.input = &input;
  out.part = part;
  out.planes = {{name, type, &plane}};
  out.keep_channels = keep_channels;
  SafeFile file(output, {.overwrite = true});
  write_exr(file, {out});
  file.commit();
}

/// Adds the plane "new" to a part of `input` and keeps all else.
void pass_through(const ExrReader& input, const fs::path& output, Imf::PixelType type = Imf::HALF,
                  int part = 0) {
  add_plane("new", input, output, true, type, part);
}

void expect_same_channels(const ExrReader& before, const ExrReader& after, int part) {
  std::vector<std::string> names;
  for (const ExrChannel& c : before.parts()[std::size_t(part)].channels) names.push_back(c.name);
  const auto old_bits = before.read_stored(part, names), new_bits = after.read_stored(part, names);
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(old_bits[i].channel.type, new_bits[i].channel.type) << names[i];
    EXPECT_EQ(old_bits[i].channel.x_sampling, new_bits[i].channel.x_sampling) << names[i];
    EXPECT_TRUE(old_bits[i].pixels == new_bits[i].pixels) << names[i];
  }
}

TEST(PassThrough, KeepsAttributesOfEveryType) {
  const TempDir dir;
  Imf::Header header = test_header(Box2i({0, 0}, {7, 7}), {{"R", Imf::HALF}});
  const Imf::PreviewRgba green(1, 200, 3, 255);
  header.setPreviewImage(Imf::PreviewImage(1, 1, &green));
  header.insert("studio/custom", Imf::StringAttribute("12345"));
  header.insert(std::string(200, 'n'), Imf::StringAttribute("a long name"));
  Imf::addMultiView(header, {"left", "right"});
  write_test_exr(dir / "in.exr", {header});
  // A type that OpenEXR does not know, of the same length as the one that it wrote.
  std::string bytes = bytes_of(dir / "in.exr");
  const std::string custom_type(
      "studio/custom\0studio\0\5\0\0\0"
      "12345",
      30);
  bytes.replace(bytes.find("studio/custom"), custom_type.size(), custom_type);
  std::ofstream(dir / "in.exr", std::ios::binary) << bytes;
  pass_through(ExrReader(dir / "in.exr"), dir / "out.exr");

  const ExrReader written(dir / "out.exr");
  const Imf::Header& kept = written.parts()[0].header;
  ASSERT_TRUE(kept.hasPreviewImage());
  EXPECT_EQ(kept.previewImage().pixels()[0].g, 200);
  EXPECT_STREQ(kept["studio/custom"].typeName(), "studio");
  EXPECT_NE(bytes_of(dir / "out.exr").find(custom_type), std::string::npos);
  EXPECT_EQ(kept.typedAttribute<Imf::StringAttribute>(std::string(200, 'n')).value(),
            "a long name");
  EXPECT_EQ(Imf::multiView(kept), (Imf::StringVector{"left", "right"}));
}

TEST(PassThrough, DropsAttributesOfWhatIsNotInTheOutput) {
  const TempDir dir;
  Imf::Header header =
      test_header(Box2i({0, 0}, {7, 7}), {{"R", Imf::HALF}, {"object00.R"}, {"object00.G"}});
  const Imf::PreviewRgba green(1, 200, 3, 255);
  header.setPreviewImage(Imf::PreviewImage(1, 1, &green));
  const std::string matte = "cryptomatte/0a1b2c3/";
  header.insert(matte + "name", Imf::StringAttribute("object"));
  header.insert(matte + "manifest", Imf::StringAttribute("{}"));
  write_test_exr(dir / "in.exr", {header});
  const auto has = [&](const std::string& plane, bool keep_channels, const std::string& name) {
    add_plane(plane, ExrReader(dir / "in.exr"), dir / "out.exr", keep_channels);
    const ExrReader out(dir / "out.exr");
    return out.parts()[0].header.find(name) != out.parts()[0].header.end();
  };
  for (const std::string& name : {matte + "name", matte + "manifest"}) {
    EXPECT_TRUE(has("R", true, name)) << name;
    EXPECT_FALSE(has("R", false, name)) << name;
  }
  EXPECT_TRUE(has("new", true, "preview"));
  EXPECT_FALSE(has("new", false, "preview")) << "the picture is not in the output";
  EXPECT_FALSE(has("R", true, "preview")) << "another picture has its place";
}

/// The matte of a deep part goes where flat planes take the place of its samples, while that of
/// another part stays.
TEST(PassThrough, DropsAttributesOfDeepMattes) {
  const TempDir dir;
  Imf::Header deep = named(test_header(Box2i({0, 0}, {7, 7}), {{"Z"}, {"deep00.R"}}), "deep"),
              flat = named(test_header(Box2i({0, 0}, {7, 7}), {{"R"}}), "flat");
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.insert("cryptomatte/1/name", Imf::StringAttribute("deep"));
  deep.insert("cryptomatte/2/name", Imf::StringAttribute("flat"));
  write_test_exr(dir / "in.exr", {deep, flat});
  pass_through(ExrReader(dir / "in.exr"), dir / "out.exr");
  const ExrReader out(dir / "out.exr");
  const Imf::Header& written = out.parts()[0].header;
  EXPECT_EQ(written.find("cryptomatte/1/name"), written.end());
  EXPECT_NE(written.find("cryptomatte/2/name"), written.end());
}

TEST(PassThrough, AddsNoAttributeOfItsOwn) {
  const TempDir dir;
  write_test_exr(dir / "in.exr",
                 {tiled(test_header(Box2i({0, 0}, {7, 7}), {{"R", Imf::HALF}}), 4)});
  const ExrReader input(dir / "in.exr");
  pass_through(input, dir / "out.exr");
  const ExrReader written(dir / "out.exr");
  const Imf::Header& before = input.parts()[0].header;
  for (auto a = written.parts()[0].header.begin(); a != written.parts()[0].header.end(); ++a) {
    const bool tells_of_planes = a.name() == std::string("ssdo/channels");
    EXPECT_TRUE(tells_of_planes || before.find(a.name()) != before.end()) << a.name();
  }
  EXPECT_EQ(written.parts()[0].header.find("tiles"), written.parts()[0].header.end());
}

TEST(PassThrough, CopiesDeepPartsBitForBit) {
  const TempDir dir;
  Imf::Header deep = named(test_header(Box2i({0, 0}, {20, 9}), {{"A"}, {"Z"}}), "deep");
  deep.compression() = Imf::ZIPS_COMPRESSION;
  deep.setType(Imf::DEEPSCANLINE);
  Imf::Header flat = named(test_header(Box2i({2, 3}, {9, 9}), {{"R", Imf::HALF}}), "flat");
  flat.displayWindow() = deep.displayWindow();
  write_test_exr(dir / "in.exr", {flat, deep});
  pass_through(ExrReader(dir / "in.exr"), dir / "out.exr");

  const ExrReader input(dir / "in.exr"), written(dir / "out.exr");
  ASSERT_EQ(written.parts().size(), 2u);
  EXPECT_TRUE(written.parts()[1].deep);
  Imf::DeepScanLineInputPart before(input.file(), 1), after(written.file(), 1);
  for (int y = 0; y < 10; ++y) {
    std::uint64_t old_size = 0, new_size = 0;
    before.rawPixelData(y, nullptr, old_size);
    after.rawPixelData(y, nullptr, new_size);
    ASSERT_EQ(old_size, new_size);
    std::string old_chunk(old_size, 'o'), new_chunk(new_size, 'n');
    before.rawPixelData(y, old_chunk.data(), old_size);
    after.rawPixelData(y, new_chunk.data(), new_size);
    EXPECT_EQ(old_chunk, new_chunk) << "line " << y;
  }
}

TEST(PassThrough, CopiesEveryCompressionAndLineOrder) {
  const TempDir dir;
  const std::vector<TestChannel> channels = {
      {"R", Imf::HALF}, {"Z", Imf::FLOAT}, {"id", Imf::UINT}};
  const Box2i box({-3, -4}, {30, 290});
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const auto order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
      SCOPED_TRACE(testing::Message() << "compression " << compression << ", order " << order);
      Imf::Header lines = named(test_header(box, channels, Imf::Compression(compression)), "lines");
      lines.lineOrder() = order;
      const Imf::Header tiles = named(tiled(lines, 16, Imf::RIPMAP_LEVELS), "tiles");
      write_test_exr(dir / "in.exr", {lines, named(lines, "more"), tiles});
      const ExrReader input(dir / "in.exr");
      pass_through(input, dir / "out.exr");
      const ExrReader written(dir / "out.exr");
      for (int part = 0; part < 3; ++part) expect_same_channels(input, written, part);
      EXPECT_EQ(written.parts()[1].header.compression(), Imf::Compression(compression));
    }
  }
}

/// A file of the parts "other", by this header, and "frame", of which a test changes bytes. The
/// frame is then written with all else.
class OtherPart : public testing::Test {
 protected:
  explicit OtherPart(Imf::Header other = test_header(Box2i({0, 0}, {7, 7}), {{"Z"}})) {
    write_test_exr(dir_ / "in.exr", {named(std::move(other), "other"),
                                     named(test_header(Box2i({0, 0}, {7, 7}), {{"R"}}), "frame")});
    bytes_.emplace(dir_ / "in.exr");
  }

  void pass() {
    bytes_->write(dir_ / "in.exr");
    pass_through(ExrReader(dir_ / "in.exr"), dir_ / "out.exr", Imf::HALF, 1);
  }

  TempDir dir_;
  std::optional<ExrBytes> bytes_;
};

/// OpenEXR sets its count of chunks, and refused a header that has it with another type.
TEST_F(OtherPart, IsCopiedWhereItsCountOfChunksIsNoInt) {
  bytes_->put_text(bytes_->place_of("chunkCount") + sizeof("chunkCount"), "odd");
  pass();
  expect_same_channels(ExrReader(dir_ / "in.exr"), ExrReader(dir_ / "out.exr"), 0);
}

TEST_F(OtherPart, IsRefusedWhereItsTypeIsUnknown) {
  bytes_->put_text(bytes_->value_of("type"), "scanlinefutur");
  EXPECT_THAT(error_of([&] { pass(); }),
              IsError(ExitCode::input, "'other' is of the type 'scanlinefutur', which no EXR"));
}

/// OpenEXR made room for 170 GiB.
TEST_F(OtherPart, IsRefusedWhereItClaimsMoreThanTheFileHolds) {
  bytes_->put_int(bytes_->value_of("dataWindow") + 8, 973078539);
  EXPECT_THAT(error_of([&] { pass(); }), IsError(ExitCode::input, "its header claims"));
}

Imf::Header deep_header() {
  Imf::Header deep = test_header(Box2i({0, 0}, {7, 7}), {{"Z"}}, Imf::ZIPS_COMPRESSION);
  deep.setType(Imf::DEEPSCANLINE);
  return deep;
}

class OtherDeepPart : public OtherPart {
 protected:
  OtherDeepPart() : OtherPart(deep_header()) {}
};

TEST_F(OtherDeepPart, IsRefusedWhereAChunkClaimsMoreThanTheFileHolds) {
  constexpr std::size_t kSamples = 16;  // behind the part, the row and the size of the counts
  bytes_->put_place(bytes_->places(9)[0] + kSamples, std::uint64_t(1) << 40);
  EXPECT_THAT(error_of([&] { pass(); }), IsError(ExitCode::input, "a chunk is cut short"));
}

/// OpenEXR reads as many bytes as an int says, and ended the tool. The file is a hole for the most
/// part.
TEST_F(OtherDeepPart, IsRefusedWhereAChunkIsLargerThanAnIntCounts) {
  constexpr std::size_t kSamples = 16;
  bytes_->put_place(bytes_->places(9)[0] + kSamples, std::uint64_t(1) << 31);
  bytes_->write(dir_ / "in.exr");
  fs::resize_file(dir_ / "in.exr", std::uintmax_t(3) << 30);
  EXPECT_THAT(
      error_of([&] { pass_through(ExrReader(dir_ / "in.exr"), dir_ / "out.exr", Imf::HALF, 1); }),
      IsError(ExitCode::input, "a chunk is larger than 2 GiB"));
}

class OtherDeepTiledPart : public OtherPart {
 protected:
  OtherDeepTiledPart() : OtherPart(header()) {}

  static Imf::Header header() {
    Imf::Header deep = tiled(deep_header(), 8, Imf::MIPMAP_LEVELS);
    deep.setType(Imf::DEEPTILE);
    return deep;
  }
};

/// OpenEXR reads two of the three sizes, and makes room for them, before it reads the third.
TEST_F(OtherDeepTiledPart, IsRefusedWhereASmallerTileEndsBeforeItsLastSize) {
  constexpr std::size_t kChunks = 5, kTile = 1, kSamples = 28;
  const std::uint64_t place = bytes_->places(kChunks)[kTile];
  bytes_->put_place(bytes_->table(kChunks) + 8 * kTile, bytes_->size());
  bytes_->append(bytes_->slice(place, place + kSamples + 8));
  bytes_->put_place(bytes_->size() - 8, std::uint64_t(1) << 36);
  EXPECT_THAT(error_of([&] { pass(); }),
              IsError(ExitCode::input, "cannot be copied (a chunk is cut short)"));
}

/// Tiles of 8x8, 4x4, 2x2 and 1x1 pixels.
class OtherTiledPart : public OtherPart {
 protected:
  OtherTiledPart()
      : OtherPart(tiled(test_header(Box2i({0, 0}, {7, 7}), {{"Z"}}), 8, Imf::MIPMAP_LEVELS)) {}

  void claim_negative_size(std::size_t tile) {
    constexpr std::size_t kSize = 20;  // behind the part, the place of the tile and its level
    bytes_->put_int(bytes_->places(kChunks)[tile] + kSize, -2000000000);
  }

  void expect_refused() {
    EXPECT_THAT(error_of([&] { pass(); }),
                IsError(ExitCode::input, "a chunk claims more bytes than its pixels take"));
  }

  static constexpr std::size_t kChunks = 5;
};

/// OpenEXR read it as long as it claims to be, and beyond its memory.
TEST_F(OtherTiledPart, IsRefusedWhereATileClaimsANegativeSize) {
  claim_negative_size(0);
  expect_refused();
}

TEST_F(OtherTiledPart, IsRefusedWhereATileOfASmallerLevelDoes) {
  claim_negative_size(2);
  expect_refused();
}

/// OpenEXR looks for a tile itself where its place is missing.
TEST_F(OtherTiledPart, IsRefusedWhereOpenExrFindsSuchATile) {
  constexpr std::size_t kTile = 3;
  claim_negative_size(kTile);
  bytes_->put_place(bytes_->table(kChunks) + 8 * kTile, 0);
  expect_refused();
}

TEST_F(OtherTiledPart, IsCopiedWithAllLevels) {
  pass();
  const ExrReader before(dir_ / "in.exr"), after(dir_ / "out.exr");
  expect_same_channels(before, after, 0);
  const std::vector<std::uint64_t> old_places = bytes_->places(kChunks),
                                   new_places = ExrBytes(dir_ / "out.exr").places(kChunks);
  for (std::size_t tile = 0; tile + 1 < kChunks; ++tile)
    EXPECT_EQ(old_places[tile + 1] - old_places[tile], new_places[tile + 1] - new_places[tile]);
}

TEST(PassThrough, KeepsSubsampledChannels) {
  const TempDir dir;
  write_test_exr(dir / "in.exr", {test_header(Box2i({-4, -6}, {27, 601}),
                                              {{"BY", Imf::HALF, 2}, {"Y", Imf::HALF}})});
  const ExrReader input(dir / "in.exr");
  pass_through(input, dir / "out.exr");
  expect_same_channels(input, ExrReader(dir / "out.exr"), 0);
}

TEST(PassThrough, WritesWindowsAnywhereInManyStrips) {
  const TempDir dir;
  const int far = 1'000'000'000;
  for (const Box2i& box :
       {Box2i({0, 0}, {0, 0}), Box2i({-5, -7}, {0, 600}), Box2i({far, far}, {far + 3, far + 299}),
        Box2i({-far, -far}, {3 - far, 299 - far})}) {
    for (const auto type : {Imf::HALF, Imf::FLOAT}) {
      SCOPED_TRACE(testing::Message() << "from " << box.min.x << ", type " << type);
      write_test_exr(dir / "in.exr", {test_header(box, {{"Z"}, {"id", Imf::UINT}})});
      const ExrReader input(dir / "in.exr");
      pass_through(input, dir / "out.exr", type);
      const ExrReader written(dir / "out.exr");
      EXPECT_EQ(written.parts()[0].data_window, input.parts()[0].data_window);
      const std::vector<std::string> added = {"new"};
      EXPECT_EQ(written.read(0, added)[0].pixels, ramp(input.parts()[0].data_window).pixels);
      expect_same_channels(input, written, 0);
    }
  }
}

TEST(PassThrough, NaNStaysAndIsNotCounted) {
  const TempDir dir;
  write_test_exr(dir / "in.exr", {test_header(Box2i({0, 0}, {1, 0}), {{"Z"}})});
  const ExrReader input(dir / "in.exr");
  Plane<float> plane(2, 1);
  plane[0] = std::numeric_limits<float>::quiet_NaN();
  ExrOutput out;
  out.input = &input;
  out.planes = {{"new", Imf::HALF, &plane}};
  {
    SafeFile file(dir / "out.exr", {});
    EXPECT_EQ(write_exr(file, {out}), 0u);
    file.commit();
  }
  const std::vector<std::string> names = {"new"};
  EXPECT_TRUE(std::isnan(ExrReader(dir / "out.exr").read(0, names)[0][0]));
}

TEST(PassThrough, SameInputGivesSameBytes) {
  const TempDir dir;
  write_test_exr(dir / "in.exr", {test_header(Box2i({0, 0}, {99, 299}), {{"Z"}})});
  const ExrReader input(dir / "in.exr");
  pass_through(input, dir / "a.exr");
  pass_through(input, dir / "b.exr");
  EXPECT_TRUE(bytes_of(dir / "a.exr") == bytes_of(dir / "b.exr"));
}

/// Writes an EXR in a child process that may write files of `bytes` at most. Gives its exit code.
int write_with_limit(const fs::path& input_path, const fs::path& output, rlim_t bytes) {
  limit_io_threads(1);  // a child has none of the threads that OpenEXR would wait for
  const pid_t child = fork();
  if (child == 0) {
    remove_temporaries_on_signals();
    const rlimit limit = {bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
    int code = 0;
    try {
      pass_through(ExrReader(input_path), output);
    } catch (const Error& error) {
      const bool named = std::strstr(error.what(), "out.exr: cannot be written: File too large");
      code = named ? int(error.code) : 99;
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

TEST(PassThrough, AFullDiskIsFoundWhereverItStrikes) {
  const TempDir dir;
  const Box2i box({0, 0}, {63, 63});
  write_test_exr(dir / "in.exr", {named(test_header(box, {{"Z"}}, Imf::NO_COMPRESSION), "one"),
                                  named(test_header(box, {{"Z"}}, Imf::NO_COMPRESSION), "two")});
  ASSERT_EQ(write_with_limit(dir / "in.exr", dir / "out.exr", RLIM_INFINITY), 0);
  const rlim_t size = fs::file_size(dir / "out.exr");
  fs::remove(dir / "out.exr");
  // In the header, in the written part, in the copied part, and in its very last byte.
  for (const rlim_t limit : {rlim_t(0), rlim_t(100), size / 4, size * 3 / 4, size - 1}) {
    EXPECT_EQ(write_with_limit(dir / "in.exr", dir / "out.exr", limit), int(ExitCode::output))
        << "limit of " << limit << " of " << size << " bytes";
    EXPECT_EQ(std::distance(fs::directory_iterator(dir.path()), {}), 1) << "only in.exr stays";
  }
}

}  // namespace
}  // namespace ssdo::test::exr_passthrough_test
