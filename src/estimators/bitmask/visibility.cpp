// SPDX-License-Identifier: Apache-2.0
//
// Visibility and direct light by method bitmask (see bitmask.cpp), for vectors of pixels:
//
//   M(S)   = int_S (n_v cos t + n_t sin t) d cos t     over sectors S of one side of a slice
//   ao     = 1 - sum w M(hidden) / sum w M(all)        over both sides of all slices
//   direct = E(N)/pi (1 - sum w int_lost L dM / sum w int_all L dM)     channel by channel
//
// all:    sectors above the plane across the shading normal
// hidden: those of them that solids hide, found by a march over each side
//         (open_ao counts only those that the frame hides, not surfaces that go on beyond it)
// lost:   `hidden`, less the share `through_beyond` of what only surfaces beyond the border hide
// w:      SliceFrame::weight
// L:      light in spherical harmonics, so that moments of the sectors suffice (moments-inl.h);
//         E(N)/pi is multiplied later: here is the visible part of the light, in brackets
//
// Compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/visibility.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/moments-inl.h"
#include "estimators/bitmask/side-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The sectors of one side of a slice that are hidden, and those of them that something beyond the
/// border hides.
struct HiddenSectors {
  VU all, beyond;
};

/// Not inlined, so that the march is not compiled anew for each order of the light.
template <bool kOrthographic>
HWY_NOINLINE HiddenSectors hidden_sectors(const March& march, const MarchReceiver& p,
                                          const SideFrame& side, const Slice& slice, bool forward) {
  VU beyond = set_bits(0);
  const VU open = march_side<kOrthographic>(
      march, p, side, slice, forward, [](auto&&...) HWY_ATTR {}, IgnoreHits(),
      [&](bool, const Border&, VU bits) HWY_ATTR { beyond = hn::Or(beyond, bits); });
  return {hn::AndNot(open, side.above), beyond};
}

template <int kOrder>
void visibility(const VisibilityJob& job, const Window& part) {
  const March& march = job.march;
  for_each_receiver(
      march, part, [&](const MarchReceiver& p, const std::vector<Slice>& slices) HWY_ATTR {
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Moments<kOrder> sum, first_half;  // over slices, by w
        V hidden_in_frame = set(0);       // of sum.hidden, what the frame itself hides
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = sum;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(march.scene, p, slice);
          CircleMoments<kOrder> hidden, beyond, all;
          CircleMoments<0> in_frame;
          for (const bool forward : {true, false}) {
            const SideFrame side =
                side_frame(march.scene, p, f, forward, slice.sides[forward ? 0 : 1].phase);
            const auto [bits, hidden_beyond] =
                march.scene.orthographic ? hidden_sectors<true>(march, p, side, slice, forward)
                                         : hidden_sectors<false>(march, p, side, slice, forward);
            all.add(moments_of_first<kOrder + 1>(side.above_count), p.shading_v, side.shading_t,
                    forward);
            if (none(bits)) continue;
            hidden.add(moments_of_bits<kOrder + 1>(bits), p.shading_v, side.shading_t, forward);
            if (job.open_ao)
              in_frame.add(moments_of_bits<1>(hn::AndNot(hidden_beyond, bits)), p.shading_v,
                           side.shading_t, forward);
            if (job.through_beyond == 0 || none(hidden_beyond)) continue;
            beyond.add(moments_of_bits<kOrder + 1>(hidden_beyond), p.shading_v, side.shading_t,
                       forward);
          }
          CircleMoments<kOrder> lost = hidden;
          if (job.through_beyond > 0) lost.subtract(beyond, set(job.through_beyond));
          sum.add(p, f, hidden, lost, all);
          hidden_in_frame = hn::MulAdd(f.weight, in_frame.cosine[0], hidden_in_frame);
        }
        const std::ptrdiff_t i = p.place.index;
        const V ao = sum.ao();
        store(hn::IfThenElse(p.valid, ao, set(1)), *job.ao, i);
        if (job.open_ao) store(sum.ao_of(hidden_in_frame), *job.open_ao, i);
        if (!job.bent && !job.sky_share && !job.difference) return;
        const V3 normals = usable(load_shading(march.scene, p.place).normal, p.valid);
        if constexpr (kOrder > 0) {
          if (job.bent) store(sum.bent_normal(p, ao, normals), *job.bent, i);
        }
        const auto visible = [&](const Moments<kOrder>& moments) HWY_ATTR {
          if (!job.light) return V3{ao, ao, ao};
          const auto of_channel = [&](int c) HWY_ATTR {
            return moments.visible_part(job.light + c * Moments<kOrder>::kCount, ao);
          };
          return V3{of_channel(0), of_channel(1), of_channel(2)};
        };
        if (job.sky_share) store(visible(sum) - V3{ao, ao, ao}, *job.sky_share, i);
        if (job.difference) {
          const V3 unoccluded = unoccluded_sky(*job.unoccluded, normals);
          const auto brightness = [&](const Moments<kOrder>& moments) HWY_ATTR {
            return luminance(unoccluded * saturate(visible(moments)));
          };
          const V difference = brightness(first_half) - brightness(sum.minus(first_half));
          const V scale = set(error_of_difference(march, p.place, firsts, count_of_slices));
          store(difference * scale, *job.difference, i);
        }
      });
}

void visibility_of_pixels(const VisibilityJob& job, const Window& part) {
  switch (job.order) {
    case 0:
      return visibility<0>(job, part);
    case 1:
      return visibility<1>(job, part);
    case 2:
      return visibility<2>(job, part);
    case 3:
      return visibility<3>(job, part);
    default:
      return visibility<4>(job, part);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(visibility_of_pixels);

void march_visibility(const VisibilityJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(visibility_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
