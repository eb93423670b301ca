// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/dwa_chunk.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace ssdo {
namespace {

using Bytes = std::span<const std::byte>;

/// Little endian.
std::uint64_t number_of(Bytes bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) number = number << 8 | std::uint64_t(bytes[i]);
  return number;
}

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

/// The rules of chunks that hold none.
std::vector<DwaRule> rules_before_version_2() {
  std::vector<DwaRule> rules;
  for (const char* name : {"r", "red", "g", "grn", "green", "b", "blu", "blue", "y", "by", "ry"}) {
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT})
      rules.push_back({name, type, DwaScheme::transformed, true});
  }
  for (const Imf::PixelType type : {Imf::UINT, Imf::HALF, Imf::FLOAT})
    rules.push_back({"a", type, DwaScheme::runs, true});
  return rules;
}

/// A rule is a text that ends in 0, a byte with its scheme in bits 2 and 3 and whether it ignores
/// case in bit 0, and a byte with its type.
std::optional<std::vector<DwaRule>> read_rules(Bytes bytes) {
  std::vector<DwaRule> rules;
  while (!bytes.empty()) {
    const auto end = std::ranges::find(bytes, std::byte{0});
    if (bytes.end() - end < 3) return std::nullopt;
    std::string suffix;
    for (auto c = bytes.begin(); c != end; ++c) suffix += char(*c);
    const unsigned scheme = std::to_integer<unsigned>(end[1]) >> 2 & 3,
                   type = std::to_integer<unsigned>(end[2]);
    if (scheme > unsigned(DwaScheme::runs) || type >= Imf::NUM_PIXELTYPES) return std::nullopt;
    const bool ignores_case = std::to_integer<unsigned>(end[1]) & 1;
    rules.push_back({suffix, Imf::PixelType(type), DwaScheme(scheme), ignores_case});
    bytes = bytes.subspan(std::size_t(end - bytes.begin()) + 3);
  }
  return rules;
}

}  // namespace

std::optional<DwaChunk> read_dwa_chunk(Bytes packed) {
  std::array<std::uint64_t, 11> numbers;
  if (packed.size() < 8 * numbers.size()) return std::nullopt;
  for (std::uint64_t& number : numbers) {
    number = number_of(packed.first(8));
    packed = packed.subspan(8);
  }
  DwaChunk chunk{.runs = numbers[7], .blocks = numbers[9], .has_coefficients = numbers[3] > 0};
  if (numbers[0] < 2) {
    chunk.rules = rules_before_version_2();
  } else {
    const std::size_t size = packed.size() < 2 ? 0 : number_of(packed.first(2));
    if (size < 2 || size > packed.size()) return std::nullopt;
    auto rules = read_rules(packed.subspan(2, size - 2));
    if (!rules) return std::nullopt;
    chunk.rules = std::move(*rules);
    packed = packed.subspan(size);
  }
  if (numbers[2] > packed.size()) return std::nullopt;
  chunk.deflated = packed.first(numbers[2]);
  return chunk;
}

DwaScheme scheme_of(const ExrChannel& channel, std::span<const DwaRule> rules) {
  const std::string suffix = channel.name.substr(channel.name.rfind('.') + 1),
                    lower_case = in_lower_case(suffix);
  DwaScheme scheme = DwaScheme::deflated;
  for (const DwaRule& rule : rules) {
    if (rule.type == channel.type && rule.suffix == (rule.ignores_case ? lower_case : suffix))
      scheme = rule.scheme;
  }
  return scheme;
}

}  // namespace ssdo
