// SPDX-License-Identifier: Apache-2.0
//
// Compiled once for every instruction set.
#include "scene/solids/connections.h"

#include "parallel/tiles.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/solids/connections.cpp"
#include <hwy/foreach_target.h>

#include "scene/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// on_one_surface() of vectors of surfels.
HWY_INLINE M are_connected(const Surfels& a, const Surfels& b, const PixelFootprint& footprint) {
  const V3 step = b.position - a.position;
  const V of_a = dot(step, a.normal), of_b = dot(step, b.normal),
          gap = hn::Max(hn::Abs(of_a), hn::Abs(of_b)), above = hn::Max(of_a, hn::Neg(of_b));
  // A footprint is a multiple of the depth, or the same everywhere.
  const V nearer = hn::Neg(hn::Max(a.position.z, b.position.z));
  const float at_zero = footprint.at(0), per_depth = footprint.at(1) - at_zero;
  const V width = hn::MulAdd(nearer, set(per_depth), set(at_zero));
  const M ridge = hn::And(gap <= set(kRidgeGap) * width, above <= set(kAboveRidge) * width);
  return hn::And(hn::And(a.surface, b.surface), hn::Or(gap <= set(kSurfaceGap) * width, ridge));
}

void connect_row(const Geometry& geometry, int y, Plane<unsigned char>& out) {
  const Surfaces& surfels = geometry.surfaces;
  const PixelFootprint footprint(geometry.camera);
  for (int x = 0; x < surfels.width; x += kLanes) {
    const Surfels p = surfels_at(surfels, x, y);
    VU bits = hn::IfThenElseZero(hn::RebindMask(DU(), p.surface), set_bits(kShowsSurface));
    for (std::size_t k = 0; k < kDirections.size(); ++k) {
      const auto [dx, dy] = kDirections[k];
      const M connected = are_connected(p, surfels_at(surfels, x + dx, y + dy), footprint);
      bits = hn::Or(bits, hn::IfThenElseZero(hn::RebindMask(DU(), connected), set_bits(1u << k)));
    }
    alignas(64) unsigned lanes[kLanes];
    hn::Store(bits, DU(), lanes);
    for (int lane = 0; lane < kLanes && x + lane < surfels.width; ++lane)
      out(x + lane, y) = static_cast<unsigned char>(lanes[lane]);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(connect_row);

Plane<unsigned char> find_connections(const Geometry& geometry) {
  Plane<unsigned char> out(geometry.surfaces.width, geometry.surfaces.height);
  for_each_row(out.height, [&](int y) { HWY_DYNAMIC_DISPATCH(connect_row)(geometry, y, out); });
  return out;
}

}  // namespace ssdo
#endif
