// SPDX-License-Identifier: Apache-2.0
//
// Rays towards what only other views show, for a vector of pixels; see bitmask.cpp. A march sees
// the frame alone: where sectors of a side stay open, a few rays ask the surfaces of other views,
// wherever these are.
#if defined(SSDO_BITMASK_OTHER_VIEWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_OTHER_VIEWS_INL_H_
#undef SSDO_BITMASK_OTHER_VIEWS_INL_H_
#else
#define SSDO_BITMASK_OTHER_VIEWS_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include "estimators/bitmask/lanes-inl.h"
#include "estimators/ray_start.h"
#include "math/sequence_numbers.h"
#include "simd/by_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The number of rays for a slice that is open on both sides; a slice that is less open gets fewer.
/// RMSE of ao in a white world and relative RMSE of direct light, of foliage with overscan and four
/// views: .0692 .158 with 3.3 rays, .0719 .163 with 2.4, at 8 % less time. A bounce hardly changes
/// with their number.
constexpr float kRaysPerSlice = 2.4f, kBounceRaysPerSlice = 1.6f;

/// Where the rays of receivers begin.
HWY_INLINE V3 start_of_rays(const MarchScene& scene, const MarchReceiver& p) {
  const V rounding = load_shading(scene, p.place).rounding,
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

/// The sample points of the sectors of a side: their directions and, as weights, their cosines to
/// the shading normal.
struct SectorDirections {
  float cosine[SliceSectors::kCount], sine[SliceSectors::kCount];
  Lanes3 v, t;
  Lanes facing, n_t;

  HWY_INLINE SectorDirections(const MarchReceiver& p, const SideFrame& side, float first)
      : v(p.to_viewer), t(side.t), facing(p.shading_v), n_t(side.shading_t) {
    for (int k = 0; k < SliceSectors::kCount; ++k) {
      const float c = std::clamp((first - float(k)) / SliceSectors::kPerCosine, -1.0f, 1.0f);
      cosine[k] = c, sine[k] = std::sqrt(1 - c * c);
    }
  }

  HWY_INLINE glm::vec3 direction(int lane, int sector) const {
    return cosine[sector] * v[lane] + sine[sector] * t[lane];
  }
  HWY_INLINE float weight(int lane, int sector) const {
    return std::max(facing[lane] * cosine[sector] + n_t[lane] * sine[sector], 1e-6f);
  }

  /// The sum of weight() over all sectors of both sides of a slice, if nothing is hidden.
  HWY_INLINE float whole(int lane) const {
    const float f = facing[lane], n = std::abs(n_t[lane]);
    // cos a + a sin a, a the angle of the normal in the slice, to within 3 %.
    const float length = std::max(std::sqrt(f * f + n * n), 1e-6f);
    return SliceSectors::kPerCosine * (length + 0.5708f * n * n / length);
  }
};

/// The open sectors of a lane in strata of about the same weight, for one ray each, and a sector of
/// each, taken as often as its weight says.
struct SectorStrata {
  static constexpr int kMost = 4;
  std::uint32_t bits[kMost];
  int sector[kMost];
  int count = 0;

  HWY_INLINE void divide(const SectorDirections& of, int lane, std::uint32_t open, float rays,
                         float turn, float round_up) {
    if (open == 0) return;
    float weights[SliceSectors::kCount];
    float all = 0;
    for (std::uint32_t rest = open; rest != 0; rest &= rest - 1) {
      const int k = std::countr_zero(rest);
      all += weights[k] = of.weight(lane, k);
    }
    // Rounded up as often as the fraction says.
    count = std::clamp(int(rays * all / of.whole(lane) + round_up), 1, kMost);
    const float each = all / float(count);
    float before = 0;
    std::uint32_t rest = open;
    for (int i = 0; i < count; ++i) {
      bits[i] = 0, sector[i] = -1;
      const float aim = (float(i) + turn) * each, end = float(i + 1) * each;
      while (rest != 0) {
        const int k = std::countr_zero(rest);
        // A sector belongs to the stratum that holds its middle.
        if (i + 1 < count && bits[i] != 0 && before + 0.5f * weights[k] > end) break;
        bits[i] |= 1u << k;
        before += weights[k];
        rest &= rest - 1;
        if (sector[i] < 0 && before > aim) sector[i] = k;
      }
      if (bits[i] == 0) {
        count = i;
        return;
      }
      if (sector[i] < 0) sector[i] = 31 - std::countl_zero(bits[i]);
    }
  }
};

/// Returns which of the open sectors other views hide, within `reach(lane, sector, cosine, sine)`,
/// the last two being of the angle to V. Calls `on_met` with the sectors that one ray stands for in
/// each lane, and with what the rays have met.
template <class Met, class Reach>
HWY_INLINE VU sectors_hidden_in_other_views(const March& march, const MarchReceiver& p,
                                            const SideFrame& side, VU open, const Met& on_met,
                                            const Reach& reach) {
  const DU du;
  const Lanes3 start(start_of_rays(march.scene, p));
  const float first = hn::GetLane(side.start) - 0.5f;  // the same for all lanes
  const SectorDirections sectors(p, side, first);
  const float turn = turn_of(march.scene, p.place, first), round_up = first - std::floor(first),
              rays = Met::kWantsHits ? kBounceRaysPerSlice : kRaysPerSlice;
  alignas(64) std::uint32_t asked[kLanes], hidden[kLanes];
  hn::Store(hn::IfThenElseZero(hn::RebindMask(du, p.valid), open), du, asked);
  SectorStrata strata[kLanes];
  int most = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    strata[lane].divide(sectors, lane, asked[lane], rays, turn, round_up);
    most = std::max(most, strata[lane].count);
  }
  VU all = set_bits(0);
  for (int k = 0; k < most; ++k) {
    OtherViewRays::Hit hits[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      hidden[lane] = 0;
      if (k >= strata[lane].count) continue;
      const int sector = strata[lane].sector[k];
      const glm::vec3 to = sectors.direction(lane, sector);
      const float end = reach(lane, sector, sectors.cosine[sector], sectors.sine[sector]);
      if constexpr (Met::kWantsHits) {
        hits[lane] = march.other_views->first_hit(start[lane], to, end);
        if (hits[lane].sender >= 0) hidden[lane] = strata[lane].bits[k];
      } else if (march.other_views->is_blocked(start[lane], to, end)) {
        hidden[lane] = strata[lane].bits[k];
      }
    }
    const VU of_stratum = hn::Load(du, hidden);
    if (none(of_stratum)) continue;
    if constexpr (Met::kWantsHits) on_met(of_stratum, hits);
    all = hn::Or(all, of_stratum);
  }
  return all;
}

/// The same within the radius.
template <class Met>
HWY_INLINE VU sectors_hidden_in_other_views(const March& march, const MarchReceiver& p,
                                            const SideFrame& side, VU open, const Met& on_met) {
  const auto radius = [&](int, int, float, float) HWY_ATTR { return march.radius; };
  return sectors_hidden_in_other_views(march, p, side, open, on_met, radius);
}

/// For callers that need only the hidden sectors.
struct IgnoreHits {
  static constexpr bool kWantsHits = false;
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
