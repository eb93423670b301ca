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

#include <glm/gtc/constants.hpp>

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

/// Whether the surface at `q`, `step` away from the receiver, faces it with the side that the
/// camera sees: in the receiver's pixel, the tangent plane of the surface lies behind the receiver.
template <bool kOrthographic>
HWY_INLINE M faces(const MarchPlanes& planes, std::ptrdiff_t q, const SliceStep& step,
                   const MarchReceiver& p) {
  const V p_depth = set(0) - p.position.z, nearer = nearer_over(planes, q, step);
  return load(planes.depth(), q) > p_depth - (kOrthographic ? nearer : p_depth * nearer);
}

/// The pixels at index `q` that a march meets, a step away from the receivers.
struct MetPixels {
  const MarchPlanes& planes;
  std::ptrdiff_t q;
  const SliceStep& step;
};

/// The vectors from the receivers to the fronts of the solids of layer `layer` in these pixels.
template <bool kOrthographic>
HWY_INLINE V3 way_to(const MarchScene& scene, const MarchReceiver& p, const MetPixels& met,
                     int layer = 0) {
  const float dx = met.step.dx, dy = met.step.dy;
  const V depth = load(met.planes.layers[std::size_t(layer)].depth, met.q);
  V3 there{p.slope_x + set(dx / scene.fx), p.slope_y - set(dy / scene.fy), set(-1)};
  if constexpr (kOrthographic)
    there.z = hn::Neg(depth);
  else
    there = there * depth;
  return there - p.position;
}

/// The part of the light sent by pixels that the march gathers: all but the part that rays gather
/// (rays/emitters.h). `seen`: the lanes where the side that the camera sees faces the receiver.
/// `of_all`: what the facing side sends of all lights.
template <bool kOrthographic>
HWY_INLINE V3 without_emitted(const BounceJob& job, const MarchReceiver& p, const MetPixels& met,
                              M seen, const V3& sent, const V3& of_all) {
  const MarchScene& scene = job.march.scene;
  const V light = luminance(of_all), above = light - set(job.emitters->level);
  // An endless solid has no back that rays go to.
  const V thickness = load(met.planes.layers.front().thickness, met.q);
  const M ends = thickness < set(kOrthographic ? kInfiniteThickness : kInfiniteThicknessRatio),
          exceeds = hn::And(above > set(0), hn::Or(seen, ends));
  if (!any(exceeds)) return sent;
  const V3 way = way_to<kOrthographic>(scene, p, met);
  const V far = dot(way, way) * set(glm::pi<float>()) * above;
  const V by_rays = above * far / (far + set(job.emitters->power));
  return sent * hn::IfThenElse(exceeds, set(1) - by_rays / light, set(1));
}

/// The pixels of the overview that stand for pixels of the raster.
HWY_INLINE OverviewPixels in_overview(const BounceJob& job, const OverviewPixels& at) {
  const MarchScene& scene = job.march.scene;
  const OverviewRaster& far = job.overview->raster;
  const auto block = [](VI pixel, int first, int far_first, int size) HWY_ATTR {
    const VI of_frame = hn::ShiftRight<Interleaving::kShift>(pixel + set_int(first));
    return hn::Clamp(of_frame - set_int(far_first), set_int(0), set_int(size - 1));
  };
  return {block(at.x, scene.first_x, far.first_x, far.width),
          block(at.y, scene.first_y, far.first_y, far.height)};
}

HWY_INLINE V3 gather(const InterleavedVectors& color, VI at) {
  return {gather(color[0].data(), at), gather(color[1].data(), at), gather(color[2].data(), at)};
}

/// The radiance that solids send, and the lanes in which the frame shows the sending side.
struct Sent {
  V3 radiance;
  M shown;
};

/// Whether a ray along `way` meets the side that the camera sees of the tangent planes in the
/// pixels `at`, whose tilts are at `index`.
HWY_INLINE M sees_front(const MarchScene& scene, const InterleavedPlane& tilts, VI index,
                        const OverviewPixels& at, const V3& way) {
  const V tilt = gather(tilts.data(), index);
  const V axis_x = set(scene.axis_x - float(scene.first_x)),
          axis_y = set(scene.axis_y - float(scene.first_y));
  const V2 slope{(hn::ConvertTo(D(), at.x) - axis_x) * set(1 / scene.fx),
                 (axis_y - hn::ConvertTo(D(), at.y)) * set(1 / scene.fy)};
  const V3 normal =
      normal_of_tilt(scene, {unpack_bf16_first(tilt), unpack_bf16_second(tilt)}, slope);
  return dot(normal, way) < set(0);
}

/// What the solids of layer `layer` in the pixels `met` send, in the lanes of `bits`: the radiance
/// of the pixels that show these solids, or 0.
template <bool kOrthographic>
HWY_INLINE Sent sent_behind(const BounceJob& job, bool far, int layer, const MarchReceiver& p,
                            const MetPixels& met, VU bits) {
  const DI di;
  const VI zero = set_int(0);
  const March& march = job.march;
  const MarchScene& scene = far ? march.far->scene : march.scene;
  const Interleaving& layout = march.scene.layout;
  const Plane<int>& senders =
      (far ? job.overview->solids : job.solids).behind[std::size_t(layer - 1)].sender;
  const Sampled at = far ? in_overview(march, p.place) : in_raster(march, p.place);
  const VI column =
      far ? hn::Iota(di, at.column + met.step.column_shift)
          : hn::ConvertTo(di, lane_columns(layout, p.place.column_phase, p.place.column)) +
                set_int(int(met.step.dx));
  const auto is_met = hn::BitCast(di, bits) != zero;
  const VI sender =
      hn::GatherIndex(di, &senders(0, at.row + met.step.row), hn::IfThenElseZero(is_met, column));
  const auto shown = hn::AndNot(sender < zero, is_met);
  const OverviewPixels from = pixels_of(hn::IfThenElseZero(shown, sender), senders.width);
  const VI index = far ? index_of(job.overview->raster, from) : index_of(layout, from);
  V3 sent = gather(far ? job.far->sent : *job.light, index);
  if (!far && job.overview) {
    const auto lit = hn::And(from.y > set_int(job.lit.y0 - 1), from.y < set_int(job.lit.y1));
    const VI beyond = index_of(job.overview->raster, in_overview(job, from));
    sent = if_then_else(hn::RebindMask(D(), lit), sent, gather(job.far->sent, beyond));
  }
  const M known = hn::RebindMask(D(), shown);
  if (job.two_sided) {
    const V3 way = way_to<kOrthographic>(scene, p, met, layer);
    const M front = sees_front(scene, met.planes.tilt, index, from, way);
    sent = if_then_else(front, front_of(sent), back_of(sent));
  }
  return {if_then_else_zero(known, sent), known};
}

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

/// What the solids of layer 0 in the pixels `met` send.
template <bool kOrthographic>
HWY_INLINE Sent sent_by_front(const BounceJob& job, bool far, const MarchReceiver& p,
                              const MetPixels& met) {
  const InterleavedVectors& sending = far ? job.far->sent : *job.light;
  for (const InterleavedPlane& channel : sending) prefetch_next(channel, met.q);
  const V3 sent = load(sending, met.q);
  if (!job.two_sided && !job.emitters && !job.march.other_views) return {sent, p.valid};
  const M seen = faces<kOrthographic>(met.planes, met.q, met.step, p);
  const auto from_side = [&](const V3& both) HWY_ATTR {
    return job.two_sided ? if_then_else(seen, front_of(both), back_of(both)) : both;
  };
  if (!job.emitters) return {from_side(sent), seen};
  const V3 of_all = load(far ? job.far_of_all->sent : *job.of_all, met.q);
  return {without_emitted<kOrthographic>(job, p, met, seen, from_side(sent), from_side(of_all)),
          seen};
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
                    const BorderValues* sent = far ? job.far->border.data() : job.sent_border;
                    return V3{border(sent[0]), border(sent[1]), border(sent[2])};
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
