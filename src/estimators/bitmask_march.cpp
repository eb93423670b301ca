// SPDX-License-Identifier: Apache-2.0
//
// The two marches of method bitmask, compiled once for every instruction set; see bitmask.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask_march.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask_extension-inl.h"
#include "estimators/bitmask_moments-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The order in which slices are taken: every other one first, so that each half of them covers
/// all directions.
HWY_INLINE int slice_at(int k, int count) {
  const int firsts = (count + 1) / 2;
  return k < firsts ? 2 * k : 2 * (k - firsts) + 1;
}

/// The difference of two halves, with `first` of `count` slices in one of them, is the standard
/// error of the whole times this.
HWY_INLINE float error_of_difference(int first, int count) {
  return std::sqrt(float(first) * float(count - first)) / float(count);
}

template <bool kOrthographic, int kOrder>
void visibility(const VisibilityJob& job, int x0, int x1, int y0, int y1) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(
      scene, x0, x1, y0, y1, [&](std::ptrdiff_t i, int y, int comb, int column) HWY_ATTR {
        const D d;
        const auto ignore = [](std::ptrdiff_t, VU) HWY_ATTR {};
        const Receiver p = load_receiver(scene, i);
        const V x = lane_columns(scene.layout, comb, column);
        const float reach = reach_px(scene, p, job.march.radius);
        const std::vector<Slice>& slices =
            job.march.pattern.member(comb, (y + job.march.first_row) & (Interleaving::kPeriod - 1));
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Moments<kOrder> sum, first_half;
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = sum;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(scene, p, slice);
          for (int side = 0; side < 2; ++side) {
            const Half half = half_of(p, f, side == 0);
            VU hidden = march_side<kOrthographic>(job.march, p, half, slice.sides[side], i, y,
                                                  column, reach, ignore, ignore);
            if (job.march.extend) {
              const float sign = side == 0 ? 1.0f : -1.0f;
              const Border border =
                  border_along(scene.layout, hn::Set(d, sign * slice.dx),
                               hn::Set(d, sign * slice.dy), x, hn::Set(d, float(y)));
              hidden = hn::Or(hidden, extend_side<kOrthographic>(job.march, p, half, border, reach,
                                                                 slice.sides[side].phase));
            }
            sum.add(p, half, hidden, f.weight, slice.sides[side].phase);
          }
        }
        const V one = hn::Set(d, 1.0f);
        const V ao = hn::IfThenElse(p.valid, hn::Min(sum.open / sum.whole, one), one);
        hn::StoreU(ao, d, job.ao->data() + i);
        if constexpr (kOrder > 0) {
          if (job.bent) {
            V bent[3];
            sum.bent_normal(p, ao, bent);
            for (int c = 0; c < 3; ++c)
              hn::StoreU(bent[c], d, (*job.bent)[std::size_t(c)].data() + i);
          }
          for (int c = 0; job.share && c < 3; ++c) {
            const float* light = job.light + c * Moments<kOrder>::kCount;
            const V share = sum.share_of_light(light, ao);
            hn::StoreU(share, d, (*job.share)[std::size_t(c)].data() + i);
            if (job.share_difference) {
              const V first = first_half.share_of_light(light, ao);
              const V second = sum.minus(first_half).share_of_light(light, ao);
              hn::StoreU(
                  (first - second) * hn::Set(d, error_of_difference(firsts, count_of_slices)), d,
                  (*job.share_difference)[std::size_t(c)].data() + i);
            }
          }
        }
      });
}

struct Light {
  V r, g, b;
  HWY_INLINE void add(V weight, V red, V green, V blue) {
    r = hn::MulAdd(weight, red, r);
    g = hn::MulAdd(weight, green, g);
    b = hn::MulAdd(weight, blue, b);
  }
  V operator[](int c) const { return c == 0 ? r : c == 1 ? g : b; }
};

/// Whether the surface at `q` shows its seen side to the receiver.
HWY_INLINE M faces(const MarchScene& scene, std::ptrdiff_t q, const Receiver& p) {
  const D d;
  const auto load = [&](const InterleavedPlane& plane)
                        HWY_ATTR { return hn::LoadU(d, plane.data() + q); };
  return dot3(load(scene.nx), load(scene.ny), load(scene.nz), p.px - load(scene.x),
              p.py - load(scene.y), p.pz - load(scene.z)) > hn::Zero(d);
}

template <bool kOrthographic>
void bounce(const BounceJob& job, int x0, int x1, int y0, int y1) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(
      scene, x0, x1, y0, y1, [&](std::ptrdiff_t i, int y, int comb, int column) HWY_ATTR {
        const D d;
        const DU du;
        const V zero = hn::Zero(d);
        const Receiver p = load_receiver(scene, i);
        const V x = lane_columns(scene.layout, comb, column);
        const float reach = reach_px(scene, p, job.march.radius);
        const std::vector<Slice>& slices =
            job.march.pattern.member(comb, (y + job.march.first_row) & (Interleaving::kPeriod - 1));
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Light sum{zero, zero, zero}, first_half = sum;
        V whole = zero, first_whole = zero;
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = sum, first_whole = whole;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(scene, p, slice);
          for (int side = 0; side < 2; ++side) {
            const Half half = half_of(p, f, side == 0);
            Light light{zero, zero, zero};
            const auto receive = [&](const InterleavedColor& from, std::ptrdiff_t q,
                                     VU bits) HWY_ATTR {
              if (hn::AllTrue(du, bits == hn::Zero(du))) return;
              light.add(count(bits), hn::LoadU(d, from[0].data() + q),
                        hn::LoadU(d, from[1].data() + q), hn::LoadU(d, from[2].data() + q));
            };
            const auto receive_seen = [&](std::ptrdiff_t q, VU bits) HWY_ATTR {
              if (!job.sent_back) return receive(*job.sent, q, bits);
              const M front = faces(scene, q, p);
              const VU front_bits = hn::IfThenElseZero(hn::RebindMask(du, front), bits);
              receive(*job.sent, q, front_bits);
              receive(*job.sent_back, q, hn::AndNot(front_bits, bits));
            };
            VU hidden = march_side<kOrthographic>(
                job.march, p, half, slice.sides[side], i, y, column, reach, receive_seen,
                [&](std::ptrdiff_t q, VU bits) HWY_ATTR { receive(*job.sent_behind, q, bits); });
            if (job.march.extend) {
              const float sign = side == 0 ? 1.0f : -1.0f;
              const Border border =
                  border_along(scene.layout, hn::Set(d, sign * slice.dx),
                               hn::Set(d, sign * slice.dy), x, hn::Set(d, float(y)));
              const VU bits =
                  hn::AndNot(hidden, extend_side<kOrthographic>(job.march, p, half, border, reach,
                                                                slice.sides[side].phase));
              if (!hn::AllTrue(du, bits == hn::Zero(du))) {
                const auto gather = [&](int c) HWY_ATTR {
                  return hn::GatherIndex(d, job.sent_border[c].data(), border.index);
                };
                light.add(count(bits), gather(0), gather(1), gather(2));
              }
            }
            const V weight = f.weight * half.measure;
            whole = hn::MulAdd(weight, hn::Set(d, kSectors), whole);
            sum.add(weight, light.r, light.g, light.b);
          }
        }
        for (int c = 0; c < 3; ++c) {
          const auto at = std::size_t(c);
          hn::StoreU(hn::IfThenElseZero(p.valid, sum[c] / whole), d, (*job.bounce)[at].data() + i);
          if (job.difference) {
            const V difference =
                first_half[c] / first_whole - (sum[c] - first_half[c]) / (whole - first_whole);
            hn::StoreU(difference * hn::Set(d, error_of_difference(firsts, count_of_slices)), d,
                       (*job.difference)[at].data() + i);
          }
        }
      });
}

template <bool kOrthographic>
void visibility_in_order(const VisibilityJob& job, int x0, int x1, int y0, int y1) {
  switch (job.order) {
    case 0:
      return visibility<kOrthographic, 0>(job, x0, x1, y0, y1);
    case 1:
      return visibility<kOrthographic, 1>(job, x0, x1, y0, y1);
    case 2:
      return visibility<kOrthographic, 2>(job, x0, x1, y0, y1);
    case 3:
      return visibility<kOrthographic, 3>(job, x0, x1, y0, y1);
    default:
      return visibility<kOrthographic, 4>(job, x0, x1, y0, y1);
  }
}

void visibility_of_pixels(const VisibilityJob& job, int x0, int x1, int y0, int y1) {
  job.march.scene.orthographic ? visibility_in_order<true>(job, x0, x1, y0, y1)
                               : visibility_in_order<false>(job, x0, x1, y0, y1);
}

void bounce_of_pixels(const BounceJob& job, int x0, int x1, int y0, int y1) {
  job.march.scene.orthographic ? bounce<true>(job, x0, x1, y0, y1)
                               : bounce<false>(job, x0, x1, y0, y1);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(visibility_of_pixels);
HWY_EXPORT(bounce_of_pixels);

void march_visibility(const VisibilityJob& job, int x0, int x1, int y0, int y1) {
  HWY_DYNAMIC_DISPATCH(visibility_of_pixels)(job, x0, x1, y0, y1);
}

void march_bounce(const BounceJob& job, int x0, int x1, int y0, int y1) {
  HWY_DYNAMIC_DISPATCH(bounce_of_pixels)(job, x0, x1, y0, y1);
}

}  // namespace ssdo
#endif
