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

#include "estimators/bitmask/lanes-inl.h"
#include "scene/solids/unseen_side.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The sides of solids that the camera does not see behind what pixels show: see
/// scene/solids/unseen_side.h.
struct UnseenSide {
  V3 position, normal;  ///< unit
  V clear;              ///< a ray that has come so far from it has left its own solid
  M ends;               ///< an endless solid has no such side
};

HWY_INLINE UnseenSide unseen_side(const MarchScene& scene, const MarchReceiver& p) {
  const V thickness = load(scene.layers.front().thickness, p.place.index);
  const V pixel = (scene.orthographic ? set(1) : p.distance) *
                  set(1 / (scene.fx < scene.fy ? scene.fx : scene.fy)),
          length = scene.orthographic ? thickness : thickness * p.distance;
  const V through = hn::MulAdd(length, set(1 / kDepthOfWidth), set(0.5f) * pixel);
  UnseenSide side;
  side.ends = thickness < set(scene.orthographic ? kInfiniteThickness : kInfiniteThicknessRatio);
  side.position = mul_add(p.to_viewer, hn::Neg(hn::IfThenElseZero(side.ends, through)), p.position);
  side.normal = mul_add(p.to_viewer, set(-2) * dot(p.normal, p.to_viewer), p.normal);
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
