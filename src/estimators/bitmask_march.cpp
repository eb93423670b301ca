// SPDX-License-Identifier: Apache-2.0
//
// The two marches of method bitmask, compiled once for every instruction set; see bitmask.cpp.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask_march.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask_extension-inl.h"
#include "estimators/bitmask_moments-inl.h"
#include "estimators/bitmask_side-inl.h"

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

/// A vector of receivers in the frame.
struct Place {
  std::ptrdiff_t index;
  int y, comb, column;
};

/// Marches one half of a slice, on the side `forward` or not, in the frame and beyond it, and gives
/// the sectors that stay open. `beyond` hears of those that are hidden beyond the frame.
template <bool kOrthographic, class Seen, class Covered, class Beyond>
HWY_INLINE VU march_half(const March& march, const Receiver& p, const Half& half,
                         const Slice& slice, bool forward, const Place& place, float reach,
                         const Seen& seen, const Covered& covered, const Beyond& beyond) {
  const D d;
  const SliceSide& side = slice.sides[forward ? 0 : 1];
  const VU open = march_side<kOrthographic>(march, p, half, side, place.index, place.y,
                                            place.column, reach, seen, covered);
  if (!march.extend || hn::AllTrue(DU(), open == hn::Zero(DU()))) return open;
  const float sign = forward ? 1.0f : -1.0f;
  const Border border =
      border_along(march.scene, p, place.comb, place.column, hn::Set(d, sign * slice.dx),
                   hn::Set(d, sign * slice.dy), true);
  const VU bits = extend_side<kOrthographic>(march, p, half, border, reach, side.phase);
  beyond(border, hn::And(open, bits));
  return hn::AndNot(bits, open);
}

/// Calls `work(place, receiver, slices, reach_px)` for each vector of pixels that shows a surface.
template <class Work>
HWY_INLINE void for_each_receiver(const March& march, int y0, int y1, const Work& work) {
  for_each_vector(march.scene, y0, y1, [&](std::ptrdiff_t i, int y, int comb, int column) HWY_ATTR {
    const Receiver p = load_receiver(march.scene, i, y, comb, column);
    const int row = (y + march.scene.first_y) & (Interleaving::kPeriod - 1);
    work(Place{i, y, comb, column}, p, march.pattern.member(comb, row),
         reach_px(march.scene, p, march.radius));
  });
}

template <bool kOrthographic, int kOrder>
void visibility(const VisibilityJob& job, int y0, int y1) {
  const March& march = job.march;
  for_each_receiver(
      march, y0, y1,
      [&](const Place& place, const Receiver& p, const std::vector<Slice>& slices,
          float reach) HWY_ATTR {
        const D d;
        const DU du;
        const auto ignore = [](auto&&...) HWY_ATTR {};
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Moments<kOrder> sum, first_half;
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = sum;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(march.scene, p, slice);
          CircleMoments<kOrder> hidden, whole;
          for (const bool forward : {true, false}) {
            const Half half =
                half_of(march.scene, p, f, forward, slice.sides[forward ? 0 : 1].phase);
            const VU open = march_half<kOrthographic>(march, p, half, slice, forward, place, reach,
                                                      ignore, ignore, ignore);
            const VU bits = hn::AndNot(open, half.above);
            whole.add(moments_of_first<kOrder + 1>(half.above_count), p.facing, half.n_t, forward);
            if (hn::AllTrue(du, bits == hn::Zero(du))) continue;
            hidden.add(moments_of_bits<kOrder + 1>(bits), p.facing, half.n_t, forward);
          }
          sum.add(p, f, hidden, whole);
        }
        const std::ptrdiff_t i = place.index;
        const V ao = sum.open_share();
        hn::StoreU(hn::IfThenElse(p.valid, ao, hn::Set(d, 1.0f)), d, job.ao->data() + i);
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

/// A weighted sum of radiance, and the weights.
struct Light {
  V r, g, b, weights;

  HWY_INLINE void add(V weight, V red, V green, V blue) {
    r = hn::MulAdd(weight, red, r);
    g = hn::MulAdd(weight, green, g);
    b = hn::MulAdd(weight, blue, b);
    weights = weights + weight;
  }
  HWY_INLINE V mean(int c, V otherwise) const {
    const V sum = c == 0 ? r : c == 1 ? g : b;
    return hn::IfThenElse(weights > hn::Zero(D()), sum / weights, otherwise);
  }
  HWY_INLINE Light minus(const Light& other) const {
    return {r - other.r, g - other.g, b - other.b, weights - other.weights};
  }
};

/// Whether the surface at `q`, `step` away from the receiver, shows its seen side to it.
template <bool kOrthographic>
HWY_INLINE M faces(const MarchScene& scene, std::ptrdiff_t q, const SliceStep& step,
                   const Receiver& p) {
  const D d;
  const auto load = [&](const InterleavedPlane& plane)
                        HWY_ATTR { return hn::LoadU(d, plane.data() + q); };
  const V depth = load(scene.depth);
  V qx = hn::MulAdd(hn::Set(d, step.dx), hn::Set(d, 1 / scene.fx), p.slope_x),
    qy = hn::MulAdd(hn::Set(d, step.dy), hn::Set(d, -1 / scene.fy), p.slope_y);
  if constexpr (!kOrthographic) qx = qx * depth, qy = qy * depth;
  return dot3(load(scene.nx), load(scene.ny), load(scene.nz), p.px - qx, p.py - qy, p.pz + depth) >
         hn::Zero(d);
}

/// Measure of a set of sectors: the integral of the cosine to the normal.
HWY_INLINE V measure_of(const Receiver& p, const Half& half, VU bits) {
  const DU du;
  const VU one = hn::Set(du, 1u), last = hn::Set(du, 31u);
  const VU first = hn::PopulationCount(hn::AndNot(bits, bits - one));
  const VU begin = hn::And(first, last), end = hn::And(first + hn::PopulationCount(bits), last);
  if (hn::AllTrue(du, bits == hn::AndNot(bits_from(end), bits_from(begin)))) {
    // One run of sectors, as nearly always.
    const auto moment = [&](int m) HWY_ATTR {
      const float* table = slice_sectors().of_first[std::size_t(m)].data();
      return lookup32(table, end) - lookup32(table, begin);
    };
    return dot2(p.facing, half.n_t, moment(1), moment(SliceSectors::sine_moment(1)));
  }
  const auto moments = moments_of_bits<1>(bits);
  return dot2(p.facing, half.n_t, moments.cosine[1], moments.sine[1]);
}

template <bool kOrthographic>
void bounce(const BounceJob& job, int y0, int y1) {
  const March& march = job.march;
  for_each_receiver(
      march, y0, y1,
      [&](const Place& place, const Receiver& p, const std::vector<Slice>& slices,
          float reach) HWY_ATTR {
        const D d;
        const DU du;
        const V zero = hn::Zero(d);
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Light sum{zero, zero, zero, zero}, first_half = sum;
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = sum;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(march.scene, p, slice);
          for (const bool forward : {true, false}) {
            const Half half =
                half_of(march.scene, p, f, forward, slice.sides[forward ? 0 : 1].phase);
            const auto receive = [&](VU bits, const auto& sent) HWY_ATTR {
              if (hn::AllTrue(du, bits == hn::Zero(du))) return;
              sum.add(f.weight * measure_of(p, half, bits), sent(0), sent(1), sent(2));
            };
            const auto load = [&](const InterleavedColor& sent, int c, std::ptrdiff_t q) HWY_ATTR {
              return hn::LoadU(d, sent[std::size_t(c)].data() + q);
            };
            march_half<kOrthographic>(
                march, p, half, slice, forward, place, reach,
                [&](std::ptrdiff_t q, const SliceStep& step, VU bits) HWY_ATTR {
                  if (hn::AllTrue(du, bits == hn::Zero(du))) return;
                  if (!job.sent_back)
                    return receive(bits, [&](int c) HWY_ATTR { return load(*job.sent, c, q); });
                  const M front = faces<kOrthographic>(march.scene, q, step, p);
                  receive(bits, [&](int c) HWY_ATTR {
                    return hn::IfThenElse(front, load(*job.sent, c, q), load(*job.sent_back, c, q));
                  });
                },
                [&](std::ptrdiff_t q, const SliceStep&, VU bits) HWY_ATTR {
                  receive(bits, [&](int c) HWY_ATTR { return load(*job.sent_behind, c, q); });
                },
                [&](const Border& border, VU bits) HWY_ATTR {
                  receive(bits, [&](int c) HWY_ATTR { return border(job.sent_border[c]); });
                });
          }
        }
        const V hidden = hn::IfThenElseZero(
            p.valid, hn::Set(d, 1.0f) - hn::LoadU(d, job.ao->data() + place.index));
        for (int c = 0; c < 3; ++c) {
          const auto at = std::size_t(c);
          // Where ao has found what these steps have missed, it is near, and lit alike.
          const V own = hn::LoadU(d, (*job.sent)[at].data() + place.index);
          hn::StoreU(hidden * sum.mean(c, own), d, (*job.bounce)[at].data() + place.index);
          if (job.difference) {
            const V difference =
                hidden * (first_half.mean(c, own) - sum.minus(first_half).mean(c, own));
            hn::StoreU(difference * hn::Set(d, error_of_difference(firsts, count_of_slices)), d,
                       (*job.difference)[at].data() + place.index);
          }
        }
      });
}

template <bool kOrthographic>
void visibility_in_order(const VisibilityJob& job, int y0, int y1) {
  switch (job.order) {
    case 0:
      return visibility<kOrthographic, 0>(job, y0, y1);
    case 1:
      return visibility<kOrthographic, 1>(job, y0, y1);
    case 2:
      return visibility<kOrthographic, 2>(job, y0, y1);
    case 3:
      return visibility<kOrthographic, 3>(job, y0, y1);
    default:
      return visibility<kOrthographic, 4>(job, y0, y1);
  }
}

void visibility_of_pixels(const VisibilityJob& job, int y0, int y1) {
  job.march.scene.orthographic ? visibility_in_order<true>(job, y0, y1)
                               : visibility_in_order<false>(job, y0, y1);
}

void bounce_of_pixels(const BounceJob& job, int y0, int y1) {
  job.march.scene.orthographic ? bounce<true>(job, y0, y1) : bounce<false>(job, y0, y1);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(visibility_of_pixels);
HWY_EXPORT(bounce_of_pixels);

void march_visibility(const VisibilityJob& job, int y0, int y1) {
  HWY_DYNAMIC_DISPATCH(visibility_of_pixels)(job, y0, y1);
}

void march_bounce(const BounceJob& job, int y0, int y1) {
  HWY_DYNAMIC_DISPATCH(bounce_of_pixels)(job, y0, y1);
}

}  // namespace ssdo
#endif
