// SPDX-License-Identifier: Apache-2.0
#include "cli/option_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "error.h"
#include "jobs/machine/memory.h"
#include "math/number.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

constexpr std::array<std::pair<std::string_view, DepthKind>, 3> kDepthKinds = {
    {{"planar", DepthKind::planar}, {"ray", DepthKind::ray}, {"inverse", DepthKind::inverse}}};
constexpr std::string_view kNormalized = "normalized:";  ///< followed by NEAR,FAR

struct CompressionRow {
  std::string_view name;
  Imf::Compression compression;
  int most = 0;  ///< levels go from 1 to this one; 0: there are none
};
constexpr CompressionRow kCompressions[] = {
    {"none", Imf::NO_COMPRESSION},           {"rle", Imf::RLE_COMPRESSION},
    {"zips", Imf::ZIPS_COMPRESSION, 12},     {"zip", Imf::ZIP_COMPRESSION, 12},
    {"piz", Imf::PIZ_COMPRESSION},           {"pxr24", Imf::PXR24_COMPRESSION},
    {"b44", Imf::B44_COMPRESSION},           {"b44a", Imf::B44A_COMPRESSION},
    {"dwaa", Imf::DWAA_COMPRESSION, 100000}, {"dwab", Imf::DWAB_COMPRESSION, 100000}};

[[noreturn]] void throw_usage(const std::string& message) { throw Error(ExitCode::usage, message); }

/// Two numbers, A,B; nothing for any other text.
std::optional<std::pair<double, double>> read_pair(const std::string& text) {
  const auto comma = text.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const auto a = parse_number(text.substr(0, comma)), b = parse_number(text.substr(comma + 1));
  return a && b ? std::optional(std::pair(*a, *b)) : std::nullopt;
}

/// The most frames around one: all of them are in memory at once.
constexpr int kMostAround = 100;
constexpr int kLargestStep = 10000;

/// A whole number from 1 to `most`, in digits alone; nothing for any other text.
std::optional<int> read_whole(const std::string& text, int most) {
  int number = 0;
  const char* const end = text.data() + text.size();
  const auto [next, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || next != end || number < 1 || number > most) return std::nullopt;
  return number;
}

}  // namespace

std::optional<double> read_length(const std::string& option, std::string_view text) {
  if (text == "auto") return std::nullopt;
  if (text == "inf") return std::numeric_limits<double>::infinity();
  const auto value = parse_number(text);
  if (!value || *value <= 0)
    throw_usage(fmt::format("{}: '{}' is no positive number, nor auto or inf", option, text));
  return value;
}

std::vector<std::string> depth_kind_names() {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kDepthKinds) names.emplace_back(name);
  return names;
}

std::string depth_kind_forms() {
  return fmt::format("{} or {}NEAR,FAR", fmt::join(depth_kind_names(), ", "), kNormalized);
}

void read_depth_kind(const std::string& text, GBufferOptions& out) {
  for (const auto& [name, kind] : kDepthKinds) {
    if (text != name) continue;
    out.depth_kind = kind;
    return;
  }
  const bool normalized = text.starts_with(kNormalized);
  const auto range = read_pair(normalized ? text.substr(kNormalized.size()) : "");
  if (!range || range->first == range->second) {
    throw_usage(fmt::format("--depth-kind {}: {}expected {} in scene units", text,
                            did_you_mean(text, depth_kind_names()), depth_kind_forms()));
  }
  out.depth_kind = DepthKind::normalized;
  out.depth_near = float(range->first);
  out.depth_far = float(range->second);
}

std::vector<std::string> compression_names() {
  std::vector<std::string> names;
  for (const CompressionRow& row : kCompressions) names.emplace_back(row.name);
  return names;
}

std::string compression_forms() {
  std::string forms;
  for (const CompressionRow& row : kCompressions) {
    forms += fmt::format("{}{}", forms.empty() ? "" : ", ", row.name);
    if (row.most > 0) forms += fmt::format("[:1..{}]", row.most);
  }
  return forms;
}

void read_compression(const std::string& text, OutputOptions& out) {
  const auto colon = text.find(':');
  const bool levelled = colon != std::string::npos;
  for (const CompressionRow& row : kCompressions) {
    if (text.substr(0, colon) != row.name) continue;
    out.compression = row.compression;
    out.compression_level = levelled ? read_whole(text.substr(colon + 1), row.most) : std::nullopt;
    if (out.compression_level || !levelled) return;
    if (row.most > 0) {
      throw_usage(fmt::format("--compression {}: expected a level from 1 to {}, such as {}:4", text,
                              row.most, row.name));
    }
    throw_usage(fmt::format("--compression {0}: {1} has no levels; give --compression {1}", text,
                            row.name));
  }
  throw_usage(fmt::format("--compression {}: {}expected one of {}", text,
                          did_you_mean(text.substr(0, colon), compression_names()),
                          compression_forms()));
}

glm::vec2 read_motion_scale(const std::string& text) {
  const auto scale = read_pair(text);
  const auto usable = [](double factor) { return std::isfinite(factor) && factor != 0; };
  if (!scale || !usable(scale->first) || !usable(scale->second))
    throw_usage(fmt::format("--motion-scale {}: expected two factors X,Y, such as -1,-1", text));
  return {float(scale->first), float(scale->second)};
}

ShotWindow read_shot(const std::string& text) {
  const auto cross = text.find('x');
  const bool stepped = cross != std::string::npos;
  const auto count = read_whole(text.substr(0, cross), kMostAround),
             step = stepped ? read_whole(text.substr(cross + 1), kLargestStep) : 1;
  if (!count || !step) {
    throw_usage(
        fmt::format("--shot {}: expected K or KxSTEP, K frames before and after from "
                    "1 to {} and a STEP from 1 to {}, such as 2 or 4x2",
                    text, kMostAround, kLargestStep));
  }
  return {*count, *step};
}

std::size_t read_mem_limit(const std::string& text) {
  if (const auto size = parse_size(text)) return *size;
  throw_usage(fmt::format("--mem-limit {}: expected {}", text, kSizeForm));
}

SaveRequest read_save(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw_usage(fmt::format("--save {}: expected PRODUCT=FILE", text));
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

CLI::Validator between(double low, double high) {
  const std::string range = fmt::format("a number from {:g} to {:g}", low, high);
  return CLI::Validator(
      [=](std::string& text) {
        const auto value = parse_number(text);
        return value && *value >= low && *value <= high
                   ? std::string()
                   : fmt::format("'{}' is not {}", text, range);
      },
      "");
}

CLI::Validator positive() { return between(1e-30, 1e30); }

}  // namespace ssdo
