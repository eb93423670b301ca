// SPDX-License-Identifier: Apache-2.0
//
// A ray and its line in the picture, for a vector of pixels, each with a direction of its own.
#if defined(SSDO_BITMASK_RAY_IN_SLICE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_RAY_IN_SLICE_INL_H_
#undef SSDO_BITMASK_RAY_IN_SLICE_INL_H_
#else
#define SSDO_BITMASK_RAY_IN_SLICE_INL_H_
#endif

#include "estimators/bitmask/overview-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A ray from a receiver.
struct RayInSlice {
  SlicePoint along;  ///< its direction in the slice
  V step_x, step_y;  ///< its direction in the picture, unit, pixels
  V end_px;          ///< how far away in the picture it reaches the horizon
  V nearing;         ///< by how much its nearness grows per pixel
  V per_px;          ///< way along it per pixel, at a depth of 1
};

/// Sets `side` to that of the slice which contains the direction `l`, a unit vector.
HWY_INLINE RayInSlice ray_in_slice(const MarchScene& scene, const MarchReceiver& p, const V3& l,
                                   SideFrame& side) {
  RayInSlice ray;
  ray.along.v = dot(l, p.to_viewer);
  const V3 t{hn::NegMulAdd(ray.along.v, p.to_viewer.x, l.x),
             hn::NegMulAdd(ray.along.v, p.to_viewer.y, l.y),
             hn::NegMulAdd(ray.along.v, p.to_viewer.z, l.z)};
  ray.along.s = hn::Sqrt(dot(t, t));
  side.t = t * (set(1) / hn::Max(ray.along.s, set(1e-6f)));
  side.n_t = dot(p.normal, side.t);
  side.slope = side.n_t / p.facing;
  side.across = {side.t.x * set(1 / scene.fx), side.t.y * set(-1 / scene.fy)};

  const V depth = set(0) - p.position.z;
  V2 way{set(scene.fx) * l.x, set(-scene.fy) * l.y};
  ray.end_px = set(1e9f);
  if (!scene.orthographic) {
    // The derivative of the projection, times the square of the depth.
    way = {set(scene.fx) * hn::MulAdd(l.x, depth, l.z * p.position.x),
           set(-scene.fy) * hn::MulAdd(l.y, depth, l.z * p.position.y)};
  }
  const V length = hn::Sqrt(dot(way, way));
  if (!scene.orthographic) {
    const M recedes = l.z < set(0);
    ray.end_px = hn::IfThenElse(recedes, length / (depth * hn::Abs(l.z)), ray.end_px);
  }
  const V unit = set(1) / hn::Max(length, set(1e-20f));
  ray.step_x = way.x * unit, ray.step_y = way.y * unit;
  ray.nearing = l.z * unit;
  ray.per_px = unit;
  return ray;
}

/// How far a ray has come after so many pixels of the picture.
template <bool kOrthographic>
HWY_INLINE V way_along(const RayInSlice& ray, const MarchReceiver& p, V pixels) {
  if constexpr (kOrthographic) return pixels * ray.per_px;
  const V depth = set(0) - p.position.z;
  return pixels * depth * depth * ray.per_px / hn::MulAdd(ray.nearing * depth, pixels, set(1));
}

/// The same in the raster of an overview.
HWY_INLINE RayInSlice in_overview_pixels(RayInSlice ray) {
  const V pixels = set(float(Interleaving::kPeriod));
  ray.end_px = ray.end_px / pixels;
  ray.nearing = ray.nearing * pixels, ray.per_px = ray.per_px * pixels;
  return ray;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
