// SPDX-License-Identifier: Apache-2.0
#include "io/exr/file/attribute_sizes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <istream>
#include <string>
#include <string_view>

#include "error.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

constexpr std::uint32_t kMultiPartFlag = 0x1000;
constexpr std::size_t kLongestName = 255;
constexpr std::int64_t kNoFile = std::int64_t(1) << 62;  ///< more bytes than any file

/// Most bytes of the list of channels. Each channel takes 20 bytes or more in the file and many
/// times that in memory; files of renderers have some hundreds of channels.
constexpr std::int32_t kLargestChannelList = 1 << 18;

/// Types whose values have a fixed size, in bytes. OpenEXR reads that many, whatever size the
/// header says, and takes the remaining bytes for the next attribute.
struct FixedSize {
  std::string_view type;
  std::int32_t bytes;
};
constexpr FixedSize kFixedSizes[] = {
    {"box2f", 16},
    {"box2i", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"double", 8},
    {"envmap", 1},
    {"deepImageState", 1},
    {"float", 4},
    {"int", 4},
    {"m33d", 72},
    {"m33f", 36},
    {"m44d", 128},
    {"m44f", 64},
    {"v2d", 16},
    {"v2f", 8},
    {"v2i", 8},
    {"v3d", 24},
    {"v3f", 12},
    {"v3i", 12},
    {"keycode", 28},
    {"rational", 8},
    {"timecode", 8},
    {"lineOrder", 1},
    {"tiledesc", 9},
};

std::int32_t read_int(std::istream& in) {
  unsigned char bytes[4] = {};
  in.read(reinterpret_cast<char*>(bytes), 4);
  return std::int32_t(std::uint32_t(bytes[0]) | std::uint32_t(bytes[1]) << 8 |
                      std::uint32_t(bytes[2]) << 16 | std::uint32_t(bytes[3]) << 24);
}

/// A text that ends with a zero. One that is too long for a name fails the stream.
std::string read_name(std::istream& in) {
  std::string name;
  for (char c; in.get(c) && c != '\0'; name += c) {
    if (name.size() == kLongestName) in.setstate(std::ios::failbit);
  }
  return name;
}

/// The bytes that OpenEXR reads, or tries to read, from `in` for a value of this type.
std::int64_t bytes_taken(std::istream& in, std::string_view type, std::int32_t size) {
  const auto* fixed = std::ranges::find(kFixedSizes, type, &FixedSize::type);
  if (fixed != std::end(kFixedSizes)) return fixed->bytes;
  if (type == "preview") {
    const std::int64_t width = std::uint32_t(read_int(in)), height = std::uint32_t(read_int(in));
    const bool fits = width <= size && height <= size && width * height <= size / 4;
    return fits ? 8 + 4 * width * height : kNoFile;
  }
  std::int64_t taken = 0;
  if (type == "chlist") {
    // A name, 16 bytes of type and sampling; an empty name ends the list.
    for (std::string name = "first"; in && !name.empty() && taken <= size;) {
      name = read_name(in);
      taken += std::int64_t(name.size()) + (name.empty() ? 1 : 17);
      if (!name.empty()) in.seekg(16, std::ios::cur);
    }
    return taken;
  }
  if (type == "stringvector") {
    while (in && taken < size) {
      const std::int64_t length = std::uint32_t(read_int(in));
      taken += 4 + length;
      in.seekg(length, std::ios::cur);
    }
    return taken;
  }
  if (type == "floatvector") return size / 4 * 4;
  return size;
}

}  // namespace

std::uint64_t check_attribute_sizes(const InputFile& file) {
  InputStream in(file);
  const auto file_bytes = std::int64_t(file.bytes());
  in.seekg(4);
  const bool multi_part = std::uint32_t(read_int(in)) & kMultiPartFlag;
  for (std::string before = "magic number and flags"; in;) {
    const std::string name = read_name(in);
    // An empty name ends a header; a second one ends all headers of a multi-part file.
    if (name.empty() && (!multi_part || before.empty())) return std::uint64_t(in.tellg());
    before = name;
    if (name.empty()) continue;
    const std::string type = read_name(in);
    const std::int32_t size = read_int(in);
    const std::int64_t left = file_bytes - in.tellg();
    if (in && (size < 0 || size > left)) {
      throw Error(ExitCode::input,
                  fmt::format("{}: is damaged or cut short in its header (attribute '{}' claims {} "
                              "bytes, and {} are left in the file); render or copy it again",
                              file.path().string(), printable(name), size, left));
    }
    if (name == "channels" && size > kLargestChannelList) {
      throw Error(
          ExitCode::input,
          fmt::format("{}: lists {} KiB of channels in its header, and ssdo reads up to {}; "
                      "split it into files of fewer channels",
                      file.path().string(), size >> 10, kLargestChannelList >> 10));
    }
    const std::istream::pos_type value = in.tellg();
    const std::int64_t taken = bytes_taken(in, type, size);
    if (in && taken != size) {
      throw Error(
          ExitCode::input,
          fmt::format("{}: is damaged in its header (attribute '{}' claims {} bytes, and its "
                      "value takes {}); render or copy it again",
                      file.path().string(), printable(name), size, taken));
    }
    in.seekg(value + std::streamoff(size));
  }
  return std::uint64_t(file_bytes);
}

}  // namespace ssdo
