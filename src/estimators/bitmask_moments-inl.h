// SPDX-License-Identifier: Apache-2.0
//
// Which directions are open, in spherical harmonics: the visible set of a pixel against the light
// of the environment, for a vector of pixels.
#if defined(SSDO_BITMASK_MOMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_MOMENTS_INL_H_
#undef SSDO_BITMASK_MOMENTS_INL_H_
#else
#define SSDO_BITMASK_MOMENTS_INL_H_
#endif

#include <hwy/highway.h>

#include "estimators/bitmask_lanes-inl.h"
#include "estimators/sector_directions.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Adds `weight` times each basis polynomial in the unit direction (x, y, z): the real spherical
/// harmonics up to kOrder without their constants, l*l + l + m.
template <int kOrder>
HWY_INLINE void add_basis(V x, V y, V z, V weight, V* sum) {
  const D d;
  const auto add = [&](int i, V value) HWY_ATTR { sum[i] = hn::MulAdd(weight, value, sum[i]); };
  const auto number = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  sum[0] = sum[0] + weight;
  add(1, y), add(2, z), add(3, x);
  if constexpr (kOrder >= 2) {
    const V xx = x * x, yy = y * y, zz = z * z, xy = x * y;
    const V x2y2 = xx - yy;
    add(4, xy), add(5, y * z), add(6, hn::MulSub(number(3), zz, number(1))), add(7, x * z);
    add(8, x2y2);
    if constexpr (kOrder >= 3) {
      const V y3 = y * hn::MulSub(number(3), xx, yy), x3 = x * hn::NegMulAdd(number(3), yy, xx);
      const V z5 = hn::MulSub(number(5), zz, number(1));
      add(9, y3), add(10, xy * z), add(11, y * z5);
      add(12, z * hn::MulSub(number(5), zz, number(3))), add(13, x * z5), add(14, z * x2y2);
      add(15, x3);
      if constexpr (kOrder >= 4) {
        const V z71 = hn::MulSub(number(7), zz, number(1)),
                z73 = z * hn::MulSub(number(7), zz, number(3));
        add(16, xy * x2y2), add(17, y3 * z), add(18, xy * z71), add(19, y * z73);
        add(20, hn::MulAdd(hn::MulSub(number(35), zz, number(30)), zz, number(3)));
        add(21, x * z73), add(22, x2y2 * z71), add(23, x3 * z);
        add(24, xx * hn::NegMulAdd(number(3), yy, xx) - yy * hn::MulSub(number(3), xx, yy));
      }
    }
  }
}

/// In each group of four of `bits`: how many are set, and the sum of their places.
struct GroupCounts {
  VU count, places;
};

HWY_INLINE GroupCounts count_groups(VU bits) {
  const DU du;
  const auto fold = [&](VU v, unsigned mask, int shift) HWY_ATTR {
    return hn::And(hn::ShiftRightSame(v, shift), hn::Set(du, mask));
  };
  const VU odd = fold(bits, 0x55555555u, 1);
  const VU pairs = fold(bits, 0x55555555u, 0) + odd;
  const VU high = fold(pairs, 0x33333333u, 2);
  return {fold(pairs, 0x33333333u, 0) + high,
          fold(odd, 0x33333333u, 0) + fold(odd, 0x33333333u, 2) + high + high};
}

/// Sums over slices: of what is open, and of its moments.
template <int kOrder>
struct Moments {
  static constexpr int kCount = (kOrder + 1) * (kOrder + 1);
  static constexpr int kGroups = 8;  ///< of four sectors: each group is one direction

  V open = hn::Zero(D()), whole = hn::Zero(D());
  V visible[kCount], hidden[kCount];

  HWY_INLINE Moments() {
    for (int i = 0; kOrder > 0 && i < kCount; ++i) visible[i] = hidden[i] = hn::Zero(D());
  }

  HWY_INLINE void add(const Receiver& p, const Half& half, VU bits, V slice_weight, float phase) {
    const D d;
    const V weight = slice_weight * half.measure;
    whole = hn::MulAdd(weight, hn::Set(d, kSectors), whole);
    open = hn::MulAdd(
        weight,
        hn::Set(d, kSectors) - hn::ConvertTo(d, hn::BitCast(DI(), hn::PopulationCount(bits))),
        open);
    if constexpr (kOrder > 0) add_directions(p, half, bits, weight, phase);
  }

  /// The part of the light with these weights that is visible. Part and whole are sums over the
  /// same directions, so that their noise cancels: what is open has all of it.
  HWY_INLINE V share_of_light(const float* light, V otherwise) const {
    const D d;
    V part = hn::Zero(d), total = hn::Zero(d);
    for (int i = 0; i < kCount; ++i) {
      const V l = hn::Set(d, light[i]);
      part = hn::MulAdd(l, visible[i], part);
      total = hn::MulAdd(l, visible[i] + hidden[i], total);
    }
    const V share = hn::Clamp(part / total, hn::Zero(d), hn::Set(d, 1.0f));
    return hn::IfThenElse(total > hn::Zero(d), share, otherwise);
  }

  /// The mean open direction, not normalised. Of an open surface it is the normal, whatever the
  /// slices: what their sum over all directions lacks of it is added as far as the surface is open.
  HWY_INLINE void bent_normal(const Receiver& p, V ao, V bent[3]) const {
    const V normal[3] = {p.nx, p.ny, p.nz};
    for (int c = 0; c < 3; ++c) {
      const int band = 1 + (c + 2) % 3;  // bands of order 1 are y, z, x
      const V expected = hn::Set(D(), 2.0f / 3) * (visible[0] + hidden[0]) * normal[c];
      bent[c] = hn::MulAdd(ao, expected - (visible[band] + hidden[band]), visible[band]);
    }
  }

  HWY_INLINE Moments minus(const Moments& other) const {
    Moments rest = *this;
    for (int i = 0; i < kCount; ++i) {
      rest.visible[i] = visible[i] - other.visible[i];
      rest.hidden[i] = hidden[i] - other.hidden[i];
    }
    return rest;
  }

 private:
  HWY_INLINE void add_directions(const Receiver& p, const Half& half, VU bits, V weight,
                                 float phase) {
    const D d;
    const DI di;
    const DU du;
    const SectorDirections& table = sector_directions();
    const auto row = hn::ConvertTo(
        di, hn::Clamp(hn::MulAdd(half.gamma, hn::Set(d, SectorDirections::kAngles / kPi),
                                 hn::Set(d, SectorDirections::kAngles / 2.0f)),
                      hn::Zero(d), hn::Set(d, SectorDirections::kAngles - 1.0f)));
    const auto row_start = hn::ShiftLeft<7>(row);
    static_assert(SectorDirections::kShares == 128 && kSectors == 32);
    const GroupCounts counts = count_groups(bits);
    // `number` sectors of group g, whose places have the sum `places`.
    const auto direction = [&](int g, V number, V places) HWY_ATTR {
      struct Direction {
        V x, y, z;
      };
      const V place =
          places / hn::Max(number, hn::Set(d, 1.0f)) + hn::Set(d, 4.0f * float(g) + phase);
      const auto column = hn::Min(hn::ConvertTo(di, place * hn::Set(d, 4.0f)), hn::Set(di, 127));
      const auto packed = hn::GatherIndex(di, table.packed.data(), row_start + column);
      const V scale = hn::Set(d, 1 / 32767.0f);
      const V cosine = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(packed))) * scale,
              sine = hn::ConvertTo(d, hn::ShiftRight<16>(packed)) * scale;
      return Direction{hn::MulAdd(cosine, p.vx, sine * half.tx),
                       hn::MulAdd(cosine, p.vy, sine * half.ty),
                       hn::MulAdd(cosine, p.vz, sine * half.tz)};
    };
    for (int g = 0; g < kGroups; ++g) {
      const auto of_group = [&](VU v) HWY_ATTR {
        return hn::ConvertTo(
            d, hn::BitCast(di, hn::And(hn::ShiftRightSame(v, 4 * g), hn::Set(du, 15u))));
      };
      const V number = of_group(counts.count), places = of_group(counts.places);
      const V four = hn::Set(d, 4.0f), all_places = hn::Set(d, 6.0f);
      if (!hn::AllFalse(d, number < four)) {
        const auto to = direction(g, four - number, all_places - places);
        const V share = weight * (four - number);
        add_basis<kOrder>(to.x, to.y, to.z, share, visible);
      }
      if (!hn::AllFalse(d, number > hn::Zero(d))) {
        const auto to = direction(g, number, places);
        add_basis<kOrder>(to.x, to.y, to.z, weight * number, hidden);
      }
    }
  }
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
