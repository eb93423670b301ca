// SPDX-License-Identifier: Apache-2.0
//
// Lamps on vectors of surfaces: the functions of LocalLamp in floats. Few receivers have the lamp
// cut by their horizon, by the edge of a cone or by its own surface: each of these is computed
// alone, by LocalLamp. Compiled once for every instruction set.
#if defined(SSDO_SCENE_NEAR_LAMP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_NEAR_LAMP_INL_H_
#undef SSDO_SCENE_NEAR_LAMP_INL_H_
#else
#define SSDO_SCENE_NEAR_LAMP_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>

#include <cmath>
#include <utility>

#include "scene/light/lamps/distant_lamp.h"
#include "scene/light/lamps/local_lamp.h"
#include "simd/by_lane-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// SourcePoint
struct SourcePoints {
  V3 to;
  V distance, weight;
};

/// SourceCone, and the sine of `angular_radius`.
struct SourceCones {
  V3 to;
  V angular_radius, sine;
};

/// A direction in the axes of a lamp, and back.
HWY_INLINE V3 to_lamp(const LocalLamp& lamp, const V3& v) {
  return {dot(v, set(lamp.axes[0])), dot(v, set(lamp.axes[1])), dot(v, set(lamp.axes[2]))};
}
HWY_INLINE V3 from_lamp(const LocalLamp& lamp, const V3& v) {
  return mul_add(set(lamp.axes[0]), v.x, mul_add(set(lamp.axes[1]), v.y, set(lamp.axes[2]) * v.z));
}
HWY_INLINE V3 place_at_lamp(const LocalLamp& lamp, const V3& position) {
  return to_lamp(lamp, position - set(lamp.center)) * set(float(1 / lamp.size));
}

HWY_INLINE V length(V x, V y) { return hn::Sqrt(hn::MulAdd(x, x, y * y)); }
HWY_INLINE V root(V x) { return hn::Sqrt(hn::Max(x, set(0))); }
HWY_INLINE V arc_cosine(V x) { return hn::Acos(D(), hn::Clamp(x, set(-1), set(1))); }

/// frame_about() of math/frame.h, times a vector.
HWY_INLINE V3 in_frame_about(const V3& n, const V3& v) {
  const V sign = hn::CopySign(set(1), n.z), a = set(-1) / (sign + n.z), b = n.x * n.y * a;
  const V3 first{hn::MulAdd(sign * n.x, n.x * a, set(1)), sign * b, hn::Neg(sign * n.x)},
      second{b, hn::MulAdd(n.y, n.y * a, sign), hn::Neg(n.y)};
  return mul_add(first, v.x, mul_add(second, v.y, n * v.z));
}

/// The factor from a solid angle, in units of the lamp, to received(): 1 over the area that the
/// lamp shows, dimmed for receivers that are too near.
HWY_INLINE V per_solid_angle(const LocalLamp& lamp, V distance) {
  const float nearest = float(lamp.nearest / lamp.size);
  const V ratio =
      nearest > 0 ? hn::Min(hn::Max(distance, set(1)) * set(1 / nearest), set(1)) : set(1);
  return ratio * ratio * set(float(1 / (lamp.shown_area() * lamp.size * lamp.size)));
}

/// An integral of the cosine, and the lanes in which `value` does not hold: these are computed
/// alone.
struct Integral {
  V value;
  M open;
};

HWY_INLINE Integral integral_of_sphere(const LocalLamp& lamp, const V3& p, const V3& n) {
  const V squared = dot(p, p), middle = hn::Neg(dot(n, p)), distance = hn::Sqrt(squared);
  // 1 over the squared sine of its angle.
  const V per_sine2 = lamp.faces_receiver ? squared + set(1) : squared;
  const V value = set(float(3.14159265358979)) * hn::Max(middle, set(0)) / (per_sine2 * distance);
  // Within the sphere, or with the horizon in it: |cos| < sine.
  return {value, hn::Or(squared < set(1), middle * middle * per_sine2 < squared)};
}

// LocalLamp's DiskLamp::integral(), without the turn and without a difference of large numbers.
HWY_INLINE Integral integral_of_disk(const V3& p, const V3& n) {
  const V off2 = hn::MulAdd(p.x, p.x, p.y * p.y), off = hn::Sqrt(off2), h = p.z;
  const V inward = hn::MulAdd(n.x, p.x, n.y * p.y);  // n_x off
  const V tilt = length(n.x, n.y), cut = hn::MulAdd(n.z, h, inward);
  const V one = set(1), s = length(one - off, h) * length(one + off, h);
  const V flat = hn::MulAdd(h, h, one);  // A - off^2
  const V rest = flat + (flat * flat + set(2) * off2 * (h * h - one)) / (s + off2);
  const V sum = n.z * rest + set(2) * inward * h;
  const V value = set(-3.14159265f) * sum / (s * (flat + off2 + s));
  const M front = h > set(0), whole = hn::And(front, cut <= hn::Neg(tilt));
  return {hn::IfThenElseZero(whole, value), hn::And(front, hn::Abs(cut) < tilt)};
}

/// The part of Lambert's formula for an edge; see rect_lamp.cpp.
HWY_INLINE V along_edge(const V3& from, const V3& to, const V3& n) {
  const V3 across = cross(from, to);
  const V sine = hn::Sqrt(dot(across, across)),
          cosine = hn::Sqrt(dot(from, from) * dot(to, to)) + dot(from, to);
  const V half_angle = hn::Atan(D(), sine / hn::Max(cosine, set(1e-30f)));
  return set(2) * half_angle * dot(n, across) / hn::Max(sine, set(1e-30f));
}

HWY_INLINE Integral integral_of_rect(const LocalLamp& lamp, const V3& p, const V3& n) {
  constexpr float kFar = 8;  // the edges cancel, and four points are as good as all
  const V half_x = set(float(lamp.half_sides.x)), half_y = set(float(lamp.half_sides.y));
  const V low_x = hn::Neg(half_x) - p.x, high_x = half_x - p.x, low_y = hn::Neg(half_y) - p.y,
          high_y = half_y - p.y, z = hn::Neg(p.z);
  const V3 a{low_x, low_y, z}, b{high_x, low_y, z}, c{high_x, high_y, z}, d{low_x, high_y, z};
  const V above_a = dot(n, a), above_b = dot(n, b), above_c = dot(n, c), above_d = dot(n, d);
  const V least = hn::Min(hn::Min(above_a, above_b), hn::Min(above_c, above_d)),
          most = hn::Max(hn::Max(above_a, above_b), hn::Max(above_c, above_d));
  const V sum =
      along_edge(a, b, n) + along_edge(b, c, n) + along_edge(c, d, n) + along_edge(d, a, n);
  // Gauss's quadrature.
  const V at_x = half_x * set(0.57735027f), at_y = half_y * set(0.57735027f);
  V four = set(0);
  for (const auto& [sign_x, sign_y] :
       {std::pair(-1.f, -1.f), {-1.f, 1.f}, {1.f, -1.f}, {1.f, 1.f}}) {
    const V3 way{set(sign_x) * at_x - p.x, set(sign_y) * at_y - p.y, z};
    const V squared = dot(way, way);
    four = four + dot(n, way) / (squared * squared);
  }
  const V far = set(float(lamp.shown_area() / 4)) * p.z * four;
  const V value = hn::IfThenElse(dot(p, p) > set(kFar * kFar), far, set(-0.5f) * sum);
  const M front = p.z > set(0);
  return {hn::IfThenElseZero(hn::And(front, least >= set(0)), hn::Max(value, set(0))),
          hn::And(front, hn::And(least<set(0), most> set(0)))};
}

/// Cone::at() in directions at these cosines to the axis.
HWY_INLINE V share_in_cone(const Cone& cone, V cosine) {
  if (cone.by_cosine && cone.inner < cone.outer)
    return smoothstep(set(float(std::cos(cone.outer))), set(float(std::cos(cone.inner))), cosine);
  const V off_axis = arc_cosine(cosine), outer = set(float(cone.outer));
  return cone.inner < cone.outer ? set(1) - smoothstep(set(float(cone.inner)), outer, off_axis)
                                 : hn::IfThenElseZero(off_axis < outer, set(1));
}

/// The share of light that the cone passes, for a lamp so small that this share is smooth over it:
/// the mean of the shares at a few places, weighted by what each place gives to the receiver. A
/// cubature of degree 5, for a disk that of Radon (Stroud 1971, Approximate Calculation of Multiple
/// Integrals, S2 5-1), for a rectangle that of Gauss.
HWY_INLINE V mean_share(const LocalLamp& lamp, const V3& p, const V3& n) {
  constexpr float kGauss[] = {-0.77459667f, 0, 0.77459667f};  // sqrt(3 / 5)
  constexpr float kHexagon[][2] = {{0.81649658f, 0},          // sqrt(2 / 3) away
                                   {0.40824829f, 0.70710678f}, {-0.40824829f, 0.70710678f},
                                   {-0.81649658f, 0},          {-0.40824829f, -0.70710678f},
                                   {0.40824829f, -0.70710678f}};
  const bool is_rect = lamp.shape == LampShape::rect, is_ball = lamp.shape == LampShape::sphere;
  V3 along{set(1), set(0), set(0)}, across{set(0), set(1), set(0)};
  if (is_ball) {  // it is seen as a disk that faces the receiver
    const V3 out = normalise(p);
    along = in_frame_about(out, along), across = in_frame_about(out, across);
  }
  V share = set(0), light = set(1e-30f);
  for (int k = 0; k < (is_rect ? 9 : 7); ++k) {
    float x = 0, y = 0, weight = 2;
    if (is_rect) {
      x = kGauss[k % 3] * float(lamp.half_sides.x), y = kGauss[k / 3] * float(lamp.half_sides.y);
      weight = (k % 3 == 1 ? 8.0f : 5.0f) * (k / 3 == 1 ? 8.0f : 5.0f);
    } else if (k > 0) {
      x = kHexagon[k - 1][0], y = kHexagon[k - 1][1], weight = 1;
    }
    const V3 way = mul_add(along, set(x), across * set(y)) - p;
    const V squared = dot(way, way), distance = hn::Sqrt(squared),
            slope = hn::Neg(way.z) / distance;
    const V facing = is_ball ? set(1) : hn::Max(slope, set(0));
    const V gives = set(weight) * hn::Max(dot(n, way), set(0)) * facing / (squared * distance);
    share = hn::MulAdd(gives, share_in_cone(lamp.spot_cone, slope), share);
    light = light + gives;
  }
  return share / light;
}

/// For a lamp with a cone: the lanes that get light from all of it, those for which mean_share()
/// holds, and those near the edge of the cone, which are computed alone.
struct InCone {
  M whole, smooth, open;
};

HWY_INLINE InCone in_cone(const LocalLamp& lamp, const V3& p) {
  // mean_share() is within 3e-4 then: lamp_lanes_test.cpp.
  constexpr float kSmooth = 0.1f, kFar = 4;
  const V distance = hn::Sqrt(dot(p, p)), reach = set(float(lamp.reach()));
  const V off_axis = arc_cosine(p.z / distance),
          angle = hn::Asin(D(), hn::Min(reach / distance, set(1))), margin = set(1e-4f);
  const M away = distance > reach;
  const M whole = hn::And(away, off_axis + angle + margin < set(float(lamp.spot_cone.inner))),
          dark = hn::And(away, set(float(lamp.spot_cone.outer)) < off_axis - angle - margin);
  const M cut = hn::Not(hn::Or(whole, dark));
  const M is_small =
      hn::And(distance > set(kFar) * reach,
              angle < set(kSmooth * float(lamp.spot_cone.outer - lamp.spot_cone.inner)));
  return {whole, hn::And(cut, is_small), hn::AndNot(is_small, cut)};
}

HWY_INLINE V received(const LocalLamp& lamp, const V3& position, const V3& normal) {
  const V3 p = place_at_lamp(lamp, position), n = to_lamp(lamp, normal);
  Integral found = lamp.shape == LampShape::sphere ? integral_of_sphere(lamp, p, n)
                   : lamp.shape == LampShape::disk ? integral_of_disk(p, n)
                                                   : integral_of_rect(lamp, p, n);
  const M lit = hn::Or(found.open, found.value > set(0));
  if (!lamp.spot_cone.is_open()) {
    const InCone cone = in_cone(lamp, p);
    // Where the horizon cuts it too, each is computed alone.
    const M smooth = hn::AndNot(found.open, hn::And(cone.smooth, lit));
    found.open = hn::Or(hn::And(hn::Or(cone.open, cone.smooth), hn::And(lit, hn::Not(smooth))),
                        hn::And(cone.whole, found.open));
    V share = hn::IfThenElseZero(cone.whole, set(1));
    if (any(smooth)) share = hn::IfThenElse(smooth, mean_share(lamp, p, n), share);
    found.value = found.value * share;
  }
  const V all = found.value * per_solid_angle(lamp, hn::Sqrt(dot(p, p)));
  if (!any(found.open)) return all;
  const Lanes3 positions(position), normals(normal);
  const Lanes open(hn::IfThenElseZero(found.open, set(1)));
  return hn::IfThenElse(found.open, by_lane([&](int lane) HWY_ATTR {
                          return open[lane] > 0 ? lamp.received(positions[lane], normals[lane])
                                                : 0.0f;
                        }),
                        all);
}

HWY_INLINE V received(const DistantLamp& lamp, const V3& normal) {
  const V middle = dot(normal, set(lamp.direction)), edge = set(float(lamp.cap.sine));
  const M part = hn::And(middle<edge, middle> hn::Neg(edge));
  if (lamp.cap.cosine >= 0 && !any(part)) return hn::IfThenElseZero(middle >= edge, middle);
  const Lanes3 normals(normal);
  return by_lane([&](int lane) HWY_ATTR { return lamp.received({}, normals[lane]); });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
