// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/kept_surfaces.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

const KeptSurface kNothing{{0, 0, -std::numeric_limits<float>::infinity()}, 0};

/// Meyer et al., "On Floating-Point Normal Vectors", 2010: the octahedron's lower half is folded
/// over the upper one.
std::uint32_t pack_normal(const glm::vec3& n) {
  const float size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(size > 0)) return 0;
  float u = n.x / size, v = n.y / size;
  if (n.z < 0) {
    const float folded = std::copysign(1 - std::abs(v), u);
    v = std::copysign(1 - std::abs(u), v), u = folded;
  }
  constexpr float kSteps = KeptSurface::kNormalSteps;
  const auto step = [](float part) {
    return std::uint32_t(std::clamp(std::round(part * kSteps) + kSteps, 0.0f, 2 * kSteps));
  };
  return step(u) | step(v) << KeptSurface::kNormalBits;
}

/// Steps of rounding above 0, no less than the number.
std::uint32_t steps_of(float rounding) {
  const auto bits = std::bit_cast<std::uint32_t>(std::max(rounding, 0.0f));
  return (bits + (1u << KeptSurface::kFloatShift) - 1) >> KeptSurface::kFloatShift;
}

}  // namespace

KeptSurfaces keep_surfaces(const Geometry& geometry) {
  const Surfaces& surfaces = geometry.surfaces;
  KeptSurfaces kept{geometry.camera, geometry.window, geometry.world_known, 0, {}};
  std::uint32_t most = 0;
  for (const Surfel& s : surfaces)
    if (s.is_surface()) most = std::max(most, steps_of(s.rounding));
  const std::uint32_t least = most - std::min(most, 255u);
  kept.least_rounding = least << KeptSurface::kFloatShift;
  kept.pixels.resize(kept.size());
  for_each_row(surfaces.height + 2, [&](int row) {
    KeptSurface* out = &kept.pixels[kept.index(-1, row - 1)];
    std::fill_n(out, kept.stride(), kNothing);
    if (row == 0 || row > surfaces.height) return;
    for (int x = 0; x < surfaces.width; ++x) {
      const Surfel& s = surfaces(x, row - 1);
      if (!s.is_surface()) continue;
      const std::uint32_t steps = steps_of(s.rounding);
      out[x + 1] = {s.position, pack_normal(s.normal) | (steps - std::min(steps, least))
                                                            << KeptSurface::kRoundingShift};
    }
  });
  return kept;
}

}  // namespace ssdo
