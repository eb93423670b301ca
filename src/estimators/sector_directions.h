// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace ssdo {

/// Where in a half-slice its sectors lie: the inverse of the cosine measure of bitmask.cpp. Rows
/// are the normal's angle gamma from V, -pi/2 to pi/2; columns the share u of the measure, 0 to 1.
struct SectorDirections {
  static constexpr int kAngles = 256, kShares = 128;

  /// cos theta in the low and sin theta in the high 16 bits, signed, in units of 1/32767.
  std::array<std::int32_t, kAngles * kShares> packed;
};

const SectorDirections& sector_directions();

}  // namespace ssdo
