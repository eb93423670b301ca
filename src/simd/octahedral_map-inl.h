// SPDX-License-Identifier: Apache-2.0
//
// OctahedralMap for vectors of directions; compiled once for every instruction set.
#if defined(SSDO_SIMD_OCTAHEDRAL_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_OCTAHEDRAL_MAP_INL_H_
#undef SSDO_SIMD_OCTAHEDRAL_MAP_INL_H_
#else
#define SSDO_SIMD_OCTAHEDRAL_MAP_INL_H_
#endif

#include "math/octahedral_map.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The colour of the map in the direction of each lane, which need not be unit:
/// OctahedralMap::operator().
HWY_INLINE V3 look_up(const OctahedralMap& map, const V3& direction) {
  const D d;
  const DI di;
  const V scale = set(1) / (hn::Abs(direction.x) + hn::Abs(direction.y) + hn::Abs(direction.z));
  V u = direction.x * scale, v = direction.y * scale;
  const M below = direction.z < set(0);
  const V folded_u = hn::CopySign(set(1) - hn::Abs(v), u),
          folded_v = hn::CopySign(set(1) - hn::Abs(u), v);
  u = hn::IfThenElse(below, folded_u, u), v = hn::IfThenElse(below, folded_v, v);
  const V half = set(0.5f), cells = set(float(map.size() - 1));
  u = hn::MulAdd(u, half, half) * cells, v = hn::MulAdd(v, half, half) * cells;
  const VI first = set_int(0), last = set_int(map.size() - 2);
  const VI x = hn::Min(hn::Max(hn::ConvertTo(di, u), first), last),
           y = hn::Min(hn::Max(hn::ConvertTo(di, v), first), last);
  u = u - hn::ConvertTo(d, x), v = v - hn::ConvertTo(d, y);
  const VI node = (y * set_int(map.size()) + x) * set_int(3);
  const auto channel = [&](int c) HWY_ATTR {
    const auto at = [&](int across, int down) HWY_ATTR {
      return gather(map.data() + 3 * (down * map.size() + across) + c, node);
    };
    const V a = at(0, 0), b = at(0, 1);
    const V top = hn::MulAdd(u, at(1, 0) - a, a), bottom = hn::MulAdd(u, at(1, 1) - b, b);
    return hn::MulAdd(v, bottom - top, top);
  };
  return {channel(0), channel(1), channel(2)};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
