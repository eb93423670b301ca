// SPDX-License-Identifier: Apache-2.0
//
// Light that bounces, by method bitmask; see bitmask.cpp. Compiled once for every instruction set.
//
// What surrounds a pixel changes slowly from one to the next on a surface; how much of it a pixel
// sees is known from ao. So where slices are few, one pixel of 2 x 2 marches, and the others take
// the mean of what their neighbours on the same surface receive.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/bounce.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/light-inl.h"
#include "estimators/bitmask/moments-inl.h"
#include "estimators/bitmask/side-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A weighted sum of radiance, and the weights.
struct Light {
  Color sum;
  V weights;

  HWY_INLINE void add(V weight, const Color& radiance) {
    sum = mul_add(radiance, weight, sum);
    weights = weights + weight;
  }
  HWY_INLINE Color mean() const { return {sum.r / weights, sum.g / weights, sum.b / weights}; }
  HWY_INLINE Light minus(const Light& other) const {
    return {{sum.r - other.sum.r, sum.g - other.sum.g, sum.b - other.sum.b},
            weights - other.weights};
  }
};

HWY_INLINE Light no_light() { return {set_color(glm::vec3(0)), hn::Zero(D())}; }

/// Whether the surface at `q`, `step` away from the receiver, shows its seen side to it.
template <bool kOrthographic>
HWY_INLINE M faces(const MarchScene& scene, std::ptrdiff_t q, const SliceStep& step,
                   const Receiver& p) {
  const D d;
  const auto load = [&](const InterleavedPlane& plane)
                        HWY_ATTR { return hn::LoadU(d, plane.data() + q); };
  const V depth = load(scene.depth());
  V qx = hn::MulAdd(hn::Set(d, step.dx), hn::Set(d, 1 / scene.fx), p.slope_x),
    qy = hn::MulAdd(hn::Set(d, step.dy), hn::Set(d, -1 / scene.fy), p.slope_y);
  if constexpr (!kOrthographic) qx = qx * depth, qy = qy * depth;
  return dot3(load(scene.nx), load(scene.ny), load(scene.nz), p.px - qx, p.py - qy, p.pz + depth) >
         hn::Zero(d);
}

/// Measure of a set of sectors: the integral of the cosine to the normal.
HWY_INLINE V measure_of(const Receiver& p, const SideFrame& side, VU bits) {
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
    return dot2(p.facing, side.n_t, moment(1), moment(SliceSectors::sine_moment(1)));
  }
  const auto moments = moments_of_bits<1>(bits);
  return dot2(p.facing, side.n_t, moments.cosine[1], moments.sine[1]);
}

template <bool kOrthographic>
void gather(const BounceJob& job, const Window& part) {
  const March& march = job.march;
  for_each_receiver(march, part, [&](const Receiver& p, const std::vector<Slice>& slices) HWY_ATTR {
    const D d;
    const DU du;
    const int count_of_slices = int(slices.size()), firsts = (count_of_slices + 1) / 2;
    Light light = no_light(), first_half = light;
    for (int k = 0; k < count_of_slices; ++k) {
      if (k == firsts) first_half = light;
      const Slice& slice = slices[std::size_t(slice_at(k, count_of_slices))];
      const SliceFrame f = slice_frame(march.scene, p, slice);
      for (const bool forward : {true, false}) {
        const SideFrame side =
            side_frame(march.scene, p, f, forward, slice.sides[forward ? 0 : 1].phase);
        const auto receive = [&](VU bits, const auto& sent) HWY_ATTR {
          if (hn::AllTrue(du, bits == hn::Zero(du))) return;
          light.add(f.weight * measure_of(p, side, bits), sent());
        };
        march_side<kOrthographic>(
            march, p, side, slice, forward,
            [&](int layer, std::ptrdiff_t q, const SliceStep& step, VU bits) HWY_ATTR {
              receive(bits, [&]() HWY_ATTR {
                if (layer > 0) return load_color((*job.sent_behind)[std::size_t(layer - 1)], q);
                const Color front = load_color(*job.sent, q);
                if (!job.sent_back) return front;
                const Color back = load_color(*job.sent_back, q);
                const M seen = faces<kOrthographic>(march.scene, q, step, p);
                return Color{hn::IfThenElse(seen, front.r, back.r),
                             hn::IfThenElse(seen, front.g, back.g),
                             hn::IfThenElse(seen, front.b, back.b)};
              });
            },
            [&](const Border& border, VU bits) HWY_ATTR {
              receive(bits, [&]() HWY_ATTR {
                return Color{border(job.sent_border[0]), border(job.sent_border[1]),
                             border(job.sent_border[2])};
              });
            });
      }
    }
    store_color(light.sum, *job.gathered, p.place.index);
    hn::StoreU(light.weights, d, job.weights->data() + p.place.index);
    if (!job.difference) return;
    // Where one half has met nothing, the other is all that is known.
    const Light second_half = light.minus(first_half);
    const V zero = hn::Zero(d);
    const V difference = luminance(first_half.mean()) - luminance(second_half.mean());
    const M both = hn::And(first_half.weights > zero, second_half.weights > zero);
    hn::StoreU(hn::IfThenElseZero(both, difference) * light.weights *
                   hn::Set(d, error_of_difference(march, p.place, firsts, count_of_slices)),
               d, job.difference->data() + p.place.index);
  });
}

/// How much a neighbour, (dx, dy) pixels away, is on the receiver's surface: as the filter has it.
template <bool kOrthographic>
HWY_INLINE V likeness(const MarchScene& scene, const Receiver& p, std::ptrdiff_t q, int dx,
                      int dy) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto load = [&](const InterleavedPlane& plane)
                        HWY_ATTR { return hn::LoadU(d, plane.data() + q); };
  const V depth = load(scene.depth());
  const M valid = hn::And(p.valid, depth == depth);
  V qx = p.slope_x + hn::Set(d, float(dx) / scene.fx),
    qy = p.slope_y - hn::Set(d, float(dy) / scene.fy);
  if constexpr (!kOrthographic) qx = qx * depth, qy = qy * depth;
  const V x = qx - p.px, y = qy - p.py, z = zero - depth - p.pz;
  const V off_plane = dot3(x, y, z, p.nx, p.ny, p.nz);
  constexpr float kSine = 0.3f, kSlope = 10;  // 17 degrees, and 37 between normals
  const M near = off_plane * off_plane <= hn::Set(d, kSine * kSine) * dot3(x, y, z, x, y, z);
  const V cosine = dot3(p.nx, p.ny, p.nz, load(scene.nx), load(scene.ny), load(scene.nz));
  const V turn = hn::MulAdd(cosine - one, hn::Set(d, kSlope), hn::Set(d, 2.0f));
  return hn::IfThenElseZero(hn::And(valid, near), hn::Clamp(turn, zero, one));
}

/// Calls `visit(index, dx, dy)` for the pixels around a place that march.
template <class Visit>
HWY_INLINE void for_each_gatherer(const MarchScene& scene, int spacing, const Place& place,
                                  const Visit& visit) {
  constexpr int kPeriod = Interleaving::kPeriod;
  const Interleaving& layout = scene.layout;
  const int off_x = place.column_phase & (spacing - 1),
            off_y = (place.y + scene.first_y) & (spacing - 1);
  for (int dy = -off_y; dy <= off_y; dy += spacing) {
    if (place.y + dy < 0 || place.y + dy >= layout.height()) continue;
    for (int dx = -off_x; dx <= off_x; dx += spacing) {
      const int column_phase = place.column_phase + dx;
      visit(layout.index(place.y + dy, column_phase & (kPeriod - 1),
                         place.column + (column_phase >> Interleaving::kShift)),
            dx, dy);
    }
  }
}

/// Gives every pixel its bounce from those that have gathered light.
template <bool kOrthographic>
void spread(const BounceJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const D d;
    const std::ptrdiff_t i = place.index;
    const V zero = hn::Zero(d);
    const Receiver p = load_receiver(scene, place);
    Light of_surface = no_light(), of_all = no_light();
    V difference = zero;
    for_each_gatherer(
        scene, job.march.pattern.spacing(), place, [&](std::ptrdiff_t q, int dx, int dy) HWY_ATTR {
          const V weights = hn::LoadU(d, job.weights->data() + q);
          const V depth = hn::LoadU(d, scene.depth().data() + q);
          const M found = hn::And(depth == depth, weights > zero);
          if (hn::AllFalse(d, found)) return;
          const auto known = [&](V v) HWY_ATTR { return hn::IfThenElseZero(found, v); };
          const Color sum = load_color(*job.gathered, q);
          const Light light{{known(sum.r), known(sum.g), known(sum.b)}, known(weights)};
          const V like =
              dx == 0 && dy == 0 ? hn::Set(d, 1.0f) : likeness<kOrthographic>(scene, p, q, dx, dy);
          of_surface = {mul_add(light.sum, like, of_surface.sum),
                        hn::MulAdd(light.weights, like, of_surface.weights)};
          of_all = {mul_add(light.sum, hn::Set(d, 1.0f), of_all.sum),
                    of_all.weights + light.weights};
          if (job.difference)
            difference =
                hn::MulAdd(known(hn::LoadU(d, job.difference->data() + q)), like, difference);
        });
    // ao may see an occluder that no march for the bounce met; it is assumed to be close and to
    // send what the receiver sends.
    const Color own = load_color(*job.sent, i);
    const Color surface = of_surface.mean(), all = of_all.mean();
    const M on_surface = of_surface.weights > zero, anywhere = of_all.weights > zero;
    const auto choose = [&](V first, V second, V third) HWY_ATTR {
      return hn::IfThenElse(on_surface, first, hn::IfThenElse(anywhere, second, third));
    };
    const V hidden =
        hn::IfThenElseZero(p.valid, hn::Set(d, 1.0f) - hn::LoadU(d, job.ao->data() + i));
    store_color(scaled({choose(surface.r, all.r, own.r), choose(surface.g, all.g, own.g),
                        choose(surface.b, all.b, own.b)},
                       hidden),
                *job.bounce, i);
    if (job.error) {
      const V error = hn::IfThenElseZero(on_surface, hidden * difference / of_surface.weights);
      hn::StoreU(error, d, job.error->data() + i);
    }
  });
}

void gather_in_pixels(const BounceJob& job, const Window& part) {
  job.march.scene.orthographic ? gather<true>(job, part) : gather<false>(job, part);
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
