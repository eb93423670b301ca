// SPDX-License-Identifier: Apache-2.0
//
// MirrorMap for vectors of directions; compiled once for every instruction set.
#if defined(SSDO_SPECULAR_MIRROR_MAP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SPECULAR_MIRROR_MAP_INL_H_
#undef SSDO_SPECULAR_MIRROR_MAP_INL_H_
#else
#define SSDO_SPECULAR_MIRROR_MAP_INL_H_
#endif

#include "estimators/specular/mirror_map.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// MirrorMap::operator().
HWY_INLINE V3 look_up(const MirrorMap& map, const V3& direction, V solid_angle) {
  const D d;
  const DI di;
  const V manhattan = hn::Abs(direction.x) + hn::Abs(direction.y) + hn::Abs(direction.z);
  const V ratio =
      solid_angle / (set(solid_angle_of_finest(map)) * manhattan * manhattan * manhattan);
  const V log2 = hn::ConvertTo(d, hn::BitCast(di, ratio)) * set(0x1p-23f) - set(127);
  const int last = int(map.levels().size()) - 1;
  const V level = hn::Clamp(set(0.5f) * log2, set(0), set(float(last)));
  const VI k = hn::ConvertTo(di, level), next = hn::Min(k + set_int(1), set_int(last));

  const V scale = set(1) / manhattan;
  V u = direction.x * scale, v = direction.y * scale;
  const M below = direction.z < set(0);
  const V folded_u = hn::CopySign(set(1) - hn::Abs(v), u),
          folded_v = hn::CopySign(set(1) - hn::Abs(u), v);
  const V half = set(0.5f);
  u = hn::MulAdd(hn::IfThenElse(below, folded_u, u), half, half);
  v = hn::MulAdd(hn::IfThenElse(below, folded_v, v), half, half);

  const auto of_level = [&](VI number) HWY_ATTR {
    static_assert(sizeof(MirrorMap::Level) == 2 * sizeof(int));
    const VI at = number + number;
    const VI size = hn::GatherIndex(di, &map.levels()[0].size, at),
             first = hn::GatherIndex(di, &map.levels()[0].first, at);
    const V cells = hn::ConvertTo(d, size - set_int(1)), across = u * cells, down = v * cells;
    const VI end = size - set_int(2);
    const VI x = hn::Clamp(hn::ConvertTo(di, across), set_int(0), end),
             y = hn::Clamp(hn::ConvertTo(di, down), set_int(0), end);
    const V fx = across - hn::ConvertTo(d, x), fy = down - hn::ConvertTo(d, y);
    const VI node = (first + y * size + x) * set_int(3), below_it = node + size * set_int(3);
    const auto channel = [&](int c) HWY_ATTR {
      const auto at_node = [&](VI index, int dx)
                               HWY_ATTR { return gather(map.data() + 3 * dx + c, index); };
      const V a = at_node(node, 0), b = at_node(below_it, 0);
      const V top = hn::MulAdd(fx, at_node(node, 1) - a, a),
              bottom = hn::MulAdd(fx, at_node(below_it, 1) - b, b);
      return hn::MulAdd(fy, bottom - top, top);
    };
    return V3{channel(0), channel(1), channel(2)};
  };
  const V3 fine = of_level(k);
  const V share = level - hn::ConvertTo(d, k);
  if (!any(share > set(0))) return fine;
  return mul_add(of_level(next) - fine, share, fine);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
