// SPDX-License-Identifier: Apache-2.0
//
// Surfels in vectors; compiled once for every instruction set.
#if defined(SSDO_SCENE_SURFACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_SURFACES_INL_H_
#undef SSDO_SCENE_SURFACES_INL_H_
#else
#define SSDO_SCENE_SURFACES_INL_H_
#endif

#include "scene/surfaces.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A vector of surfels; where there is no surface, only `surface` is valid.
struct Surfels {
  V3 position, normal;
  V rounding;
  M surface;
};

/// The surfels from column `x` of row `y` on; outside of the picture there is no surface.
HWY_INLINE Surfels surfels_at(const Surfaces& surfaces, int x, int y) {
  const auto read = [&surfaces](const auto& values) HWY_ATTR {
    const auto read3 = [&values](const std::array<Plane<float>, 3>& planes) HWY_ATTR {
      return V3{values(planes[0]), values(planes[1]), values(planes[2])};
    };
    const V rounding = values(surfaces.rounding);
    return Surfels{read3(surfaces.position), read3(surfaces.normal), rounding, rounding >= set(0)};
  };
  if (y < 0 || y >= surfaces.height)
    return read([](const Plane<float>&) HWY_ATTR { return set(Surfel::kBackground); });
  const std::size_t row = surfaces.index(0, y);
  if (x >= 0 && x + kLanes <= surfaces.width)
    return read([i = row + std::size_t(x)](const Plane<float>& plane)
                    HWY_ATTR { return load(&plane[i]); });
  const VI columns = hn::Add(set_int(x), hn::Iota(DI(), 0)),
           inside = hn::Clamp(columns, set_int(0), set_int(surfaces.width - 1));
  Surfels shown =
      read([&](const Plane<float>& plane) HWY_ATTR { return gather(&plane[row], inside); });
  shown.surface = hn::And(shown.surface, hn::RebindMask(D(), hn::Eq(columns, inside)));
  return shown;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
