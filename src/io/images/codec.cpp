// SPDX-License-Identifier: Apache-2.0
//
// Compiled into a module of its own: see codec.h.
#include "io/images/codec.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "error.h"
#include "io/images/kind.h"
#include "io/one_line.h"
#include "io/size_guard.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

[[noreturn]] void fail(ExitCode code, const fs::path& file, std::string_view what) {
  throw Error(code, fmt::format("{}: {}", file.string(), what));
}

std::unique_ptr<OIIO::ImageInput> open_image(const fs::path& path) {
  OIIO::ImageSpec as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  as_stored.attribute("oiio:RawColor", 1);
  auto image = OIIO::ImageInput::open(path.string(), &as_stored);
  if (!image) {
    fail(ExitCode::input, path,
         fmt::format("cannot be read as an image ({}); check the file or convert it to EXR",
                     one_line(OIIO::geterror())));
  }
  return image;
}

/// Interleaved values as unsigned integers of the whole range of T.
template <class T>
std::vector<std::byte> quantize(const ImageSpec& spec, int channels,
                                std::span<const float> values) {
  constexpr float kLargest = float(std::numeric_limits<T>::max());
  std::vector<std::byte> bytes(std::size_t(spec.width) * spec.height * channels * sizeof(T));
  T* out = reinterpret_cast<T*>(bytes.data());
  for (std::size_t i = 0; i < values.size(); i += std::size_t(spec.channels)) {
    for (int c = 0; c < channels; ++c) {
      const float value = values[i + std::size_t(c)];
      const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;  // NaN becomes 0
      *out++ = T(clamped * kLargest + 0.5f);
    }
  }
  return bytes;
}

OIIO::ImageSpec stored_spec(const ImageSpec& spec, const fs::path& target) {
  const bool jpeg = !keeps_alpha(target);
  OIIO::ImageSpec stored(spec.width, spec.height, jpeg ? std::min(spec.channels, 3) : spec.channels,
                         spec.bits == 16 && !jpeg ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8);
  stored.attribute("oiio:UnassociatedAlpha", 1);
  stored.attribute("PixelAspectRatio", spec.pixel_aspect);
  // TIFF would get the time of writing. This is how EXIF spells a time that is not known.
  stored.attribute("DateTime", "    :  :     :  :  ");
  if (jpeg) {
    stored.attribute("Compression", "jpeg:95");
    stored.attribute("jpeg:subsampling", "4:4:4");
  }
  return stored;
}

/// JPEG's own limit. libjpeg ends the process where it is exceeded.
constexpr int kLargestJpeg = 65500;

/// The bytes of the encoded file.
std::vector<unsigned char> encode_pixels(const OIIO::ImageSpec& spec, const fs::path& target,
                                         const std::vector<std::byte>& pixels) {
  if (!keeps_alpha(target) && std::max(spec.width, spec.height) > kLargestJpeg) {
    fail(ExitCode::output, target,
         fmt::format(
             "cannot be encoded: {} x {} is more than the {} pixels of JPEG; use .png or .tif",
             spec.width, spec.height, kLargestJpeg));
  }
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  auto image = OIIO::ImageOutput::create(target.string(), &memory);
  if (!image) {
    fail(ExitCode::output, target,
         fmt::format("cannot be written ({}); use .png, .jpg or .tif", one_line(OIIO::geterror())));
  }
  if (!image->open(target.string(), spec) || !image->write_image(spec.format, pixels.data()) ||
      !image->close()) {
    fail(
        ExitCode::output, target,
        fmt::format("cannot be encoded ({}); use another image kind", one_line(image->geterror())));
  }
  return bytes;
}

Image read(const fs::path& path) {
  auto file = open_image(path);
  const OIIO::ImageSpec& spec = file->spec();
  if (spec.deep || spec.depth > 1 || spec.nchannels < 1) {
    fail(ExitCode::input, path, "is not a flat image (it is deep, a volume or has no channels)");
  }
  const int colors = spec.nchannels < 3 ? 1 : 3;
  const int channels = std::max(colors, spec.alpha_channel + 1);
  const double bytes = double(spec.width) * spec.height * (sizeof(glm::vec3) + 4.0 * channels);
  check_decoded_size(path, bytes, bytes);
  std::vector<float> values(std::size_t(spec.width) * spec.height * channels);
  // libjpeg fills up what a file lacks with grey, and OpenImageIO reports that but goes on.
  if (!file->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, values.data()) ||
      file->has_error()) {
    fail(ExitCode::input, path,
         fmt::format("is damaged or cut short ({}); copy it again", one_line(file->geterror())));
  }
  Image image{Plane<glm::vec3>(spec.width, spec.height), {}, !spec.format.is_floating_point()};
  if (spec.alpha_channel >= colors) image.alpha = Plane<float>(spec.width, spec.height);
  for (std::size_t i = 0; i < image.color.size(); ++i) {
    const float* value = &values[i * std::size_t(channels)];
    image.color[i] = colors == 1 ? glm::vec3(*value) : glm::vec3(value[0], value[1], value[2]);
    if (!image.alpha.empty()) image.alpha[i] = value[spec.alpha_channel];
  }
  return image;
}

std::vector<unsigned char> encode(const fs::path& name, const ImageSpec& spec,
                                  std::span<const float> values) {
  const OIIO::ImageSpec stored = stored_spec(spec, name);
  const auto pixels = stored.format == OIIO::TypeDesc::UINT16
                          ? quantize<std::uint16_t>(spec, stored.nchannels, values)
                          : quantize<std::uint8_t>(spec, stored.nchannels, values);
  return encode_pixels(stored, name, pixels);
}

constexpr ImageCodec kCodec = {read, encode};

}  // namespace
}  // namespace ssdo

extern "C" __attribute__((visibility("default"))) const ssdo::ImageCodec* ssdo_image_codec(
    int threads) {
  if (threads > 0) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads == 1 ? -1 : threads);
  }
  return &ssdo::kCodec;
}
