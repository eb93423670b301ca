// SPDX-License-Identifier: Apache-2.0
//
// The light of a sun where a pixel sees it: a march along the one slice that holds it, compiled
// once for every instruction set. Here lanes look at different offsets, so that samples are
// gathered.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/sun.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/extension-inl.h"
#include "estimators/bitmask/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// How far a thing goes on beyond the frame before a sun, in widths of its own. What hides a sun is
/// all or nothing, where slices average many guesses, so that the guess has to be a safer one.
constexpr float kSunWidths = 8;

/// How many pixels of the border are asked what goes on there, and how far they lie to both sides
/// of where the ray leaves the frame, in heights of the frame. One alone may show a ledge, or the
/// gap beside it, and draw its shadow across the frame. Relative error of direct light, one to
/// five: a street 0.994, 0.946; things on a table 0.121, 0.113; more or farther ones change little.
constexpr int kWitnesses = 5;
constexpr float kWitnessReach = 0.1f;

/// The way to the sun from a receiver.
struct SunRay {
  V s, v;            ///< its direction in the slice
  V step_x, step_y;  ///< unit, pixels: its picture
  V end_px;          ///< where its picture ends: at the horizon
};

HWY_INLINE SunRay sun_ray(const MarchScene& scene, const Receiver& p, const SunJob::Direction& to,
                          SideFrame& side) {
  const D d;
  const V lx = hn::Set(d, to.x), ly = hn::Set(d, to.y), lz = hn::Set(d, to.z);
  SunRay ray;
  ray.v = dot3(lx, ly, lz, p.vx, p.vy, p.vz);
  const V tx = hn::NegMulAdd(ray.v, p.vx, lx), ty = hn::NegMulAdd(ray.v, p.vy, ly),
          tz = hn::NegMulAdd(ray.v, p.vz, lz);
  ray.s = hn::Sqrt(dot3(tx, ty, tz, tx, ty, tz));
  const V scale = hn::Set(d, 1.0f) / hn::Max(ray.s, hn::Set(d, 1e-6f));
  side.tx = tx * scale, side.ty = ty * scale, side.tz = tz * scale;
  side.n_t = dot3(p.nx, p.ny, p.nz, side.tx, side.ty, side.tz);
  side.slope = side.n_t / p.facing;
  side.across_x = side.tx * hn::Set(d, 1 / scene.fx);
  side.across_y = side.ty * hn::Set(d, -1 / scene.fy);

  const V depth = hn::Zero(d) - p.pz;
  V dx = hn::Set(d, scene.fx) * lx, dy = hn::Set(d, -scene.fy) * ly;
  ray.end_px = hn::Set(d, 1e9f);
  if (!scene.orthographic) {
    // The derivative of the projection, times the square of the depth.
    dx = hn::Set(d, scene.fx) * hn::MulAdd(lx, depth, lz * p.px);
    dy = hn::Set(d, -scene.fy) * hn::MulAdd(ly, depth, lz * p.py);
  }
  const V length = hn::Sqrt(dot2(dx, dy, dx, dy));
  if (!scene.orthographic && to.z < 0) ray.end_px = length / (depth * hn::Set(d, -to.z));
  const V unit = hn::Set(d, 1.0f) / hn::Max(length, hn::Set(d, 1e-20f));
  ray.step_x = dx * unit, ray.step_y = dy * unit;
  return ray;
}

/// Which lanes that look see a surface in the ray, which lies at s, `above` the receiver's tangent
/// plane, and reaches back by what `load_depth` gives: few rays ask.
template <bool kOrthographic, class LoadDepth>
HWY_INLINE M blocks(const Receiver& p, const SideFrame& side, const SunRay& ray, M looks, V s,
                    V above, float radius, const LoadDepth& load_depth) {
  const D d;
  const V v = hn::NegMulAdd(s, side.slope, above);
  const M near = hn::And(above > hn::Zero(d), dot2(s, v, s, v) <= hn::Set(d, radius * radius));
  const M front_above = hn::And(hn::And(looks, near), s * ray.v <= v * ray.s);
  if (hn::AllFalse(d, front_above)) return front_above;
  const V depth = load_depth();
  const SlicePoint back = back_of<kOrthographic>(p, s, v, depth);
  return hn::And(front_above, back.s * ray.v >= back.v * ray.s);
}

/// A pixel in the middle of its block of 4 x 4, where samples lie far apart: as in the slices, so
/// few are asked for that they stay in the cache.
HWY_INLINE V middle_of_block(V pixel) {
  const V block = hn::Set(D(), 4.0f), middle = hn::Set(D(), 2.0f);
  return hn::MulAdd(hn::Round((pixel - middle) * hn::Set(D(), 0.25f)), block, middle);
}

/// How many of the surfaces that go on beyond the frame let rays pass, 0..1. `turn` in 0..1 differs
/// from member to member of the pattern.
template <bool kOrthographic>
HWY_INLINE V open_beyond(const March& march, const Receiver& p, const SideFrame& side,
                         const SunRay& ray, M open, float turn) {
  const D d;
  const V zero = hn::Zero(d);
  const float apart_px = 2 * kWitnessReach * float(march.scene.layout.height()) / kWitnesses;
  V passed = zero;
  for (int k = 0; k < kWitnesses; ++k) {
    const float aside_px = std::round((float(k) + turn - 0.5f * kWitnesses) * apart_px);
    const Border border = border_along(march.scene, p, ray.step_x, ray.step_y, false, aside_px);
    const Extension e = extend<kOrthographic>(march, p, side, border, kSunWidths);
    // The ray passes between both ends of the piece.
    const V here = e.s * ray.v - e.v * ray.s, there = e.end_s * ray.v - e.end_v * ray.s;
    const M leaves = hn::And(e.exists, border.distance_px < ray.end_px);
    const M crosses = hn::And(leaves, here * there <= zero);
    const M rises = hn::Or(e.above > zero, e.end_above > zero);
    // The last step may be far from the border.
    const M meets = blocks<kOrthographic>(p, side, ray, hn::And(open, leaves), e.s, e.above,
                                          march.radius, [&]() HWY_ATTR { return e.depth; });
    const M hides = hn::Or(meets, hn::And(crosses, rises));
    passed = passed + hn::IfThenElseZero(hn::AndNot(hides, open), hn::Set(d, 1.0f / kWitnesses));
  }
  return passed;
}

template <bool kOrthographic>
void sun(const SunJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const D d;
    const DI di;
    constexpr int kPeriod = Interleaving::kPeriod;
    const Interleaving& layout = scene.layout;
    const V zero = hn::Zero(d);
    const int member = ((place.y + scene.first_y) & (kPeriod - 1)) * kPeriod + place.column_phase;
    Receiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    SideFrame side;
    const SunRay ray = sun_ray(scene, p, job.directions[std::size_t(member)], side);
    const V right = hn::Set(d, float(layout.width() - 1)),
            bottom = hn::Set(d, float(layout.height() - 1));
    M open = hn::And(p.valid, dot2(side.n_t, p.facing, ray.s, ray.v) > zero);
    float before = 0;
    for (const float distance : job.distances_px[std::size_t(member)]) {
      const V t = hn::Set(d, distance);
      V qx_px = hn::Round(hn::MulAdd(t, ray.step_x, p.x)),
        qy_px = hn::Round(hn::MulAdd(t, ray.step_y, p.y));
      if (distance - before > kLongStep)
        qx_px = middle_of_block(qx_px), qy_px = middle_of_block(qy_px);
      before = distance;
      const M inside = hn::And(hn::And(qx_px >= zero, qx_px <= right),
                               hn::And(hn::And(qy_px >= zero, qy_px <= bottom), t < ray.end_px));
      const M looks = hn::And(inside, open);
      if (distance > p.reach_px || hn::AllFalse(d, looks)) break;
      const auto shifted =
          hn::ConvertTo(di, hn::IfThenElseZero(looks, qx_px)) + hn::Set(di, layout.phase());
      const auto line = hn::ConvertTo(di, hn::IfThenElseZero(looks, qy_px)) * hn::Set(di, kPeriod) +
                        hn::And(shifted, hn::Set(di, kPeriod - 1));
      const auto index = line * hn::Set(di, int(layout.stride())) +
                         hn::ShiftRight<Interleaving::kShift>(shifted) +
                         hn::Set(di, Interleaving::kPad);
      const auto gather = [&](const InterleavedPlane& plane)
                              HWY_ATTR { return hn::GatherIndex(d, plane.data(), index); };
      const V dx = qx_px - p.x, dy = qy_px - p.y;
      const V rise = hn::MulAdd(dx, p.rise_x, hn::MulAdd(dy, p.rise_y, p.rise)),
              across = dot2(dx, dy, side.across_x, side.across_y);
      for (const MarchLayer& layer : scene.layers) {
        const V depth = gather(layer.depth);
        const M hides =
            blocks<kOrthographic>(p, side, ray, looks, kOrthographic ? across : depth * across,
                                  height_above<kOrthographic>(p, rise, depth), job.march.radius,
                                  [&]() HWY_ATTR { return gather(layer.thickness); });
        open = hn::AndNot(hides, open);
      }
    }
    V visible = hn::IfThenElseZero(open, hn::Set(d, 1.0f));
    if (job.march.extend && !hn::AllFalse(d, open)) {
      const float turn = (float(SlicePattern::rank(member)) + 0.5f) / (kPeriod * kPeriod);
      visible = open_beyond<kOrthographic>(job.march, p, side, ray, open, turn);
    }
    const V cosine = load_normals(scene, place.index, p.valid).facing(job.sun->direction);
    store_color(mul_add(set_color(job.sun->irradiance), visible * cosine,
                        load_color(*job.direct, place.index)),
                *job.direct, place.index);
  });
}

void sun_of_pixels(const SunJob& job, const Window& part) {
  job.march.scene.orthographic ? sun<true>(job, part) : sun<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(sun_of_pixels);

void march_sun(const SunJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(sun_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
