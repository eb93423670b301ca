// SPDX-License-Identifier: Apache-2.0
//
// Surfels in vectors; compiled once for every instruction set.
#if defined(SSDO_SCENE_SURFEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_SURFEL_INL_H_
#undef SSDO_SCENE_SURFEL_INL_H_
#else
#define SSDO_SCENE_SURFEL_INL_H_
#endif

#include <algorithm>

#include "math/plane.h"
#include "scene/surfel.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A vector of surfels; where there is no surface, only `surface` is valid.
struct Surfels {
  V3 position, normal;
  V rounding;
  M surface;
};

HWY_INLINE Surfels load_surfels(const Surfel* from) {
  static_assert(sizeof(Surfel) == 8 * sizeof(float));
#if HWY_TARGET == HWY_SCALAR
  return {set(from->position), set(from->normal), set(from->rounding), set(from->valid) != set(0)};
#else
  const D d;
  // Position and validity, normal and rounding, position, ... of two halves of the vector.
  V x0, y0, z0, w0, x1, y1, z1, w1;
  hn::LoadInterleaved4(d, &from[0].position.x, x0, y0, z0, w0);
  hn::LoadInterleaved4(d, &from[kLanes / 2].position.x, x1, y1, z1, w1);
  const auto even = [d](V a, V b) HWY_ATTR { return hn::ConcatEven(d, b, a); };
  const auto odd = [d](V a, V b) HWY_ATTR { return hn::ConcatOdd(d, b, a); };
  return {{even(x0, x1), even(y0, y1), even(z0, z1)},
          {odd(x0, x1), odd(y0, y1), odd(z0, z1)},
          odd(w0, w1),
          even(w0, w1) != set(0)};
#endif
}

/// The surfels from column `x` of row `y` on; outside of the picture there is no surface.
HWY_INLINE Surfels surfels_at(const Plane<Surfel>& surfels, int x, int y) {
  const bool in_rows = y >= 0 && y < surfels.height;
  if (in_rows && x >= 0 && x + kLanes <= surfels.width) return load_surfels(&surfels(x, y));
  Surfel copies[kLanes];
  for (int k = 0; k < kLanes && in_rows; ++k)
    if (x + k >= 0 && x + k < surfels.width) copies[k] = surfels(x + k, y);
  return load_surfels(copies);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
