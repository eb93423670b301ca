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

#include <algorithm>
#include <bit>
#include <cmath>

#include "estimators/bitmask/lanes-inl.h"
#include "estimators/ray_start.h"
#include "math/sequence_numbers.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Fewer rays cost less and see less: ao at the small and the large radius and in a white world,
/// mean RMSE of three scenes with four views, .056 .054 .050 with 8 sectors, .056 .052 .049 with 4
/// at twice the rays, .057 .059 .057 with 16.
constexpr int kSectorsPerRay = 8;

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

/// The member of the pattern that a vector of pixels is.
HWY_INLINE int member_at(const MarchScene& scene, const Place& place) {
  constexpr int kPeriod = Interleaving::kPeriod;
  return ((place.y + scene.first_y) & (kPeriod - 1)) * kPeriod + place.column_phase;
}

/// A number in [0, 1) that differs between the members of the pattern and their sides, so that rays
/// of neighbours go to different sectors and a filter averages them.
HWY_INLINE float turn_of(const MarchScene& scene, const Place& place, float phase) {
  constexpr int kPeriod = Interleaving::kPeriod;
  const double turn =
      SlicePattern::rank(member_at(scene, place)) * kR2First + kPeriod * double(phase);
  return std::min(float(fraction(turn)), 0x1.fffffep-1f);
}

/// A sector of one lane, as a direction and the cosine to the normal that its light has.
struct SectorDirections {
  float first;  ///< 16 less the phase of the side
  Lanes3 v, t;
  Lanes facing, n_t;

  HWY_INLINE float cosine(int sector) const {
    return std::clamp((first - float(sector)) / SliceSectors::kPerCosine, -1.0f, 1.0f);
  }
  HWY_INLINE glm::vec3 direction(int lane, int sector) const {
    const float c = cosine(sector);
    return c * v[lane] + std::sqrt(1 - c * c) * t[lane];
  }
  HWY_INLINE float weight(int lane, int sector) const {
    const float c = cosine(sector);
    return std::max(facing[lane] * c + n_t[lane] * std::sqrt(1 - c * c), 1e-6f);
  }

  /// The sector that stands for a set of them: each as often as its weight says.
  HWY_INLINE int choose(int lane, std::uint32_t bits, float turn) const {
    float all = 0;
    for (std::uint32_t rest = bits; rest != 0; rest &= rest - 1)
      all += weight(lane, std::countr_zero(rest));
    float left = turn * all;
    for (;; bits &= bits - 1) {
      const int sector = std::countr_zero(bits);
      left -= weight(lane, sector);
      if (left < 0 || (bits & (bits - 1)) == 0) return sector;
    }
  }
};

/// Of the open sectors those that further views hide. `on_met` hears of the sectors that one ray
/// stands for in each lane, and of what the rays have met.
template <class Met>
HWY_INLINE VU sectors_of_further(const March& march, const MarchReceiver& p, const SideFrame& side,
                                 VU open, const Met& on_met) {
  const DU du;
  const Lanes3 start(start_of_rays(march.scene, p));
  const float first = hn::GetLane(side.start) - 0.5f;  // the same for all lanes
  const SectorDirections sectors{first, Lanes3(p.to_viewer), Lanes3(side.t), Lanes(p.facing),
                                 Lanes(side.n_t)};
  const float turn = turn_of(march.scene, p.place, first);
  const VU asked = hn::IfThenElseZero(hn::RebindMask(du, p.valid), open);
  alignas(64) std::uint32_t bits[kLanes], hidden[kLanes];
  VU all = set_bits(0);
  for (int from = 0; from < SliceSectors::kCount; from += kSectorsPerRay) {
    const VU group = hn::And(asked, set_bits(((1u << kSectorsPerRay) - 1) << from));
    if (none(group)) continue;
    hn::Store(group, du, bits);
    FurtherRays::Hit hits[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      hidden[lane] = 0;
      if (bits[lane] == 0) continue;
      const glm::vec3 to = sectors.direction(lane, sectors.choose(lane, bits[lane], turn));
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
