// SPDX-License-Identifier: Apache-2.0
//
// The surfaces of a frame as the other frames of its shot look them up: half as large as surfels,
// and without borders to be tested for.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "math/uninitialized.h"
#include "scene/camera/camera_change.h"
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

/// The surfaces of a frame, with a border of one pixel that shows nothing.
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
  /// The centre of the pixel with that index, in pixels of the display window.
  glm::dvec2 centre(std::size_t i) const {
    const auto row = i / std::size_t(stride()), column = i % std::size_t(stride());
    return {double(column) + window.x0 - 0.5, double(row) + window.y0 - 0.5};
  }
  std::size_t size() const { return std::size_t(stride()) * std::size_t(window.height() + 2); }
};

/// The unit normal of a pixel that shows a surface.
inline glm::vec3 normal_of(const KeptSurface& surface) {
  constexpr std::uint32_t kMask = (1u << KeptSurface::kNormalBits) - 1;
  const auto coordinate = [](std::uint32_t steps) {
    return float(steps & kMask) / KeptSurface::kNormalSteps - 1;
  };
  glm::vec3 n(coordinate(surface.packed), coordinate(surface.packed >> KeptSurface::kNormalBits),
              0);
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  const float below = std::max(-n.z, 0.0f);  // the folded half
  n.x -= std::copysign(below, n.x), n.y -= std::copysign(below, n.y);
  return glm::normalize(n);
}

/// The rounding of a pixel, in scene units.
inline float rounding_of(const KeptSurface& surface, const KeptSurfaces& surfaces) {
  return std::bit_cast<float>(
      (surface.packed >> KeptSurface::kRoundingShift << KeptSurface::kFloatShift) +
      surfaces.least_rounding);
}

/// Normals are kept to 0.001 radians, and roundings to an eighth, upward.
KeptSurfaces keep_surfaces(const Geometry& geometry);

}  // namespace ssdo
