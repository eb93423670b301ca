// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/transfer_curve.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

using Kind = TransferCurve::Kind;

/// In lower case, letters and digits only.
std::string compact(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      out += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return out;
}

/// The exponent of "g22..." and "gamma22", or 0.
float exponent_in(const std::string& name) {
  for (const std::string_view start : {"gamma", "g"}) {
    if (!name.starts_with(start) || name.size() < start.size() + 2) continue;
    const std::string digits = name.substr(start.size(), 2);
    if (std::isdigit(static_cast<unsigned char>(digits[0])) &&
        std::isdigit(static_cast<unsigned char>(digits[1])))
      return std::strtof(digits.c_str(), nullptr) / 10;
  }
  return 0;
}

/// IEC 61966-2-1.
float srgb_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

/// ITU-R BT.709-6, item 1.2.
float rec709_to_linear(float v) {
  return v < 0.081f ? v / 4.5f : std::pow((v + 0.099f) / 1.099f, 1 / 0.45f);
}

}  // namespace

float TransferCurve::to_linear(float value) const {
  const float size = std::abs(value);
  const float light = kind == Kind::srgb     ? srgb_to_linear(size)
                      : kind == Kind::rec709 ? rec709_to_linear(size)
                      : kind == Kind::power  ? std::pow(size, exponent)
                                             : size;
  return std::copysign(light, value);
}

std::optional<TransferCurve> curve_of(const std::string& space) {
  const std::string name = compact(space);
  const auto has = [&](const char* word) { return name.find(word) != std::string::npos; };
  const auto power = [&](float exponent) { return TransferCurve{space, Kind::power, exponent}; };
  if (has("lin")) return std::nullopt;
  if (has("srgb")) return TransferCurve{space, Kind::srgb};
  if (const float exponent = exponent_in(name); exponent > 1) return power(exponent);
  if (has("rec1886") || has("bt1886")) return power(2.4f);
  if (has("adobergb")) return power(563 / 256.0f);
  if (name == "rec709" || name == "bt709") return TransferCurve{space, Kind::rec709};
  for (const char* curve : {"log", "acescc", "pq", "hlg", "st2084"})
    if (has(curve)) return TransferCurve{space, Kind::unknown};
  return std::nullopt;
}

std::optional<TransferCurve> curve_of(const Imf::Header& header) {
  for (const char* attribute : {"colorInteropID", "oiio:ColorSpace"}) {
    const std::string space = string_attribute(header, attribute);
    if (!space.empty()) return curve_of(space);
  }
  return std::nullopt;
}

}  // namespace ssdo
