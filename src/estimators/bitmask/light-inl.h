// SPDX-License-Identifier: Apache-2.0
//
// Light that arrives where nothing is in its way, for a vector of pixels; see bitmask.cpp.
#if defined(SSDO_BITMASK_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_LIGHT_INL_H_
#undef SSDO_BITMASK_LIGHT_INL_H_
#else
#define SSDO_BITMASK_LIGHT_INL_H_
#endif

#include <hwy/highway.h>

#include "estimators/bitmask/lanes-inl.h"
#include "math/light_range.h"
#include "math/luminance.h"
#include "math/octahedral_map.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

struct Color {
  V r, g, b;
};

HWY_INLINE Color load_color(const InterleavedColor& color, std::ptrdiff_t i) {
  const D d;
  return {hn::LoadU(d, color[0].data() + i), hn::LoadU(d, color[1].data() + i),
          hn::LoadU(d, color[2].data() + i)};
}

HWY_INLINE void store_color(const Color& value, InterleavedColor& color, std::ptrdiff_t i) {
  const D d;
  hn::StoreU(value.r, d, color[0].data() + i);
  hn::StoreU(value.g, d, color[1].data() + i);
  hn::StoreU(value.b, d, color[2].data() + i);
}

HWY_INLINE Color scaled(const Color& color, V by) {
  return {color.r * by, color.g * by, color.b * by};
}

HWY_INLINE Color product(const Color& a, const Color& b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}

/// a b + c
HWY_INLINE Color mul_add(const Color& a, V b, const Color& c) {
  return {hn::MulAdd(a.r, b, c.r), hn::MulAdd(a.g, b, c.g), hn::MulAdd(a.b, b, c.b)};
}

HWY_INLINE Color set_color(const glm::vec3& c) {
  const D d;
  return {hn::Set(d, c.x), hn::Set(d, c.y), hn::Set(d, c.z)};
}

/// luminance() of math/luminance.h
HWY_INLINE V luminance(const Color& c) {
  const D d;
  return dot3(hn::Set(d, kLumaRed), hn::Set(d, kLumaGreen), hn::Set(d, kLumaBlue), c.r, c.g, c.b);
}

/// within_range() of math/light_range.h
HWY_INLINE Color within_range(const Color& c) {
  const D d;
  const V most = hn::Set(d, kBrightest), least = hn::Set(d, -kBrightest);
  const auto held = [&](V v) HWY_ATTR {
    return hn::IfThenElseZero(v == v, hn::Min(hn::Max(v, least), most));
  };
  return {held(c.r), held(c.g), held(c.b)};
}

/// Normals as the frame has them; lanes without a surface look at the viewer.
struct Normals {
  V x, y, z;

  HWY_INLINE Normals turned() const {
    const V zero = hn::Zero(D());
    return {zero - x, zero - y, zero - z};
  }
  HWY_INLINE V facing(const glm::vec3& to) const {
    const D d;
    const V cosine = dot3(x, y, z, hn::Set(d, to.x), hn::Set(d, to.y), hn::Set(d, to.z));
    return hn::Max(cosine, hn::Zero(d));
  }
};

HWY_INLINE Normals load_normals(const MarchScene& scene, std::ptrdiff_t i, M valid) {
  const D d;
  return {hn::IfThenElseZero(valid, hn::LoadU(d, scene.nx.data() + i)),
          hn::IfThenElseZero(valid, hn::LoadU(d, scene.ny.data() + i)),
          hn::IfThenElse(valid, hn::LoadU(d, scene.nz.data() + i), hn::Set(d, 1.0f))};
}

/// The map in the direction of each lane: OctahedralMap::operator().
HWY_INLINE Color look_up(const OctahedralMap& map, const Normals& n) {
  const D d;
  const DI di;
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V scale = one / (hn::Abs(n.x) + hn::Abs(n.y) + hn::Abs(n.z));
  V u = n.x * scale, v = n.y * scale;
  const M below = n.z < hn::Zero(d);
  const V folded_u = hn::CopySign(one - hn::Abs(v), u),
          folded_v = hn::CopySign(one - hn::Abs(u), v);
  u = hn::IfThenElse(below, folded_u, u), v = hn::IfThenElse(below, folded_v, v);
  const V cells = hn::Set(d, float(map.size() - 1));
  u = hn::MulAdd(u, half, half) * cells, v = hn::MulAdd(v, half, half) * cells;
  const auto last = hn::Set(di, map.size() - 2), first = hn::Zero(di);
  const auto x = hn::Min(hn::Max(hn::ConvertTo(di, u), first), last),
             y = hn::Min(hn::Max(hn::ConvertTo(di, v), first), last);
  u = u - hn::ConvertTo(d, x), v = v - hn::ConvertTo(d, y);
  const auto node = (y * hn::Set(di, map.size()) + x) * hn::Set(di, 3);
  const auto channel = [&](int c) HWY_ATTR {
    const auto at = [&](int across, int down) HWY_ATTR {
      const float* corner = map.data() + 3 * (down * map.size() + across) + c;
      return hn::GatherIndex(d, corner, node);
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
