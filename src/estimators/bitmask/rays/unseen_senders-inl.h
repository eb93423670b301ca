// SPDX-License-Identifier: Apache-2.0
//
// What a march meets and the frame does not show, for a vector of pixels; compiled once for every
// instruction set.
#if defined(SSDO_BITMASK_UNSEEN_SENDERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_UNSEEN_SENDERS_INL_H_
#undef SSDO_BITMASK_UNSEEN_SENDERS_INL_H_
#else
#define SSDO_BITMASK_UNSEEN_SENDERS_INL_H_
#endif

#include <cstdint>
#include <limits>

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What one side of a slice meets of solids whose light the frame does not show: their unseen
/// sides, and solids behind what is seen. What such a solid hides from the camera begins somewhere
/// behind its front, and other views may know a surface that is nearer to the receiver, or the one
/// that sends: rays ask them (other_views-inl.h) before the solid counts.
struct UnseenSenders {
  static constexpr int kMost = 32;

  VU bits[kMost];
  V3 sent[kMost];
  int count = 0;

  bool is_full() const { return count == kMost; }

  /// Adds solids of pixels that are `way` from the receivers. A ray at the angle t to V meets the
  /// view ray of the point (s, v) of a slice after
  ///
  ///   s / ((s / L) cos t + (1 - v / L) sin t),   L the distance to the viewer
  ///
  /// `behind`: the solids lie somewhere behind what these pixels show.
  template <bool kOrthographic>
  HWY_INLINE void add(const MarchReceiver& p, const SideFrame& side, const V3& way, bool behind,
                      VU in, const V3& radiance) {
    const V s = dot(way, side.t), near = kOrthographic ? set(0) : set(1) / p.distance,
            known = set(behind ? 0.0f : 1.0f);
    hn::StoreU(s, D(), end_[count].s);
    hn::StoreU(s * near * known, D(), end_[count].per_cosine);
    hn::StoreU(hn::NegMulAdd(dot(way, p.to_viewer), near, set(1)) * known, D(),
               end_[count].per_sine);
    bits[count] = in, sent[count] = radiance;
    ++count;
  }

  HWY_INLINE VU all() const {
    VU sum = set_bits(0);
    for (int k = 0; k < count; ++k) sum = hn::Or(sum, bits[k]);
    return sum;
  }

  /// How far away a ray in a sector of a lane meets a solid; infinite where it is not known.
  HWY_INLINE float reach(int lane, int sector, float cosine, float sine) const {
    alignas(64) std::uint32_t of_lanes[kLanes];
    for (int k = 0; k < count; ++k) {
      hn::Store(bits[k], DU(), of_lanes);
      if ((of_lanes[lane] >> sector & 1) == 0) continue;
      const End& end = end_[k];
      const float per = end.per_cosine[lane] * cosine + end.per_sine[lane] * sine;
      if (per > 0) return end.s[lane] / per;
    }
    return std::numeric_limits<float>::infinity();
  }

 private:
  struct End {
    float s[kLanes], per_cosine[kLanes], per_sine[kLanes];
  };
  End end_[kMost];
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
