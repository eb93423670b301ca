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
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "error.h"
#include "io/images/kind.h"
#include "io/images/orientation.h"
#include "io/one_line.h"
#include "io/size_guard.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

using namespace std::string_view_literals;

[[noreturn]] void fail(ExitCode code, const fs::path& file, std::string_view what) {
  throw Error(code, fmt::format("{}: {}", file.string(), what));
}

/// How files of a kind begin, and what OpenImageIO calls their reader.
struct Kind {
  std::string_view begin;
  const char* reader;
};

/// OpenImageIO knows thirty further kinds. Readers of some of them end the process on damaged
/// files.
constexpr Kind kKinds[] = {{"\x89PNG"sv, "png"}, {"\xff\xd8\xff"sv, "jpeg"}, {"#?"sv, "hdr"},
                           {"II*\0"sv, "tiff"},  {"MM\0*"sv, "tiff"},        {"II+\0"sv, "tiff"},
                           {"MM\0+"sv, "tiff"}};

/// Null for a file of another kind.
std::unique_ptr<OIIO::ImageInput> reader_of(const fs::path& path) {
  char begin[4] = {};
  std::ifstream(path, std::ios::binary).read(begin, sizeof begin);
  const auto kind = std::ranges::find_if(
      kKinds, [text = std::string_view(begin, 4)](Kind k) { return text.starts_with(k.begin); });
  return kind == std::end(kKinds) ? nullptr : OIIO::ImageInput::create(kind->reader);
}

std::unique_ptr<OIIO::ImageInput> open_image(const fs::path& path) {
  OIIO::ImageSpec spec, as_stored;
  as_stored.attribute("oiio:UnassociatedAlpha", 1);
  as_stored.attribute("oiio:RawColor", 1);
  auto image = reader_of(path);
  if (image && image->open(path.string(), spec, as_stored)) return image;
  fail(ExitCode::input, path,
       fmt::format(
           "cannot be read as an image ({}); check the file or convert it to EXR",
           image ? one_line(image->geterror()) : "it is no EXR, PNG, JPEG, TIFF or Radiance HDR"));
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

/// The channels that are read of a file, from its first one on.
struct Channels {
  int colors, count, alpha;  ///< `alpha` is its place; -1: there is none

  explicit Channels(const OIIO::ImageSpec& spec)
      : colors(spec.nchannels < 3 ? 1 : 3),
        count(std::max(colors, spec.alpha_channel + 1)),
        alpha(spec.alpha_channel >= colors ? spec.alpha_channel : -1) {}
};

/// How many rows are decoded at a time: whole tiles, or about 16 MB.
int rows_at_a_time(const OIIO::ImageSpec& spec, const Channels& channels) {
  if (spec.tile_height > 0) return std::min(spec.tile_height, spec.height);
  const double line_bytes = sizeof(float) * double(spec.width) * channels.count;
  return std::clamp(int((1 << 24) / line_bytes), 1, std::max(1, spec.height));
}

/// `in_pieces`: only the rows that are decoded at a time are kept.
/// Errors: ExitCode::input for what is no picture, or claims more than the file can hold.
void check_spec(const fs::path& path, const OIIO::ImageSpec& spec, bool in_pieces) {
  if (spec.deep || spec.depth > 1 || spec.nchannels < 1) {
    fail(ExitCode::input, path, "is not a flat image (it is deep, a volume or has no channels)");
  }
  if (spec.width < 1 || spec.height < 1) {
    fail(ExitCode::input, path,
         fmt::format("is damaged: its header claims {} x {} pixels; render or copy it again",
                     spec.width, spec.height));
  }
  constexpr std::int64_t kLast = std::numeric_limits<int>::max();
  if (std::int64_t(spec.x) + spec.width > kLast || std::int64_t(spec.y) + spec.height > kLast) {
    fail(ExitCode::input, path,
         fmt::format("is damaged: its header places it at {}, {}; render or copy it again", spec.x,
                     spec.y));
  }
  const double pixel_bytes = sizeof(glm::vec3) + 4.0 * Channels(spec).count,
               bytes = double(spec.width) * spec.height * pixel_bytes,
               tile_bytes = double(spec.tile_width) * spec.tile_height * pixel_bytes;
  const double kept =
      in_pieces ? bytes / spec.height * rows_at_a_time(spec, Channels(spec)) : bytes;
  check_picture_size(path, std::max(bytes, tile_bytes), kept + tile_bytes);
}

/// A plane with no rows yet. Memory for all is reserved but untouched: a header may claim much.
template <class T>
Plane<T> plane_without_rows(const OIIO::ImageSpec& spec) {
  Plane<T> plane;
  plane.width = spec.width, plane.height = spec.height;
  plane.pixels.reserve(std::size_t(spec.width) * std::size_t(spec.height));
  return plane;
}

/// Decodes the rows from `first` to before `end`, counted from the top.
void decode(OIIO::ImageInput& file, const fs::path& path, int first, int end,
            std::vector<float>& values) {
  const OIIO::ImageSpec& spec = file.spec();
  const int channels = Channels(spec).count, top = spec.y;
  const OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
  const bool read =
      spec.tile_height > 0
          ? file.read_tiles(0, 0, spec.x, spec.x + spec.width, top + first, top + end, 0, 1, 0,
                            channels, type, values.data())
          : file.read_scanlines(0, 0, top + first, top + end, 0, 0, channels, type, values.data());
  // libjpeg fills up what a file lacks with grey, and OpenImageIO reports that but goes on.
  if (read && !file.has_error()) return;
  fail(ExitCode::input, path,
       fmt::format("is damaged or cut short ({}); copy it again", one_line(file.geterror())));
}

/// Adds decoded pixels, `value` being the first, at the end of the planes.
void append(const float* value, std::size_t pixels, const Channels& channels,
            Plane<glm::vec3>& color, Plane<float>& alpha) {
  for (std::size_t i = 0; i < pixels; ++i, value += channels.count) {
    color.pixels.push_back(channels.colors == 1 ? glm::vec3(*value)
                                                : glm::vec3(value[0], value[1], value[2]));
    if (channels.alpha >= 0) alpha.pixels.push_back(value[channels.alpha]);
  }
}

/// Reads all rows into the image, or hands those of an image that is stored upright to `take`.
Image read_rows(OIIO::ImageInput& file, const fs::path& path, const TakeRows* take) {
  const OIIO::ImageSpec& spec = file.spec();
  const Orientation orientation = orientation_of_radiance(path).value_or(
      orientation_of_tiff(spec.get_int_attribute("Orientation", 1)));
  const bool in_pieces = take && orientation == Orientation{};
  check_spec(path, spec, in_pieces);
  const Channels channels(spec);
  Image image;
  image.color.width = spec.width, image.color.height = spec.height;
  image.integers = !spec.format.is_floating_point();
  image.color_space = spec.get_string_attribute("oiio:ColorSpace");
  if (!in_pieces) {
    image.color = plane_without_rows<glm::vec3>(spec);
    if (channels.alpha >= 0) image.alpha = plane_without_rows<float>(spec);
  }
  const int rows = rows_at_a_time(spec, channels);
  std::vector<float> values(std::size_t(spec.width) * std::size_t(rows) *
                            std::size_t(channels.count));
  Plane<glm::vec3> piece;
  Plane<float> unused;
  for (int y = 0; y < spec.height; y += rows) {
    const int end = std::min(y + rows, spec.height);
    decode(file, path, y, end, values);
    const std::size_t pixels = std::size_t(spec.width) * std::size_t(end - y);
    if (!in_pieces) {
      append(values.data(), pixels, channels, image.color, image.alpha);
      continue;
    }
    piece.width = spec.width, piece.height = end - y;
    piece.pixels.clear(), unused.pixels.clear();
    append(values.data(), pixels, channels, piece, unused);
    (*take)(image, y, piece);
  }
  if (in_pieces) return image;
  image.color = upright(std::move(image.color), orientation);
  image.alpha = upright(std::move(image.alpha), orientation);
  if (take) (*take)(image, 0, image.color);
  return image;
}

Image read(const fs::path& path, const TakeRows* take) {
  const auto file = open_image(path);
  try {
    return read_rows(*file, path, take);
  } catch (const std::bad_alloc&) {
    fail(ExitCode::input, path,
         fmt::format("needs more memory than there is for its {} x {} pixels; reduce the image or "
                     "use a larger machine",
                     file->spec().width, file->spec().height));
  }
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
    int threads, double memory) {
  ssdo::limit_memory(memory);
  if (threads > 0) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads == 1 ? -1 : threads);
  }
  return &ssdo::kCodec;
}
