// SPDX-License-Identifier: Apache-2.0
//
// The light of lamps on surfaces that are assumed to continue beyond the border of the frame, for a
// vector of pixels; compiled once for every instruction set.
//
// A pixel at the border sends albedo * visibility * E of a lamp, E its unoccluded light there. The
// surface beyond is taken to have the albedo and the visibility of that pixel, and E of its own
// place: a lamp lights what is near it, and a spot only what is in its cone.
#if defined(SSDO_BITMASK_LAMP_BEYOND_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_LAMP_BEYOND_INL_H_
#undef SSDO_BITMASK_LAMP_BEYOND_INL_H_
#else
#define SSDO_BITMASK_LAMP_BEYOND_INL_H_
#endif

#include <vector>

#include "estimators/bitmask/border/border_light.h"
#include "estimators/bitmask/border/extension-inl.h"
#include "estimators/bitmask/lanes-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The plane that a surface at the border continues in.
struct BorderPlane {
  V3 position;  ///< in the middle of the border pixel
  V3 normal;    ///< unit
};

template <bool kOrthographic>
HWY_INLINE BorderPlane border_plane(const MarchScene& scene, const MarchReceiver& p,
                                    const Border& border) {
  const V depth = border(scene.border_depth);
  V3 at{hn::MulAdd(border.dx, set(1 / scene.fx), p.slope_x),
        hn::NegMulAdd(border.dy, set(1 / scene.fy), p.slope_y), set(-1)};
  if constexpr (kOrthographic)
    at.z = hn::Neg(depth);
  else
    at = at * depth;
  return {at,
          {border(scene.border_normal[0]), border(scene.border_normal[1]),
           border(scene.border_normal[2])}};
}

/// Where the ray from the receivers through the sectors `in` meets the plane, at `part` of the way
/// from the lowest sector to the highest of this run; the border pixel where the ray does not meet
/// its front.
HWY_INLINE V3 met_beyond(const BorderPlane& plane, const MarchReceiver& p, const SideFrame& side,
                         VU in, float part) {
  const auto count = [](VU bits) HWY_ATTR {
    return hn::ConvertTo(D(), hn::BitCast(DI(), hn::PopulationCount(bits)));
  };
  const V first = count(hn::AndNot(in, in - set_bits(1))),
          sector = hn::MulAdd(count(in) - set(1), set(part), first);
  const V cosine = hn::Clamp((side.start - set(0.5f) - sector) * set(1 / SliceSectors::kPerCosine),
                             set(-1), set(1)),
          sine = hn::Sqrt(set(1) - cosine * cosine);
  const V3 way = mul_add(p.to_viewer, cosine, side.t * sine);
  const V toward = dot(way, plane.normal),
          distance = dot(plane.position - p.position, plane.normal) / toward;
  const M meets = hn::And(toward<set(0), distance> set(0));
  return if_then_else(meets, mul_add(way, distance, p.position), plane.position);
}

/// What surfaces beyond the border send of the light of lamps into the sectors `in`.
template <bool kOrthographic>
HWY_INLINE V3 sent_beyond(const MarchScene& scene, const std::vector<LampBeyond>& lamps,
                          const MarchReceiver& p, const SideFrame& side, const Border& border,
                          VU in) {
  const BorderPlane plane = border_plane<kOrthographic>(scene, p, border);
  const V3 places[] = {met_beyond(plane, p, side, in, 0.25f),
                       met_beyond(plane, p, side, in, 0.75f)};
  V3 sum = set(glm::vec3(0));
  for (const LampBeyond& of : lamps) {
    const V3 here{border(of.sent[0]), border(of.sent[1]), border(of.sent[2])};
    if (!any(luminance(here) > set(0))) continue;
    const V light = received(*of.lamp, plane.position, plane.normal),
            there = set(0.5f) * (received(*of.lamp, places[0], plane.normal) +
                                 received(*of.lamp, places[1], plane.normal));
    sum = mul_add(here, hn::IfThenElse(light > set(0), there / light, set(1)), sum);
  }
  return sum;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
