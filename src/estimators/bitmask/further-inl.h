// SPDX-License-Identifier: Apache-2.0
//
// Rays towards what only further views show, for a vector of pixels; see bitmask.cpp. A march sees
// the frame alone: where sectors of a side stay open, one ray for every kSectorsPerRay of them asks
// the surfaces of further views, wherever these are.
#if defined(SSDO_BITMASK_FURTHER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_FURTHER_INL_H_
#undef SSDO_BITMASK_FURTHER_INL_H_
#else
#define SSDO_BITMASK_FURTHER_INL_H_
#endif

#include <bit>

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr int kSectorsPerRay = 4;

/// Rays begin above their surface, by so many times what storing P may have moved it, and by a part
/// of what a pixel shows.
constexpr float kAboveRoundings = 4, kAboveFootprints = 2e-3f;

/// The lanes of a vector, one by one.
struct Lanes {
  alignas(64) float values[kLanes];

  HWY_INLINE explicit Lanes(V v) { store(v, values); }
  HWY_INLINE float operator[](int lane) const { return values[lane]; }
};
struct Lanes3 {
  Lanes x, y, z;

  HWY_INLINE explicit Lanes3(const V3& v) : x(v.x), y(v.y), z(v.z) {}
  HWY_INLINE glm::vec3 operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// Where the rays of receivers begin.
HWY_INLINE V3 start_of_rays(const MarchScene& scene, const MarchReceiver& p) {
  const V rounding = load(scene.rounding, p.place.index),
          width = set(kAboveFootprints / (scene.fx < scene.fy ? scene.fx : scene.fy));
  const V footprint = scene.orthographic ? width : width * (set(0) - p.position.z);
  return mul_add(p.normal, hn::MulAdd(rounding, set(kAboveRoundings), footprint), p.position);
}

/// Of the open sectors those that further views hide. `on_met` hears of the sectors that one ray
/// stands for in each lane, and of what the rays have met.
template <class Met>
HWY_INLINE VU sectors_of_further(const March& march, const MarchReceiver& p, const SideFrame& side,
                                 VU open, const Met& on_met) {
  const DU du;
  const Lanes3 start(start_of_rays(march.scene, p)), v(p.to_viewer), t(side.t);
  const float first = hn::GetLane(side.start) - 0.5f;  // the same for all lanes
  alignas(64) std::uint32_t bits[kLanes], hidden[kLanes];
  VU all = set_bits(0);
  for (int from = 0; from < SliceSectors::kCount; from += kSectorsPerRay) {
    const VU group = hn::And(hn::IfThenElseZero(hn::RebindMask(du, p.valid), open),
                             set_bits(((1u << kSectorsPerRay) - 1) << from));
    if (none(group)) continue;
    hn::Store(group, du, bits);
    FurtherRays::Hit hits[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      hidden[lane] = 0;
      if (bits[lane] == 0) continue;
      // The one in the middle of those that are open stands for them.
      std::uint32_t rest = bits[lane];
      for (int k = (std::popcount(rest) - 1) / 2; k > 0; --k) rest &= rest - 1;
      const float cosine = std::clamp(
          (first - float(std::countr_zero(rest))) / SliceSectors::kPerCosine, -1.0f, 1.0f);
      const glm::vec3 to = cosine * v[lane] + std::sqrt(1 - cosine * cosine) * t[lane];
      if constexpr (Met::kWantsHits) {
        hits[lane] = march.further->first_hit(start[lane], to, march.radius);
        if (hits[lane].sender >= 0) hidden[lane] = bits[lane];
      } else if (march.further->is_blocked(start[lane], to, march.radius)) {
        hidden[lane] = bits[lane];
      }
    }
    const VU of_group = hn::Load(du, hidden);
    if (none(of_group)) continue;
    if constexpr (Met::kWantsHits) on_met(of_group, hits);
    all = hn::Or(all, of_group);
  }
  return all;
}

/// For who only asks what is hidden.
struct IgnoreHits {
  static constexpr bool kWantsHits = false;
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
