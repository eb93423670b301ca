// SPDX-License-Identifier: Apache-2.0
//
// The surfaces of a frame as the other frames of its shot look them up: half as large as surfels,
// and without borders to be tested for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <vector>

#include "math/uninitialized.h"
#include "scene/geometry.h"

namespace ssdo {

/// What a pixel shows. Two pixels side by side lie in 32 bytes.
struct KeptSurface {
  glm::vec3 position;  ///< camera space; z is -infinity where there is no surface
  /// From the lowest bit: the two coordinates of the octahedral map of the normal, 12 bits each,
  /// 2047 being 0; then 8 bits of the rounding, those of a float from bit 20 on, counted from
  /// KeptSurfaces::least_rounding.
  std::uint32_t packed;

  static constexpr int kNormalBits = 12, kRoundingShift = 24, kFloatShift = 20;
  static constexpr float kNormalSteps = 2047;  ///< from 0 to 1
};
static_assert(sizeof(KeptSurface) == 16);

/// As four numbers for vectors.
inline void copy_bits(const KeptSurface& from, float (&to)[4]) {
  std::memcpy(to, static_cast<const void*>(&from), sizeof(from));
}

/// Those of a frame, with a border of one pixel that shows nothing.
struct KeptSurfaces {
  Camera camera;
  Window window;
  bool world_known = false;
  std::uint32_t least_rounding = 0;  ///< bits of a float
  std::vector<KeptSurface, Uninitialized<KeptSurface>> pixels;

  int stride() const { return window.width() + 2; }
  std::size_t index(int x, int y) const {
    return std::size_t(y + 1) * std::size_t(stride()) + std::size_t(x + 1);
  }
  std::size_t size() const { return std::size_t(stride()) * std::size_t(window.height() + 2); }
};

/// Normals are kept to 0.001 radians, and roundings to an eighth, upward.
KeptSurfaces keep_surfaces(const Geometry& geometry);

}  // namespace ssdo
