// SPDX-License-Identifier: Apache-2.0
//
// The visible directions of a pixel in spherical harmonics, and the light of the environment that
// reaches it through them, for a vector of pixels.
//
// On the circle of a slice, harmonics up to order L are sums of cos(k theta) and sin(k theta) with
// k <= L. So their integrals over a set of sectors depend on the moments of the set up to L only,
// and 2 L + 2 equally spaced directions, weighted to have the same moments, replace the set
// exactly. They form L + 1 lines through the centre: harmonics of even order have the same value at
// both ends of a line, those of odd order opposite values.
#if defined(SSDO_BITMASK_MOMENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_MOMENTS_INL_H_
#undef SSDO_BITMASK_MOMENTS_INL_H_
#else
#define SSDO_BITMASK_MOMENTS_INL_H_
#endif

#include "estimators/bitmask/lanes-inl.h"
#include "math/spherical_harmonics-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// table[index], index in 0..15.
HWY_INLINE V lookup16(const float* HWY_RESTRICT table, VU index) {
  const D d;
  if constexpr (kLanes == 16) {
    return hn::TableLookupLanes(hn::Load(d, table), hn::IndicesFromVec(d, index));
  } else if constexpr (kLanes == 8) {
    const auto low = hn::IndicesFromVec(d, hn::And(index, set_bits(7)));
    const M upper = hn::RebindMask(d, index > set_bits(7));
    return hn::IfThenElse(upper, hn::TableLookupLanes(hn::Load(d, table + 8), low),
                          hn::TableLookupLanes(hn::Load(d, table), low));
  } else {
    return gather(table, hn::BitCast(DI(), index));
  }
}

/// table[index], index in 0..31.
HWY_INLINE V lookup32(const float* HWY_RESTRICT table, VU index) {
  const D d;
  if constexpr (kLanes == 16) {
    const auto low = hn::IndicesFromVec(d, hn::And(index, set_bits(15)));
    return hn::IfThenElse(hn::RebindMask(d, index > set_bits(15)),
                          hn::TableLookupLanes(hn::Load(d, table + 16), low),
                          hn::TableLookupLanes(hn::Load(d, table), low));
  } else {
    return gather(table, hn::BitCast(DI(), index));
  }
}

/// Moments of a set of sectors with respect to the angle from V; sine(0) is 0.
template <int kDegree>
struct RawMoments {
  V cosine[kDegree + 1], sine[kDegree + 1];
};

/// Moments 0 to kDegree of a set; `lookup(i)` returns moment i in the numbering of SliceSectors.
template <int kDegree, class Lookup>
HWY_INLINE RawMoments<kDegree> raw_moments(const Lookup& lookup) {
  RawMoments<kDegree> m;
  // The cosine with the normal alone, degree 1, does not need moment 0.
  m.cosine[0] = kDegree > 1 ? lookup(0) : set(0);
  m.sine[0] = set(0);
  for (int k = 1; k <= kDegree; ++k) {
    m.cosine[k] = lookup(k);
    m.sine[k] = lookup(SliceSectors::sine_moment(k));
  }
  return m;
}

template <int kDegree>
HWY_INLINE RawMoments<kDegree> moments_of_first(VU count) {
  const SliceSectors& sectors = slice_sectors();
  return raw_moments<kDegree>(
      [&](int m) HWY_ATTR { return lookup32(sectors.of_first[std::size_t(m)].data(), count); });
}

template <int kDegree>
HWY_INLINE RawMoments<kDegree> moments_of_bits(VU bits) {
  const SliceSectors& sectors = slice_sectors();
  VU groups[8];
  for (int g = 0; g < 8; ++g) groups[g] = hn::And(hn::ShiftRightSame(bits, 4 * g), set_bits(15));
  return raw_moments<kDegree>([&](int m) HWY_ATTR {
    const float* table = sectors.of_group[std::size_t(m)].data();
    V sum = lookup16(table, groups[0]);
    for (int g = 1; g < 8; ++g) sum = sum + lookup16(table + 16 * g, groups[g]);
    return sum;
  });
}

/// RawMoments weighted by the cosine to the normal, around the circle of a slice.
template <int kOrder>
struct CircleMoments {
  V cosine[kOrder + 1], sine[kOrder + 1];

  HWY_INLINE CircleMoments() {
    for (int k = 0; k <= kOrder; ++k) cosine[k] = sine[k] = set(0);
  }

  /// Adds sectors of one side: (n_v cos + n_t sin) cos(k theta), and with sin(k theta), whose sign
  /// is the opposite on the other side.
  HWY_INLINE void add(const RawMoments<kOrder + 1>& m, V n_v, V n_t, bool forward) {
    const V half = set(0.5f);
    cosine[0] = hn::MulAdd(n_v, m.cosine[1], hn::MulAdd(n_t, m.sine[1], cosine[0]));
    const V v = n_v * half, t = n_t * half;
    for (int k = 1; k <= kOrder; ++k) {
      const V c =
          dot(V2{v, t}, V2{m.cosine[k + 1] + m.cosine[k - 1], m.sine[k + 1] - m.sine[k - 1]});
      const V s =
          dot(V2{v, t}, V2{m.sine[k + 1] + m.sine[k - 1], m.cosine[k - 1] - m.cosine[k + 1]});
      cosine[k] = cosine[k] + c;
      sine[k] = forward ? sine[k] + s : sine[k] - s;
    }
  }

  /// Subtracts a share of other moments.
  HWY_INLINE void subtract(const CircleMoments& other, V share) {
    for (int k = 0; k <= kOrder; ++k) {
      cosine[k] = hn::NegMulAdd(share, other.cosine[k], cosine[k]);
      sine[k] = hn::NegMulAdd(share, other.sine[k], sine[k]);
    }
  }

  /// The sum and the difference of the weights of two directions: the one at this angle, which is
  /// one of 2 kOrder + 2, and its opposite.
  HWY_INLINE void at(const float* cosines, const float* sines, V& both, V& difference) const {
    V sums[2] = {cosine[0] * set(0.5f), set(0)};
    for (int k = 1; k <= kOrder; ++k) {
      V& sum = sums[k % 2];
      sum = hn::MulAdd(cosine[k], set(cosines[k]), sum);
      sum = hn::MulAdd(sine[k], set(sines[k]), sum);
    }
    const V scale = set(2.0f / (kOrder + 1));
    both = sums[0] * scale, difference = sums[1] * scale;
  }
};

/// cos and sin of k times each of kOrder + 1 angles that divide the half-circle equally.
template <int kOrder>
struct CircleDirections {
  static constexpr int kCount = kOrder + 1;
  float cosine[kCount][kOrder + 1], sine[kCount][kOrder + 1];

  CircleDirections() {
    for (int j = 0; j < kCount; ++j) {
      for (int k = 0; k <= kOrder; ++k) {
        const double angle = 3.14159265358979324 * j * k / kCount;
        cosine[j][k] = float(std::cos(angle)), sine[j][k] = float(std::sin(angle));
      }
    }
  }
};

/// How far outside of 0..1 the visible part of the light may be.
constexpr float kPartBeyond = 1;

/// The sums of the equations in visibility.cpp, over slices and by spherical harmonic: `hidden`, in
/// bands 0 and 1, `lost` and `all`.
template <int kOrder>
struct Moments {
  static constexpr int kCount = (kOrder + 1) * (kOrder + 1);
  static constexpr int kLowCount = kOrder > 0 ? 4 : 1;

  V hidden[kLowCount], lost[kCount], all[kCount];

  HWY_INLINE Moments() {
    for (int i = 0; i < kLowCount; ++i) hidden[i] = set(0);
    for (int i = 0; i < kCount; ++i) lost[i] = all[i] = set(0);
  }

  /// Bands 0 and 1 are taken from the moments directly, so that ao and the bent normal have the
  /// same bits at every order.
  HWY_INLINE void add(const MarchReceiver& p, const SliceFrame& f,
                      const CircleMoments<kOrder>& hidden_of_slice,
                      const CircleMoments<kOrder>& lost_of_slice,
                      const CircleMoments<kOrder>& all_of_slice) {
    add_low_bands(p, f, hidden_of_slice, hidden);
    add_low_bands(p, f, lost_of_slice, lost);
    add_low_bands(p, f, all_of_slice, all);
    if constexpr (kOrder > 1) {
      static const CircleDirections<kOrder> directions;
      for (int j = 0; j < CircleDirections<kOrder>::kCount; ++j) {
        const float *cosines = directions.cosine[j], *sines = directions.sine[j];
        const V c = set(cosines[1]), s = set(sines[1]);
        V l[2], a[2];
        lost_of_slice.at(cosines, sines, l[0], l[1]);
        all_of_slice.at(cosines, sines, a[0], a[1]);
        for (int k = 0; k < 2; ++k) l[k] = l[k] * f.weight, a[k] = a[k] * f.weight;
        const V3 direction = mul_add(p.to_viewer, c, f.t * s);
        for_each_sh_polynomial<2, kOrder>(
            direction.x, direction.y, direction.z, [](float value) HWY_ATTR { return set(value); },
            [&](int i, V value) HWY_ATTR {
              const int odd = i >= 9 && i < 16;  // band 3
              lost[i] = hn::MulAdd(l[odd], value, lost[i]);
              all[i] = hn::MulAdd(a[odd], value, all[i]);
            });
      }
    }
  }

  /// 1 - M(hidden) / M(all): the visibility of the hemisphere, weighted by the cosine.
  HWY_INLINE V ao() const { return ao_of(hidden[0]); }

  /// ao() if only `sum_of_hidden` is hidden.
  HWY_INLINE V ao_of(V sum_of_hidden) const {
    const V zero = set(0), one = set(1);
    return hn::IfThenElse(all[0] > zero, hn::Clamp(one - sum_of_hidden / all[0], zero, one), one);
  }

  /// 1 - int_lost L dM / int_all L dM, for the light L with these weights. Both sums are over the
  /// same directions, so that noise cancels and an open surface receives exactly all of it.
  /// `otherwise` where there is no light. With noise the result may leave 0..1, so that means over
  /// pixels are right, but only up to a limit: with few slices, int_all may be next to no light.
  HWY_INLINE V visible_part(const float* light, V otherwise) const {
    V light_lost = set(0), light_of_all = set(0);
    for (int i = 0; i < kCount; ++i) {
      const V l = set(light[i]);
      light_lost = hn::MulAdd(l, lost[i], light_lost);
      light_of_all = hn::MulAdd(l, all[i], light_of_all);
    }
    const V part =
        hn::Clamp(set(1) - light_lost / light_of_all, set(-kPartBeyond), set(1 + kPartBeyond));
    return hn::IfThenElse(light_of_all > set(0), part, otherwise);
  }

  /// The mean open direction; `otherwise` where nothing is open. The error of the slices, the
  /// normal less their sum over all directions, is added times the openness, so that an open
  /// surface gives exactly its normal.
  HWY_INLINE V3 bent_normal(const MarchReceiver& p, V ao, const V3& otherwise) const {
    const V full = set(2.0f / 3) * all[0];
    const auto along = [&](V normal, int band) HWY_ATTR {  // bands of order 1 are y, z, x
      return hn::MulAdd(ao, hn::MulSub(full, normal, all[band]), all[band] - hidden[band]);
    };
    const V3 mean{along(p.shading.x, 3), along(p.shading.y, 1), along(p.shading.z, 2)};
    return if_then_else(dot(mean, mean) > set(0), normalise(mean), otherwise);
  }

  HWY_INLINE Moments minus(const Moments& other) const {
    Moments rest = *this;
    for (int i = 0; i < kLowCount; ++i) rest.hidden[i] = hidden[i] - other.hidden[i];
    for (int i = 0; i < kCount; ++i) {
      rest.lost[i] = lost[i] - other.lost[i];
      rest.all[i] = all[i] - other.all[i];
    }
    return rest;
  }

 private:
  HWY_INLINE static void add_low_bands(const MarchReceiver& p, const SliceFrame& f,
                                       const CircleMoments<kOrder>& of_slice, V* sum) {
    sum[0] = hn::MulAdd(f.weight, of_slice.cosine[0], sum[0]);
    if constexpr (kOrder > 0) {
      const V along_v = f.weight * of_slice.cosine[1], along_t = f.weight * of_slice.sine[1];
      const V3 of_band = mul_add(p.to_viewer, along_v, f.t * along_t);
      sum[1] = sum[1] + of_band.y, sum[2] = sum[2] + of_band.z, sum[3] = sum[3] + of_band.x;
    }
  }
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
