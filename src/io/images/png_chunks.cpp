// SPDX-License-Identifier: Apache-2.0
#include "io/images/png_chunks.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "error.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

using namespace std::string_view_literals;

/// Reads `count` bytes, or fewer at the end of the file.
std::string read_bytes(std::istream& in, std::size_t count) {
  std::string bytes(count, '\0');
  in.read(bytes.data(), std::streamsize(count));
  bytes.resize(std::size_t(in.gcount()));
  return bytes;
}

/// Big endian; 0 where the file ends.
std::uint32_t read_number(std::istream& in) {
  std::uint32_t number = 0;
  for (const char byte : read_bytes(in, 4)) number = number << 8 | static_cast<unsigned char>(byte);
  return in ? number : 0;
}

bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }

}  // namespace

void check_png_chunks(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string signature = read_bytes(in, 8);
  if (!signature.starts_with("\x89PNG")) return;
  const auto fail = [&](std::string_view what) {
    throw Error(ExitCode::input, fmt::format("{}: is damaged or cut short ({}); copy it again",
                                             file.string(), what));
  };
  if (!"\x89PNG\r\n\x1a\n"sv.starts_with(signature))
    fail("its line ends were changed, as by a transfer as text");
  const std::uintmax_t file_bytes = std::filesystem::file_size(file);
  std::string type;
  while (type != "IEND") {
    const std::uint32_t size = read_number(in);
    type = read_bytes(in, 4);
    if (!in || size > file_bytes - std::uintmax_t(in.tellg()))
      fail("it ends before its last chunk");
    const std::string name = printable(type);
    if (!std::ranges::all_of(type, is_letter)) fail(fmt::format("it has a chunk '{}'", name));
    type += read_bytes(in, size);
    const std::uint32_t sum = read_number(in);
    if (!in) fail(fmt::format("it ends in its chunk '{}'", name));
    constexpr char kNotNeeded = 0x20;  // of the first letter: it is a small one
    if (!(type[0] & kNotNeeded) && sum != libdeflate_crc32(0, type.data(), type.size()))
      fail(fmt::format("its chunk '{}' has another checksum", name));
    type.resize(4);
  }
}

}  // namespace ssdo
