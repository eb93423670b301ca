// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/vec3.hpp>

#include "math/plane.h"

namespace ssdo {

/// A colour in EXR's half format: 11 significant bits per channel, each in 0..65504.
struct HalfColor {
  static constexpr float kMost = 65504;
  /// Factor from a float that has the bits of a half, shifted by kShift, to the value of the half.
  static constexpr float kScale = 0x1p112f;
  static constexpr int kShift = 13;  ///< from the bits of a half to those of a float

  std::uint16_t r = 0, g = 0, b = 0;

  HalfColor() = default;
  /// The nearest; not-a-number is 0.
  HalfColor(const glm::vec3& color) : r(bits(color.x)), g(bits(color.y)), b(bits(color.z)) {}

  operator glm::vec3() const { return {value(r), value(g), value(b)}; }

 private:
  static std::uint16_t bits(float channel) {
    const float clamped = channel > 0 ? std::min(channel, kMost) : 0;
    const auto whole = std::bit_cast<std::uint32_t>(clamped * (1 / kScale));
    const std::uint32_t below_half = (1u << (kShift - 1)) - 1, odd = whole >> kShift & 1;
    return std::uint16_t((whole + below_half + odd) >> kShift);
  }
  static float value(std::uint16_t bits) {
    return std::bit_cast<float>(std::uint32_t(bits) << kShift) * kScale;
  }
};

inline glm::vec3 operator*(const HalfColor& a, const glm::vec3& b) { return glm::vec3(a) * b; }

}  // namespace ssdo
