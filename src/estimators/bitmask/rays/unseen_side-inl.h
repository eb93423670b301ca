// SPDX-License-Identifier: Apache-2.0
//
// The sides of solids that the camera does not see, for a vector of pixels; compiled once for every
// instruction set.
#if defined(SSDO_BITMASK_UNSEEN_SIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_UNSEEN_SIDE_INL_H_
#undef SSDO_BITMASK_UNSEEN_SIDE_INL_H_
#else
#define SSDO_BITMASK_UNSEEN_SIDE_INL_H_
#endif

#include <limits>

#include "estimators/bitmask/lanes-inl.h"
#include "scene/solids/unseen_side.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The sides of solids that the camera does not see behind what pixels show: see
/// scene/solids/unseen_side.h.
struct UnseenSide {
  V3 position, normal;  ///< unit
  V3 mirrored;          ///< the normal of the visible side in the mirror, unit
  V clear;              ///< a ray that has come so far from it has left its own solid
  M ends;               ///< an endless solid has no such side
};

/// The tilt, as MarchPlanes has it, of the surface that the ends of the view rays in solids form.
struct EndsOfRays {
  V2 tilt;
  M bend;  ///< away from the shown surface, so that the tilt tells how the unseen side faces
};

/// The slope from a pixel to the one after it, by those to both sides: the lesser, as a surface may
/// end or fold between pixels.
HWY_INLINE V lesser_slope(V before, V after) {
  return hn::IfThenElse(hn::Abs(after) <= hn::Abs(before), after, hn::Neg(before));
}

/// normal_behind() of rays/emitters.cpp does the same for one pixel.
HWY_INLINE EndsOfRays ends_of_rays(const MarchScene& scene, const MarchReceiver& p) {
  const InterleavedPlane &depths = scene.depth(), &thicknesses = scene.layers.front().thickness;
  const V one = set(1), none_there = set(std::numeric_limits<float>::infinity());
  const auto nearness = [&](V depth)
                            HWY_ATTR { return scene.orthographic ? hn::Neg(depth) : one / depth; };
  const auto end_of = [&](V depth, V thickness) HWY_ATTR {
    return scene.orthographic ? depth + thickness : hn::MulAdd(depth, thickness, depth);
  };
  const std::ptrdiff_t i = p.place.index;
  const V depth = load(depths, i), front = nearness(depth),
          back = nearness(end_of(depth, load(thicknesses, i))), tilts = load(scene.tilt, i),
          per_front = scene.orthographic ? one : one / front,
          per_back = scene.orthographic ? one : one / back;
  const V2 shown{unpack_bf16_first(tilts), unpack_bf16_second(tilts)};
  const auto slope_to = [&](int dx, int dy) HWY_ATTR {
    if (p.place.y + dy < 0 || p.place.y + dy >= scene.layout.height()) return none_there;
    const std::ptrdiff_t q = place_beside(scene.layout, p.place, dx, dy).index;
    const V depth_there = load(depths, q),
            from_plane = hn::MulSub(nearness(depth_there) - front, per_front,
                                    dx != 0 ? shown.x * set(float(dx)) : shown.y * set(float(dy)));
    const M is_flat =  // false for not-a-number
        hn::Abs(from_plane) < set(kMostCurve / (dx != 0 ? scene.fx : scene.fy));
    const V back_there = nearness(end_of(depth_there, load(thicknesses, q)));
    return hn::IfThenElse(is_flat, (back_there - back) * per_back, none_there);
  };
  EndsOfRays ends;
  ends.tilt = {lesser_slope(slope_to(-1, 0), slope_to(1, 0)),
               lesser_slope(slope_to(0, -1), slope_to(0, 1))};
  const V bend = hn::Max(hn::Abs(ends.tilt.x - shown.x) * set(scene.fx),
                         hn::Abs(ends.tilt.y - shown.y) * set(scene.fy));
  ends.bend = hn::And(bend > set(kLeastBend), bend < none_there);
  return ends;
}

HWY_INLINE UnseenSide unseen_side(const MarchScene& scene, const MarchReceiver& p) {
  const V thickness = load(scene.layers.front().thickness, p.place.index);
  const V pixel = (scene.orthographic ? set(1) : p.distance) *
                  set(1 / (scene.fx < scene.fy ? scene.fx : scene.fy)),
          length = scene.orthographic ? thickness : thickness * p.distance;
  const V through = hn::MulAdd(length, set(1 / kDepthOfWidth), set(0.5f) * pixel);
  UnseenSide side;
  side.ends = thickness < set(scene.orthographic ? kInfiniteThickness : kInfiniteThicknessRatio);
  side.position = mul_add(p.to_viewer, hn::Neg(hn::IfThenElseZero(side.ends, through)), p.position);
  side.mirrored = mul_add(p.to_viewer, set(-2) * dot(p.normal, p.to_viewer), p.normal);
  const EndsOfRays ends = ends_of_rays(scene, p);
  const V3 of_ends = normal_of_tilt(scene, ends.tilt, {p.slope_x, p.slope_y});
  side.normal =
      if_then_else(ends.bend, of_ends * (set(-1) / hn::Sqrt(dot(of_ends, of_ends))), side.mirrored);
  side.clear = set(kBesidePx) * pixel;
  return side;
}

/// `p` moved to a point in front of the camera from which a ray leaves in the direction `to`, unit.
/// The plane that bounds what the ray meets (RayTraversal) passes through the point; the ray and
/// the direction to the viewer have the same angle to it.
HWY_INLINE MarchReceiver moved_to(const MarchScene& scene, MarchReceiver p, const V3& position,
                                  const V3& to) {
  const V one = set(1), zero = set(0);
  p.position = position;
  if (!scene.orthographic) p.position.z = hn::Min(position.z, p.distance * set(-1e-3f));
  if (scene.orthographic) {
    p.slope_x = position.x, p.slope_y = position.y;
    p.distance = hn::Neg(p.position.z);
  } else {
    const V nearness = set(-1) / p.position.z;
    p.slope_x = position.x * nearness, p.slope_y = position.y * nearness;
    const V length =
        hn::Sqrt(hn::MulAdd(p.slope_x, p.slope_x, hn::MulAdd(p.slope_y, p.slope_y, one)));
    const V towards = one / length;
    p.to_viewer = {zero - p.slope_x * towards, zero - p.slope_y * towards, towards};
    p.rise = zero - length;
    p.distance = length * hn::Neg(p.position.z);
  }
  p.x = hn::MulAdd(p.slope_x, set(scene.fx), set(scene.axis_x - float(scene.first_x)));
  p.y = hn::NegMulAdd(p.slope_y, set(scene.fy), set(scene.axis_y - float(scene.first_y)));
  p.normal = to + p.to_viewer;
  p.normal = p.normal * (one / hn::Sqrt(hn::Max(dot(p.normal, p.normal), set(1e-12f))));
  p.facing = bend_to_viewer(p.normal, p.to_viewer);
  const V along_view = one / p.facing;
  p.rise_x = p.normal.x * along_view * set(1 / scene.fx);
  p.rise_y = p.normal.y * along_view * set(-1 / scene.fy);
  p.plane = hn::NegMulAdd(p.distance * set(kHeightError), along_view, p.distance);
  return p;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
