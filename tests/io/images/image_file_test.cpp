// SPDX-License-Identifier: Apache-2.0
#include "io/images/image_file.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <thread>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace fs = std::filesystem;

namespace ssdo::test::image_file_test {
namespace {

void save(const fs::path& path, const ImageSpec& spec, const std::vector<float>& values) {
  SafeFile file(path, {.overwrite = true});
  write_image(file, spec, values);
  file.commit();
}

/// The stored integers of an image, unscaled and with alpha unassociated.
std::vector<int> stored_values(const fs::path& path, OIIO::ImageSpec& spec) {
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  const auto image = OIIO::ImageInput::open(path.string(), &as_stored);
  EXPECT_TRUE(image) << OIIO::geterror();
  if (!image) return {};
  spec = image->spec();
  std::vector<std::uint16_t> values(std::size_t(spec.width) * spec.height * spec.nchannels);
  EXPECT_TRUE(image->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT16, values.data()));
  const int divisor = spec.format == OIIO::TypeDesc::UINT8 ? 257 : 1;
  std::vector<int> result;
  for (const int value : values) result.push_back(value / divisor);
  return result;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(WriteImage, StoresEveryCodeExactly) {
  const TempDir dir;
  for (const int bits : {8, 16}) {
    const int largest = (1 << bits) - 1, step = bits == 8 ? 1 : 37;
    for (const int channels : {1, 3, 4}) {
      std::vector<float> values;
      std::vector<int> codes;
      for (int code = 0; code <= largest; code += step) {
        // The last channel counts down: where it is an alpha, it must not touch the colour.
        for (int c = 0; c < channels; ++c) codes.push_back(c == 3 ? largest - code : code);
      }
      for (const int code : codes) values.push_back(float(code) / float(largest));
      const int width = int(codes.size()) / channels;
      for (const char* name : {"a.png", "a.tif", "a.TIFF"}) {
        SCOPED_TRACE(testing::Message() << name << ", " << bits << " bits, " << channels);
        save(dir / name, {width, 1, channels, bits, 1}, values);
        OIIO::ImageSpec spec;
        EXPECT_EQ(stored_values(dir / name, spec), codes);
        EXPECT_EQ(spec.nchannels, channels);
        EXPECT_EQ(spec.format, bits == 8 ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::UINT16);
        EXPECT_EQ(spec.alpha_channel, channels == 4 ? 3 : -1);
      }
    }
  }
}

TEST(WriteImage, RoundsAndClamps) {
  const TempDir dir;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  save(dir / "a.png", {8, 1, 1, 8, 1},
       {0.4f / 255, 0.6f / 255, -1, 2, nan, infinity, -infinity, 127.4f / 255});
  OIIO::ImageSpec spec;
  EXPECT_EQ(stored_values(dir / "a.png", spec), (std::vector<int>{0, 1, 0, 255, 0, 255, 0, 127}));
}

TEST(WriteImage, JpegIsEightBitsFullChromaWithoutAlpha) {
  const TempDir dir;
  std::vector<float> values;
  for (int i = 0; i < 16 * 16; ++i) {  // red and blue columns, which subsampled chroma would mix
    const float red = i % 2 ? 1.0f : 0.0f;
    values.insert(values.end(), {red, 0, 1 - red, 0.5f});
  }
  save(dir / "a.jpg", {16, 16, 4, 16, 1}, values);
  OIIO::ImageSpec spec;
  const std::vector<int> stored = stored_values(dir / "a.jpg", spec);
  EXPECT_EQ(spec.nchannels, 3);
  EXPECT_EQ(spec.format, OIIO::TypeDesc::UINT8);
  ASSERT_EQ(stored.size(), 16u * 16u * 3u);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const int expected = i % 3 == 1 ? 0 : ((i / 3) % 2 == (i % 3 == 0 ? 1u : 0u)) ? 255 : 0;
    EXPECT_NEAR(stored[i], expected, 24) << i;
  }
}

TEST(WriteImage, KeepsThePixelAspect) {
  const TempDir dir;
  for (const char* name : {"a.png", "a.tif"}) {
    save(dir / name, {2, 1, 1, 8, 2.0f}, {0, 1});
    OIIO::ImageSpec spec;
    stored_values(dir / name, spec);
    EXPECT_EQ(spec.get_float_attribute("PixelAspectRatio"), 2.0f) << name;
  }
}

TEST(WriteImage, SameValuesGiveSameBytesAtAnyTime) {
  const TempDir dir;
  const char* names[] = {"a.png", "a.jpg", "a.tif"};
  std::string first[3];
  for (int i = 0; i < 3; ++i) {
    save(dir / names[i], {2, 1, 3, 8, 1}, {0, 1, 0, 1, 0, 1});
    first[i] = bytes_of(dir / names[i]);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // dates count whole seconds
  for (int i = 0; i < 3; ++i) {
    save(dir / names[i], {2, 1, 3, 8, 1}, {0, 1, 0, 1, 0, 1});
    EXPECT_EQ(bytes_of(dir / names[i]), first[i]) << names[i];
  }
}

TEST(WriteImage, SaysWhatCannotBeWritten) {
  const TempDir dir;
  EXPECT_THAT(error_of([&] {
                save(dir / "a.jpg", {70'000, 1, 1, 8, 1}, std::vector<float>(70'000));
              }),
              IsError(ExitCode::output, "a.jpg: cannot be encoded"));
  EXPECT_FALSE(fs::exists(dir / "a.jpg"));
}

TEST(IsDisplayImage, GoesByTheEnding) {
  for (const char* name : {"a.png", "a.PNG", "a.jpg", "a.Jpeg", "a.tif", "b/a.1001.tiff"}) {
    EXPECT_TRUE(is_display_image(name)) << name;
  }
  for (const char* name : {"a.exr", "a", "png", ".png", "a.png.exr", "a.hdr"}) {
    EXPECT_FALSE(is_display_image(name)) << name;
  }
}

void write_floats(const fs::path& path, const OIIO::ImageSpec& spec,
                  const std::vector<float>& values) {
  const auto image = OIIO::ImageOutput::create(path.string());
  ASSERT_TRUE(image && image->open(path.string(), spec) &&
              image->write_image(OIIO::TypeDesc::FLOAT, values.data()) && image->close());
}

TEST(ReadImage, ReadsColourAndGrey) {
  const TempDir dir;
  const std::vector<float> rgb = {0.5f, 1, 2, 4, 8, 16};
  for (const char* name : {"a.hdr", "a.tif"}) {
    write_floats(dir / name, OIIO::ImageSpec(2, 1, 3, OIIO::TypeDesc::FLOAT), rgb);
    const Image image = read_image(dir / name);
    ASSERT_EQ(image.color.width, 2) << name;
    ASSERT_EQ(image.color.height, 1) << name;
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(image.color[0][c], rgb[std::size_t(c)], 0.02f) << name;
      EXPECT_NEAR(image.color[1][c], rgb[std::size_t(c) + 3], 0.2f) << name;
    }
    EXPECT_TRUE(image.alpha.empty()) << name;
    EXPECT_FALSE(image.integers) << name;
  }
  write_floats(dir / "grey.tif", OIIO::ImageSpec(2, 1, 1, OIIO::TypeDesc::FLOAT), {0.25f, 3});
  EXPECT_EQ(read_image(dir / "grey.tif").color[1], glm::vec3(3));
}

TEST(ReadImage, TakesValuesAsStored) {
  const TempDir dir;
  save(dir / "a.png", {1, 1, 4, 8, 1}, {1, 0.2f, 0.4f, 0.2f});
  const Image image = read_image(dir / "a.png");
  EXPECT_FLOAT_EQ(image.color[0].x, 1);
  EXPECT_FLOAT_EQ(image.color[0].y, 51 / 255.0f);
  ASSERT_EQ(image.alpha.size(), 1u);
  EXPECT_FLOAT_EQ(image.alpha[0], 51 / 255.0f);
  EXPECT_TRUE(image.integers);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  write_floats(dir / "a.tif", OIIO::ImageSpec(1, 1, 3, OIIO::TypeDesc::FLOAT), {nan, infinity, -1});
  const glm::vec3 wild = read_image(dir / "a.tif").color[0];
  EXPECT_TRUE(std::isnan(wild.x));
  EXPECT_EQ(wild.y, infinity);
  EXPECT_EQ(wild.z, -1);
}

TEST(ReadImage, GreyMayHaveAnAlpha) {
  const TempDir dir;
  OIIO::ImageSpec spec(1, 1, 2, OIIO::TypeDesc::UINT8);
  spec.channelnames = {"Y", "A"};
  spec.alpha_channel = 1;
  spec.attribute("oiio:UnassociatedAlpha", 1);
  write_floats(dir / "a.png", spec, {0.6f, 0.4f});
  const Image image = read_image(dir / "a.png");
  EXPECT_FLOAT_EQ(image.color[0].z, 0.6f);
  ASSERT_EQ(image.alpha.size(), 1u);
  EXPECT_FLOAT_EQ(image.alpha[0], 0.4f);
}

TEST(ReadImage, SaysWhatIsWrong) {
  const TempDir dir;
  EXPECT_THAT(error_of([&] { read_image(dir / "none.hdr"); }),
              IsError(ExitCode::input, "none.hdr: does not exist"));
  EXPECT_THAT(error_of([&] { read_image(dir.path()); }), IsError(ExitCode::input, "is a folder"));
  EXPECT_THAT(error_of([&] { read_image("/dev/null"); }), IsError(ExitCode::input, "is a device"));
  std::ofstream(dir / "text.png") << "a text";
  EXPECT_THAT(error_of([&] { read_image(dir / "text.png"); }),
              IsError(ExitCode::input, "text.png: cannot be read as an image (it is no EXR, PNG,"));
}

/// Rows beyond the largest int are none for OpenImageIO 2, which then reports success. Version 3.1
/// reads the picture, or reports that it cannot.
TEST(ReadImage, LosesNothingAtAPlaceBeyondInt) {
  const TempDir dir;
  for (const bool down : {false, true}) {
    OIIO::ImageSpec spec(200, 200, 1, OIIO::TypeDesc::FLOAT);
    (down ? spec.y : spec.x) = std::numeric_limits<int>::max() - 127;
    write_floats(dir / "a.tif", spec, std::vector<float>(200 * 200, 0.5f));
    try {
      EXPECT_THAT(read_image(dir / "a.tif").color.pixels,
                  testing::AllOf(testing::SizeIs(200 * 200), testing::Each(glm::vec3(0.5f))));
    } catch (const Error& error) {
      EXPECT_THAT(error, IsError(ExitCode::input, "a.tif: is damaged"));
    }
  }
}

/// Radiance, "File Formats": the first axis is that of the rows, and a sign says where it begins.
/// OpenImageIO 2.4 exchanges +X +Y and -X -Y.
TEST(ReadImage, TurnsARadianceFileAsItsResolutionStringSays) {
  const TempDir dir;
  const auto values_of = [&](const std::string& resolution, const std::vector<int>& stored) {
    std::ofstream file(dir / "a.hdr", std::ios::binary);
    file << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" << resolution << "\n";
    for (const int value : stored) file << char(value) << char(value) << char(value) << '\x88';
    file.close();
    const Image image = read_image(dir / "a.hdr");
    EXPECT_EQ(image.color.width, 3) << resolution;
    std::vector<int> values;
    for (const glm::vec3& pixel : image.color.pixels) values.push_back(int(pixel.x));
    return values;
  };
  const std::vector<int> picture = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(values_of("-Y 2 +X 3", {1, 2, 3, 4, 5, 6}), picture);
  EXPECT_EQ(values_of("-Y 2 -X 3", {3, 2, 1, 6, 5, 4}), picture);
  EXPECT_EQ(values_of("+Y 2 -X 3", {6, 5, 4, 3, 2, 1}), picture);
  EXPECT_EQ(values_of("+Y 2 +X 3", {4, 5, 6, 1, 2, 3}), picture);
  EXPECT_EQ(values_of("+X 3 -Y 2", {1, 4, 2, 5, 3, 6}), picture);
  EXPECT_EQ(values_of("+X 3 +Y 2", {4, 1, 5, 2, 6, 3}), picture);
  EXPECT_EQ(values_of("-X 3 +Y 2", {6, 3, 5, 2, 4, 1}), picture);
  EXPECT_EQ(values_of("-X 3 -Y 2", {3, 6, 2, 5, 1, 4}), picture);
}

TEST(ReadImage, TurnsATiffAsItsTagSays) {
  const TempDir dir;
  OIIO::ImageSpec spec(1, 2, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("Orientation", 6);  // rows are columns from the right
  write_floats(dir / "a.tif", spec, {2, 2, 2, 1, 1, 1});
  const Image image = read_image(dir / "a.tif");
  ASSERT_EQ(image.color.width, 2);
  EXPECT_EQ(image.color[0].x, 1);
  EXPECT_EQ(image.color[1].x, 2);
}

TEST(ReadImage, TellsTheColourSpace) {
  const TempDir dir;
  save(dir / "a.png", {1, 1, 3, 8, 1}, {1, 0.2f, 0.4f});
  // Which OpenImageIO 3.1 calls "srgb_rec709_scene".
  EXPECT_THAT(read_image(dir / "a.png").color_space, testing::MatchesRegex("s(RGB|rgb_.*)"));
  write_floats(dir / "a.hdr", OIIO::ImageSpec(1, 1, 3, OIIO::TypeDesc::FLOAT), {1, 1, 1});
  // "linear", which OpenImageIO 2.5 calls "lin_srgb".
  EXPECT_THAT(read_image(dir / "a.hdr").color_space, testing::StartsWith("lin"));
}

/// A damaged picture of Maya's kind ended the tool by a signal in OpenImageIO's reader.
TEST(ReadImage, TakesTheKindsThatManNames) {
  const TempDir dir;
  const std::vector<float> grey(4 * 2 * 3, 0.5f);
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.hdr"}) {
    write_floats(dir / name, OIIO::ImageSpec(4, 2, 3, OIIO::TypeDesc::FLOAT), grey);
    fs::rename(dir / name, dir / "picture.iff");
    EXPECT_EQ(read_image(dir / "picture.iff").color.width, 4) << name;
  }
  for (const char* name : {"a.iff", "a.tga", "a.bmp"}) {
    write_floats(dir / name, OIIO::ImageSpec(4, 2, 3, OIIO::TypeDesc::UINT8), grey);
    EXPECT_THAT(error_of([&] { read_image(dir / name); }),
                IsError(ExitCode::input, "it is no EXR, PNG, JPEG, TIFF or Radiance HDR"))
        << name;
  }
}

/// Issue 12, number 14: libjpeg makes up what a file lacks and warns only.
TEST(ReadImage, RefusesFilesCutShort) {
  const TempDir dir;
  std::vector<float> noise(64 * 48 * 3);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = float(i * 2654435761u % 1009) / 1009;
  for (const char* name : {"a.png", "a.jpg", "a.tif"}) {
    const fs::path whole = dir / name, cut = dir / (std::string("cut_") + name);
    save(whole, {64, 48, 3, 8, 1}, noise);
    EXPECT_EQ(read_image(whole).color.height, 48);
    const auto size = fs::file_size(whole);
    for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9, 0.97}) {
      fs::copy_file(whole, cut, fs::copy_options::overwrite_existing);
      fs::resize_file(cut, std::uintmax_t(share * double(size)));
      testing::internal::CaptureStderr();
      const Error error = error_of([&] { read_image(cut); });
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "")
          << "libraries have no words of their own";
      EXPECT_EQ(error.code, ExitCode::input) << name << " " << share << ": " << error.what();
    }
  }
}

TEST(ReadImage, RefusesDamagedChunksOfPng) {
  const TempDir dir;
  save(dir / "a.png", {64, 48, 3, 8, 1}, std::vector<float>(64 * 48 * 3, 0.5f));
  const std::string whole = bytes_of(dir / "a.png");
  const auto damage = [&](const std::string& chunk, std::size_t place) {
    std::string bytes = whole;
    char& byte = bytes.at(whole.find(chunk) + place);
    byte = char(byte ^ 0x80);
    std::ofstream(dir / "b.png", std::ios::binary) << bytes;
  };
  testing::internal::CaptureStderr();
  for (const std::size_t place : {4, 5, 6, 7}) {
    damage("\x89PNG", place);
    EXPECT_THAT(error_of([&] { read_image(dir / "b.png"); }),
                IsError(ExitCode::input, "its line ends were changed"));
  }
  for (const char* chunk : {"IHDR", "IDAT"}) {
    damage(chunk, 5);
    EXPECT_THAT(error_of([&] { read_image(dir / "b.png"); }),
                IsError(ExitCode::input, fmt::format("its chunk '{}' has another", chunk)));
  }
  damage("pHYs", 1);
  EXPECT_THAT(error_of([&] { read_image(dir / "b.png"); }),
              IsError(ExitCode::input, "it has a chunk 'p"));
  damage("pHYs", 5);
  EXPECT_EQ(read_image(dir / "b.png").color.height, 48) << "a picture can be shown without";
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "libpng has no words of its own";
}

}  // namespace
}  // namespace ssdo::test::image_file_test
