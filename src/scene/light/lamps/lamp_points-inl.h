// SPDX-License-Identifier: Apache-2.0
//
// LocalLamp::seen() and cone() on vectors of surfaces. Compiled once for every instruction set.
#if defined(SSDO_SCENE_LAMP_POINTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_LAMP_POINTS_INL_H_
#undef SSDO_SCENE_LAMP_POINTS_INL_H_
#else
#define SSDO_SCENE_LAMP_POINTS_INL_H_
#endif

#include "scene/light/lamps/local_lamp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// LampSample
struct LampSamples {
  V3 to;
  V distance, solid_angle;
};

// SphereLamp::sample()
HWY_INLINE LampSamples sample_sphere(const LocalLamp& lamp, const V3& p, const V2& disk) {
  constexpr float kTouching = 1e-4f;
  const V squared = hn::Max(dot(p, p), set(1e-30f)), distance = hn::Sqrt(squared),
          inverse = set(1) / distance;
  const M inside = lamp.faces_receiver ? distance < set(0) : distance < set(1);
  const V sine2 = lamp.faces_receiver ? set(1) / (squared + set(1))
                                      : hn::Min(squared, set(1) / squared),
          cosine = lamp.faces_receiver ? distance * hn::Sqrt(sine2) : root(set(1) - sine2);
  const V all = hn::IfThenElse(inside, set(1) + cosine, sine2 / (set(1) + cosine));
  const V down = dot(disk, disk) * all, stretch = root(all * (set(2) - down));
  const V3 in_cap{disk.x * stretch, disk.y * stretch, set(1) - down};
  const V aside = distance * stretch, chord = root(set(1) - aside * aside * dot(disk, disk));
  const V first = lamp.faces_receiver ? distance / hn::Max(in_cap.z, set(kTouching))
                                      : distance * in_cap.z - chord;
  return {in_frame_about(p * hn::Neg(inverse), in_cap),
          hn::IfThenElse(inside, set(kTouching), hn::Max(first, set(kTouching))),
          set(6.28318531f) * all};
}

// DiskLamp::sample()
HWY_INLINE LampSamples sample_disk(const V3& p, const V2& disk) {
  const V one = set(1), off = length(p.x, p.y), h = hn::Max(p.z, set(1e-12f));
  const V across = hn::IfThenElse(off > set(0), one / hn::Max(off, set(1e-30f)), set(0));
  const V2 out{hn::IfThenElse(off > set(0), p.x * across, one), p.y * across};
  const V near = length(one - off, h), far = length(one + off, h);
  const V near_x = (one - off) / near, far_x = hn::Neg(one + off) / far;
  // near_x + far_x, whose parts are opposite numbers right at the disk.
  const V less = near * far * ((one - off) * far + (one + off) * near);
  const V sum_x = hn::IfThenElse(off < one, set(-4) * off * h * h / less, near_x + far_x),
          sum_z = hn::Neg(h) * (one / near + one / far);
  const V sum = length(sum_x, sum_z);
  const V middle_x = sum_x / sum, middle_z = sum_z / sum;
  const V cosine = hn::MulAdd(near_x, far_x, h * h / (near * far)),
          sine = set(2) * h / (near * far);
  const V length_of = hn::IfThenElse(cosine > set(0), sine / sum, root((one - cosine) * set(0.5f)));
  const V way = hn::Neg(h) / middle_z, at = hn::MulAdd(middle_x, way, off),
          half_chord = root(one - at * at), width = half_chord / length(half_chord, way);
  const V radius2 = dot(disk, disk), radius = hn::Sqrt(hn::Max(radius2, set(1e-30f)));
  const V edge_x = length_of * hn::IfThenElse(radius2 > set(0), disk.x / radius, one),
          edge_y = width * disk.y / radius;
  const V border = hn::Clamp(hn::MulAdd(edge_x, edge_x, edge_y * edge_y), set(1e-30f), one);
  const V all = border / (one + root(one - border)), down = radius2 * all,
          stretch = root(down * (set(2) - down) / border);
  const V flat_x = edge_x * stretch, flat_y = edge_y * stretch, up = one - down;
  const V x = hn::MulAdd(middle_x, up, hn::Neg(middle_z) * flat_x),
          z = hn::MulAdd(middle_z, up, middle_x * flat_x);
  return {{x * out.x - flat_y * out.y, hn::MulAdd(flat_y, out.x, x * out.y), z},
          h / hn::Max(hn::Neg(z), set(1e-12f)),
          hn::IfThenElseZero(p.z > set(0), set(6.28318531f) * all * length_of * width / border)};
}

// RectLamp::sample()
HWY_INLINE LampSamples sample_rect(const LocalLamp& lamp, const V3& p, const V2& share) {
  constexpr float kFar = float(kFarFromRect), kFull = 6.28318531f;
  const V half_x = set(float(lamp.half_sides.x)), half_y = set(float(lamp.half_sides.y)),
          h = hn::Max(p.z, set(1e-12f)), one = set(1);
  const V low_x = hn::Neg(half_x) - p.x, high_x = half_x - p.x, low_y = hn::Neg(half_y) - p.y,
          high_y = half_y - p.y;
  V x = hn::MulAdd(high_x - low_x, share.x, low_x), y = hn::MulAdd(high_y - low_y, share.y, low_y);
  const M far = dot(p, p) > set(kFar * kFar);
  V solid_angle = set(0);
  if (!all(far)) {
    const V low = hn::Neg(low_y) / length(low_y, h), high = high_y / length(high_y, h),
            left = hn::Neg(low_x) / length(low_x, h), right = high_x / length(high_x, h);
    const V rest = set(kFull) - arc_cosine(hn::Neg(left * low)) - arc_cosine(hn::Neg(left * high));
    solid_angle = hn::Max(
        arc_cosine(hn::Neg(right * low)) + arc_cosine(hn::Neg(right * high)) - rest, set(0));
    const V angle = hn::MulAdd(share.x, solid_angle, rest), sine = hn::Sin(D(), angle);
    const V f =
        (hn::Cos(D(), angle) * low - high) / hn::IfThenElse(sine == set(0), set(1e-9f), sine);
    const V c = hn::CopySign(one / hn::Max(length(f, low), set(1e-18f)), f);
    const V near_x =
        hn::Clamp(c * h / hn::Sqrt(hn::Max((one - c) * (one + c), set(1e-18f))), low_x, high_x);
    const V away = length(near_x, h), from = low_y / length(away, low_y),
            to = high_y / length(away, high_y), at = hn::MulAdd(to - from, share.y, from);
    const V near_y = hn::Clamp(away * at / hn::Sqrt(hn::Max((one - at) * (one + at), set(1e-18f))),
                               low_y, high_y);
    x = hn::IfThenElse(far, x, near_x), y = hn::IfThenElse(far, y, near_y);
  }
  const V3 way{x, y, hn::Neg(h)};
  const V squared = dot(way, way), distance = hn::Sqrt(squared);
  const V even = set(float(lamp.shown_area())) * h / (squared * distance);
  return {way / distance, distance,
          hn::IfThenElseZero(p.z > set(0), hn::IfThenElse(far, even, solid_angle))};
}

HWY_INLINE SourcePoints seen(const LocalLamp& lamp, const V3& position, const V3& point) {
  const V3 p = place_at_lamp(lamp, position);
  const V2 place{point.x, point.y};
  const LampSamples found = lamp.shape == LampShape::sphere ? sample_sphere(lamp, p, place)
                            : lamp.shape == LampShape::disk ? sample_disk(p, place)
                                                            : sample_rect(lamp, p, place);
  V weight = found.solid_angle * per_solid_angle(lamp, hn::Sqrt(dot(p, p)));
  if (!lamp.spot_cone.is_open())
    weight = weight * share_in_cone(lamp.spot_cone, hn::Neg(found.to.z));
  return {from_lamp(lamp, found.to), found.distance * set(float(lamp.size)), weight};
}

HWY_INLINE SourceCones cones(const LocalLamp& lamp, const V3& position) {
  const V3 way = set(lamp.center) - position;
  const V distance = hn::Sqrt(hn::Max(dot(way, way), set(1e-30f))),
          sine = hn::Min(set(float(lamp.reach() * lamp.size)) / distance, set(1));
  return {way / distance, hn::Asin(D(), sine), sine};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
