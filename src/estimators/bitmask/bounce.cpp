// SPDX-License-Identifier: Apache-2.0
//
// Light that bounces, by method bitmask (see bitmask.cpp and, for M and w, visibility.cpp):
//
//   bounce = (1 - ao) sum w M(met by q) L_out(q) / sum w M(hidden)
//
// over both sides of all slices, and over the solids q that the march of a side meets, each with
// the sectors that no nearer solid hides. Compiled once for every instruction set.
//
// The radiance around a pixel changes slowly along a surface; how much of it reaches the pixel is
// known from ao. So where slices are few, one pixel of 2 x 2 marches, and the others take the mean
// of their neighbours on the same surface.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/bounce.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/border/lamp_beyond-inl.h"
#include "estimators/bitmask/met_senders-inl.h"
#include "estimators/bitmask/moments-inl.h"
#include "estimators/bitmask/rays/unseen_senders-inl.h"
#include "estimators/bitmask/side-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A weighted sum of radiance, and the weights.
struct Gathered {
  V3 sum;
  V weights;

  HWY_INLINE void add(V weight, const V3& radiance) {
    sum = mul_add(radiance, weight, sum);
    weights = weights + weight;
  }
  HWY_INLINE V3 mean() const { return sum / weights; }
  HWY_INLINE Gathered minus(const Gathered& other) const {
    return {sum - other.sum, weights - other.weights};
  }
};

HWY_INLINE Gathered no_light() { return {set(glm::vec3(0)), set(0)}; }

/// M of a set of sectors: the integral of the cosine to the shading normal.
HWY_INLINE V measure_of(const MarchReceiver& p, const SideFrame& side, VU bits) {
  const VU one = set_bits(1), last = set_bits(31);
  const VU first = hn::PopulationCount(hn::AndNot(bits, bits - one));
  const VU begin = hn::And(first, last), end = hn::And(first + hn::PopulationCount(bits), last);
  const VU others = hn::Xor(bits, hn::AndNot(bits_from(end), bits_from(begin)));
  const auto moment = [&](int m) HWY_ATTR {
    const float* table = slice_sectors().of_first[std::size_t(m)].data();
    return lookup32(table, end) - lookup32(table, begin);
  };
  const V of_run =
      dot(V2{p.shading_v, side.shading_t}, V2{moment(1), moment(SliceSectors::sine_moment(1))});
  if (none(others)) return of_run;  // as nearly always
  // The two formulas round differently: the choice for a lane must not depend on other lanes.
  const auto moments = moments_of_bits<1>(bits);
  const V of_bits = dot(V2{p.shading_v, side.shading_t}, V2{moments.cosine[1], moments.sine[1]});
  return hn::IfThenElse(hn::RebindMask(D(), others == set_bits(0)), of_run, of_bits);
}

/// Light from what only other views show.
template <class Receive>
struct FromOtherViews {
  static constexpr bool kWantsHits = true;
  const OtherViewLight* sent;
  const Receive& receive;

  HWY_INLINE void operator()(VU bits, const OtherViewRays::Hit* hits) const {
    receive(bits, [&]() HWY_ATTR {
      alignas(64) float radiance[3][kLanes] = {};
      for (int lane = 0; lane < kLanes; ++lane) {
        if (hits[lane].sender < 0) continue;
        const auto vertex = std::size_t(hits[lane].sender);
        const glm::vec3& light = hits[lane].unseen ? sent->unseen[vertex] : sent->seen[vertex];
        for (int c = 0; c < 3; ++c) radiance[c][lane] = light[c];
      }
      return V3{load(radiance[0]), load(radiance[1]), load(radiance[2])};
    });
  }
};

HWY_INLINE std::ptrdiff_t index_of_gatherer(const GatheredLight& light, const Place& place) {
  return light.layout.index(place.y, place.column_phase, place.column);
}

template <bool kOrthographic>
void gather_light(const BounceJob& job, const Window& part) {
  const March& march = job.march;
  for_each_receiver(
      march, part, [&](const MarchReceiver& p, const std::vector<Slice>& slices) HWY_ATTR {
        const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
        Gathered light = no_light(), first_half = light;
        for (int k = 0; k < count_of_slices; ++k) {
          if (k == firsts) first_half = light;
          const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
          const SliceFrame f = slice_frame(march.scene, p, slice);
          for (const bool forward : {true, false}) {
            const SideFrame side =
                side_frame(march.scene, p, f, forward, slice.sides[forward ? 0 : 1].phase);
            const auto receive = [&](VU bits, const auto& sent) HWY_ATTR {
              if (none(bits)) return;
              // In other lanes, sent() may have read places where nothing was stored.
              const M met = hn::RebindMask(D(), bits != set_bits(0));
              light.add(f.weight * measure_of(p, side, bits), if_then_else_zero(met, sent()));
            };
            const FromOtherViews<decltype(receive)> from_others{job.sent_by_others, receive};
            UnseenSenders unseen;
            march_side<kOrthographic>(
                march, p, side, slice, forward,
                [&](bool far, int layer, std::ptrdiff_t q, const SliceStep& step, VU bits)
                    HWY_ATTR {
                      if (none(bits)) return;
                      const MetPixels met{far ? march.far->planes : march.scene, q, step};
                      const Sent sent =
                          layer > 0 ? sent_behind<kOrthographic>(job, far, layer, p, met, bits)
                                    : sent_by_front<kOrthographic>(job, far, p, met);
                      if (march.other_views && !unseen.is_full()) {
                        const VU shown = hn::VecFromMask(DU(), hn::RebindMask(DU(), sent.shown)),
                                 hidden = hn::AndNot(shown, bits);
                        bits = hn::And(shown, bits);
                        if (!none(hidden)) {
                          const V3 way =
                              way_to<kOrthographic>(far ? march.far->scene : march.scene, p, met);
                          unseen.add<kOrthographic>(p, side, way, layer > 0, hidden, sent.radiance);
                        }
                      }
                      receive(bits, [&]() HWY_ATTR { return sent.radiance; });
                    },
                from_others,
                [&](bool far, const Border& border, VU bits) HWY_ATTR {
                  receive(bits, [&]() HWY_ATTR {
                    const BorderValues* values = far ? job.far->border.data() : job.sent_border;
                    const V3 sent{border(values[0]), border(values[1]), border(values[2])};
                    const std::vector<LampBeyond>& lamps = far ? job.far->lamps : job.lamps;
                    if (lamps.empty()) return sent;
                    return sent + (far ? sent_beyond<kOrthographic>(march.far->scene, lamps,
                                                                    in_overview_pixels(march, p),
                                                                    side, border, bits)
                                       : sent_beyond<kOrthographic>(march.scene, lamps, p, side,
                                                                    border, bits));
                  });
                });
            if (unseen.count == 0) continue;
            const auto reach = [&](int lane, int sector, float cosine, float sine) HWY_ATTR {
              return std::min(march.radius, unseen.reach(lane, sector, cosine, sine));
            };
            const VU nearer =
                sectors_hidden_in_other_views(march, p, side, unseen.all(), from_others, reach);
            for (int i = 0; i < unseen.count; ++i) {
              receive(hn::AndNot(nearer, unseen.bits[i]),
                      [&]() HWY_ATTR { return unseen.sent[i]; });
            }
          }
        }
        GatheredLight& out = *job.gathered;
        const std::ptrdiff_t at = index_of_gatherer(out, p.place);
        store(light.sum, out.sum, at), store(light.weights, out.weights, at);
        if (!job.error) return;
        // Where one half met nothing, there is no difference to tell the error from.
        const Gathered second_half = light.minus(first_half);
        const V zero = set(0);
        const V difference = luminance(first_half.mean()) - luminance(second_half.mean());
        const M both = hn::And(first_half.weights > zero, second_half.weights > zero);
        const V scale =
            light.weights * set(error_of_difference(march, p.place, firsts, count_of_slices));
        store(hn::IfThenElseZero(both, difference) * scale, out.error, at);
      });
}

/// The offset of a place from the top left pixel of its square of spacing x spacing, which marches.
struct Offset {
  int x, y;
};

HWY_INLINE Offset offset_of(const March& march, const Place& place) {
  const int last = march.pattern.spacing() - 1;
  return {place.column_phase & last, (place.y + march.scene.first_y) & last};
}

/// Calls `visit(place, dx, dy)` for the marching pixels around a place, or only for the place
/// itself if it marches.
template <class Visit>
HWY_INLINE void for_each_gatherer(const March& march, const Place& place, const Visit& visit) {
  const Interleaving& layout = march.scene.layout;
  const int spacing = march.pattern.spacing();
  const Offset off = offset_of(march, place);
  for (int dy = -off.y; dy <= off.y; dy += spacing) {
    if (place.y + dy < 0 || place.y + dy >= layout.height()) continue;
    for (int dx = -off.x; dx <= off.x; dx += spacing) {
      visit(place_beside(layout, place, dx, dy), dx, dy);
    }
  }
}

/// Gives pixels their bounce from those that have gathered light.
template <bool kOrthographic>
void spread(const BounceJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  const GatheredLight& from = *job.gathered;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const std::ptrdiff_t i = place.index;
    const V zero = set(0);
    const MarchReceiver p = load_receiver(scene, place);
    Gathered of_surface = no_light(), of_all = no_light();
    V difference = zero;
    for_each_gatherer(job.march, place, [&](const Place& q, int dx, int dy) HWY_ATTR {
      const std::ptrdiff_t at = index_of_gatherer(from, q);
      const V weights = load(from.weights, at);
      const M found = hn::And(holds_solid(load(scene.receiver_depth(), q.index)), weights > zero);
      if (!any(found)) return;
      const Gathered light{if_then_else_zero(found, load(from.sum, at)),
                           hn::IfThenElseZero(found, weights)};
      const V like =
          dx == 0 && dy == 0 ? set(1) : likeness<kOrthographic>(scene, p, q.index, dx, dy);
      of_surface = {mul_add(light.sum, like, of_surface.sum),
                    hn::MulAdd(light.weights, like, of_surface.weights)};
      of_all = {of_all.sum + light.sum, of_all.weights + light.weights};
      if (job.error) {
        const V known = hn::IfThenElseZero(found, load(from.error, at));
        difference = hn::MulAdd(known, like, difference);
      }
    });
    // ao may see an occluder that no march for the bounce met; it is assumed to be close and to
    // send what the receiver sends.
    const M on_surface = of_surface.weights > zero, anywhere = of_all.weights > zero;
    const V3 sent = load(*job.light, i), own = job.two_sided ? front_of(sent) : sent;
    const V3 beside = if_then_else(anywhere, of_all.mean(), own);
    const V3 radiance = if_then_else(on_surface, of_surface.mean(), beside);
    const V hidden = hn::IfThenElseZero(p.valid, set(1) - load(*job.ao, i));
    store(radiance * hidden, *job.light, i);
    if (job.error) {
      const V error = hn::IfThenElseZero(on_surface, hidden * difference / of_surface.weights);
      store(error, *job.error, i);
    }
  });
}

void gather_in_pixels(const BounceJob& job, const Window& part) {
  job.march.scene.orthographic ? gather_light<true>(job, part) : gather_light<false>(job, part);
}

void spread_to_pixels(const BounceJob& job, const Window& part) {
  job.march.scene.orthographic ? spread<true>(job, part) : spread<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(gather_in_pixels);
HWY_EXPORT(spread_to_pixels);

void march_bounce(const BounceJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(gather_in_pixels)(job, part);
}

void spread_bounce(const BounceJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(spread_to_pixels)(job, part);
}

}  // namespace ssdo
#endif
