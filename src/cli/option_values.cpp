// SPDX-License-Identifier: Apache-2.0
#include "cli/option_values.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "error.h"
#include "math/number.h"

namespace ssdo {
namespace {

[[noreturn]] void throw_usage(const std::string& message) { throw Error(ExitCode::usage, message); }

}  // namespace

std::optional<double> read_length(const std::string& option, std::string_view text) {
  if (text == "auto") return std::nullopt;
  if (text == "inf") return std::numeric_limits<double>::infinity();
  const auto value = parse_number(text);
  if (!value || *value <= 0)
    throw_usage(fmt::format("{}: '{}' is no positive number, nor auto or inf", option, text));
  return value;
}

void read_depth_kind(const std::string& text, GBufferOptions& out) {
  static const std::string normalized = "normalized:";
  if (text == "planar") {
    out.depth_kind = DepthKind::planar;
  } else if (text == "ray") {
    out.depth_kind = DepthKind::ray;
  } else if (text == "inverse") {
    out.depth_kind = DepthKind::inverse;
  } else {
    const auto comma = text.find(',');
    const bool shaped = text.starts_with(normalized) && comma != std::string::npos;
    const auto near = shaped
                          ? parse_number(text.substr(normalized.size(), comma - normalized.size()))
                          : std::nullopt;
    const auto far = shaped ? parse_number(text.substr(comma + 1)) : std::nullopt;
    if (!near || !far || *near == *far) {
      throw_usage(
          fmt::format("--depth-kind {}: expected planar, ray, inverse or normalized:NEAR,FAR "
                      "in scene units",
                      text));
    }
    out.depth_kind = DepthKind::normalized;
    out.depth_near = float(*near);
    out.depth_far = float(*far);
  }
}

glm::vec2 read_motion_scale(const std::string& text) {
  const auto comma = text.find(',');
  const auto x = parse_number(text.substr(0, comma)),
             y = comma == std::string::npos ? std::nullopt : parse_number(text.substr(comma + 1));
  if (!x || !y || !std::isfinite(*x) || !std::isfinite(*y) || *x == 0 || *y == 0) {
    throw_usage(fmt::format("--motion-scale {}: expected two factors X,Y, such as -1,-1", text));
  }
  return {float(*x), float(*y)};
}

Quality read_quality(std::string_view text) {
  return text == "draft" ? Quality::draft : text == "final" ? Quality::final : Quality::standard;
}

ProgressStyle read_progress_style(std::string_view text) {
  return text == "none"      ? ProgressStyle::none
         : text == "tractor" ? ProgressStyle::tractor
         : text == "alfred"  ? ProgressStyle::alfred
         : text == "openjd"  ? ProgressStyle::openjd
                             : ProgressStyle::automatic;
}

Imf::Compression read_compression(const std::string& name) {
  static const std::vector<std::pair<std::string, Imf::Compression>> names = {
      {"none", Imf::NO_COMPRESSION},   {"rle", Imf::RLE_COMPRESSION},
      {"zips", Imf::ZIPS_COMPRESSION}, {"zip", Imf::ZIP_COMPRESSION},
      {"piz", Imf::PIZ_COMPRESSION},   {"pxr24", Imf::PXR24_COMPRESSION},
      {"b44", Imf::B44_COMPRESSION},   {"b44a", Imf::B44A_COMPRESSION},
      {"dwaa", Imf::DWAA_COMPRESSION}, {"dwab", Imf::DWAB_COMPRESSION}};
  for (const auto& [known, compression] : names) {
    if (known == name) return compression;
  }
  throw_usage(fmt::format(
      "--compression {}: expected none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab",
      name));
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
