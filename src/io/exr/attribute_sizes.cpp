// SPDX-License-Identifier: Apache-2.0
#include "io/exr/attribute_sizes.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <string>

#include "error.h"
#include "io/one_line.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

constexpr std::uint32_t kMultiPartFlag = 0x1000;
constexpr std::size_t kLongestName = 255;

/// Of the list of channels, each of which takes 20 bytes or more there and many times that in
/// memory: files of renderers have some hundreds of channels.
constexpr std::int32_t kLargestChannelList = 4 << 20;

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

}  // namespace

void check_attribute_sizes(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const auto file_bytes = std::int64_t(fs::file_size(file));
  in.seekg(4);
  const bool multi_part = std::uint32_t(read_int(in)) & kMultiPartFlag;
  for (std::string before = "magic number and flags"; in;) {
    const std::string name = read_name(in);
    // An empty name ends a header, and in a file of parts a second one all headers.
    if (name.empty() && (!multi_part || before.empty())) return;
    before = name;
    if (name.empty()) continue;
    read_name(in);  // its type
    const std::int32_t size = read_int(in);
    const std::int64_t left = file_bytes - in.tellg();
    if (in && (size < 0 || size > left)) {
      throw Error(ExitCode::input,
                  fmt::format("{}: is damaged or cut short in its header (attribute '{}' claims {} "
                              "bytes, and {} are left in the file); render or copy it again",
                              file.string(), printable(name), size, left));
    }
    if (name == "channels" && size > kLargestChannelList) {
      throw Error(
          ExitCode::input,
          fmt::format("{}: lists {} MiB of channels in its header, and ssdo reads up to {}; "
                      "split it into files of fewer channels",
                      file.string(), size >> 20, kLargestChannelList >> 20));
    }
    in.seekg(size, std::ios::cur);
  }
}

}  // namespace ssdo
