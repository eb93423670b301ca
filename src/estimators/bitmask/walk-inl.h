// SPDX-License-Identifier: Apache-2.0
//
// The way of a ray over the frame, for a vector of pixels, each with a direction of its own. No
// solid of a pixel or more is missed: rays visit every pixel that they cross, but for those of
// cells (bitmask/depth_bounds.h) whose solids all lie behind the ray, in front of it or below the
// receiver's tangent plane. Where a cell may hold something in the way they look at smaller ones
// (hierarchical depth: Greene, Kass and Miller, 1993).
//
// With t the distance in the picture, everything here is linear. e is the height above the
// receiver's tangent plane, measured along the view ray of the place and divided by its depth (by 1
// where the camera is orthographic):
//
//   e = a n + b + b_x dx + b_y dy     of a point of nearness n, (dx, dy) pixels away
//   e = g t                           of the ray, g > 0
//
// A solid is in the way where its front has e >= g t and its back e <= g t.
#if defined(SSDO_BITMASK_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_WALK_INL_H_
#undef SSDO_BITMASK_WALK_INL_H_
#else
#define SSDO_BITMASK_WALK_INL_H_
#endif

#include "estimators/bitmask/depth_bounds.h"
#include "estimators/bitmask/lanes-inl.h"

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

/// The frame from the receivers, and what is in the way of their rays.
template <bool kOrthographic>
class Walk {
 public:
  HWY_INLINE Walk(const March& march, const std::vector<DepthBounds>& bounds,
                  const MarchReceiver& p, const SideFrame& side, const RayInSlice& ray)
      : march_(march), bounds_(bounds), p_(p), side_(side), ray_(ray) {
    const DI di;
    const Interleaving& layout = march.scene.layout;
    a_ = kOrthographic ? set(1) : p.plane;
    b_ = kOrthographic ? p.rise + p.plane : p.rise;
    growth_ = hn::MulAdd(a_, ray.nearing, hn::MulAdd(p.rise_x, ray.step_x, p.rise_y * ray.step_y));
    x_ = hn::ConvertTo(di, p.x), y_ = hn::ConvertTo(di, p.y);
    along_x_ = Axis(ray.step_x), along_y_ = Axis(ray.step_y);
    const V right = set(float(layout.width() - 1)), bottom = set(float(layout.height() - 1));
    const V leaves_frame =
        hn::Min(along_x_.exit(set(0) - p.x, right), along_y_.exit(set(0) - p.y, bottom));
    end_ = hn::Min(hn::Min(leaves_frame, ray.end_px), set(p.reach_px));
  }

  /// Which lanes of `open` see past what the frame shows. `blocked_px` becomes the distance in the
  /// picture of what is in the way of the others.
  HWY_INLINE M run(M open, V& blocked_px) const {
    const D d;
    const DI di;
    const VI zero = set_int(0), one = set_int(1);
    const VI grid_x = x_ + set_int(bounds_[0].first_x()),
             grid_y = y_ + set_int(bounds_[0].first_y());
    const VI left = zero - x_, right = set_int(march_.scene.layout.width() - 1) - x_,
             top = zero - y_, bottom = set_int(march_.scene.layout.height() - 1) - y_;
    // A ray along the view ray stays in its pixel.
    const M moves = hn::Max(hn::Abs(ray_.step_x), hn::Abs(ray_.step_y)) > set(0.5f);
    M looks = hn::And(open, moves);
    V t = set(0);
    VI size = zero, last_x = grid_x, last_y = grid_y;
    while (true) {
      looks = hn::And(looks, t < end_);
      if (!any(looks)) return open;
      // Beyond the frame only by rounding.
      const V place = hn::IfThenElseZero(looks, t);
      const VI dx = hn::Clamp(hn::NearestInt(place * ray_.step_x), left, right),
               dy = hn::Clamp(hn::NearestInt(place * ray_.step_y), top, bottom);
      const VI at_x = grid_x + dx, at_y = grid_y + dy;
      // To larger cells where the ray has come into another of them.
      const VI larger = hn::IfThenElse(size == zero, set_int(DepthBounds::kSmallest),
                                       hn::Min(size + one, set_int(DepthBounds::kLargest)));
      const auto moved = hn::Or(at_x ^ last_x, at_y ^ last_y) >> larger;
      size = hn::IfThenElse(moved == zero, size, larger);
      last_x = at_x, last_y = at_y;

      const VI column = at_x >> size, row = at_y >> size;
      const V low_x = hn::ConvertTo(d, (column << size) - grid_x),
              low_y = hn::ConvertTo(d, (row << size) - grid_y),
              extent = hn::ConvertTo(d, (one << size) - one);
      const V leaves = hn::Min(along_x_.exit(low_x, extent), along_y_.exit(low_y, extent));
      const M pixels = hn::RebindMask(d, size == zero);
      const M in_pixel = hn::And(looks, pixels), in_cell = hn::AndNot(pixels, looks);
      M descends = hn::And(in_cell, looks);
      if (any(in_cell)) {
        const V half = set(0.5f) * extent;
        descends = hn::And(in_cell, may_meet(in_cell, size, column, row, low_x + half, low_y + half,
                                             half, t, leaves));
      }
      if (any(in_pixel)) {
        const M blocked = is_blocked(low_x, low_y, at_x, at_y, in_pixel);
        blocked_px = hn::IfThenElse(blocked, t, blocked_px);
        open = hn::AndNot(blocked, open);
        looks = hn::AndNot(blocked, looks);
      }
      const VI smaller = hn::IfThenElseZero(size > set_int(DepthBounds::kSmallest), size - one);
      size = hn::IfThenElse(hn::RebindMask(di, descends), smaller, size);
      t = hn::IfThenElse(descends, t, hn::Max(leaves, t) + set(kPastBorder));
    }
  }

 private:
  /// Past the border of a cell, in pixels.
  static constexpr float kPastBorder = 0.01f;

  /// The way along an axis of the picture.
  struct Axis {
    V per_step, ahead, beside;

    Axis() = default;
    HWY_INLINE explicit Axis(V step) {
      const M stands = hn::Abs(step) < set(1e-9f);
      per_step = set(1) / hn::IfThenElse(stands, set(1e-9f), step);
      ahead = hn::IfThenElseZero(per_step > set(0), set(1));
      beside = ahead - set(0.5f);
    }
    /// Where the ray leaves cells, as t; `low` is the middle of their first pixel.
    HWY_INLINE V exit(V low, V extent) const {
      return hn::MulAdd(extent, ahead, low + beside) * per_step;
    }
  };

  /// Whether something of the cells may be in the way between `from` and `to`. Their middles are
  /// (dx, dy) away and their outermost pixels `half` from those.
  HWY_INLINE M may_meet(M looks, VI size, VI column, VI row, V dx, V dy, V half, V from,
                        V to) const {
    const D d;
    const DI di;
    const VI rows = set_int(bounds_[0].rows());
    const VI halvings = hn::Max(size - set_int(DepthBounds::kSmallest), set_int(0));
    const VI first_row = hn::ShiftLeft<1>(rows - (rows >> halvings));
    const VI cell = hn::IfThenElseZero(
        hn::RebindMask(di, looks),
        hn::ShiftLeft<2>((first_row + row) * set_int(bounds_[0].columns()) + column));
    const V way = linear(dx, dy),
            lowest = hn::NegMulAdd(half, hn::Abs(p_.rise_x) + hn::Abs(p_.rise_y), way);
    M meets = hn::AndNot(looks, looks);
    for (const DepthBounds& layer : bounds_) {
      const float* cells = &layer.cells()->nearest;
      const V nearest = gather(cells, cell);
      const VI slopes = hn::BitCast(di, gather(cells + 1, cell));
      const V slope_x = hn::BitCast(d, hn::And(slopes, set_int(int(0xffff0000u)))),
              slope_y = hn::BitCast(d, hn::ShiftLeft<16>(slopes));
      const V steep_x = hn::MulAdd(a_, slope_x, p_.rise_x),
              steep_y = hn::MulAdd(a_, slope_y, p_.rise_y);
      const V middle = hn::MulAdd(a_, nearest, way);
      const V front = hn::MulAdd(half, hn::Abs(steep_x) + hn::Abs(steep_y), middle);
      looks = hn::And(looks, hn::And(front > set(0), front >= growth_ * from));
      if (!any(looks)) return meets;  // what lies behind is lower still
      const V back = hn::MulAdd(a_, gather(cells + 2, cell), lowest);
      meets = hn::Or(meets, hn::And(looks, back <= growth_ * to));
    }
    return meets;
  }

  /// b + b_x dx + b_y dy
  HWY_INLINE V linear(V dx, V dy) const {
    return hn::MulAdd(dx, p_.rise_x, hn::MulAdd(dy, p_.rise_y, b_));
  }

  /// Which lanes of `looks` have a solid of their pixel in the way between `from` and `to`. The
  /// pixel is (dx, dy) away, and (x, y) in the grid of cells.
  HWY_INLINE M is_blocked(V dx, V dy, VI x, VI y, M looks) const {
    constexpr int kSmallest = DepthBounds::kSmallest;
    const VI in_cell = set_int((1 << kSmallest) - 1);
    const VI cell =
        hn::ShiftRight<kSmallest>(y) * set_int(bounds_[0].columns()) + hn::ShiftRight<kSmallest>(x);
    const VI pixel = hn::ShiftLeft<2 * kSmallest>(cell) +
                     hn::ShiftLeft<kSmallest>(hn::And(y, in_cell)) + hn::And(x, in_cell);
    const VI index = hn::IfThenElseZero(hn::RebindMask(DI(), looks), hn::ShiftLeft<1>(pixel));
    // A pixel stands for its row or column of the ray if that passes nearest to its middle; those
    // that it only touches would widen everything by a part of a pixel.
    const V aside = hn::Abs(dx * ray_.step_y - dy * ray_.step_x);
    looks =
        hn::And(looks, aside <= set(0.5f) * hn::Max(hn::Abs(ray_.step_x), hn::Abs(ray_.step_y)));
    const V t = hn::MulAdd(dx, ray_.step_x, dy * ray_.step_y);
    const V way = linear(dx, dy), height = growth_ * t;
    M blocked = hn::AndNot(looks, looks);
    if (!any(looks)) return blocked;
    for (const DepthBounds& layer : bounds_) {
      const float* pixels = &layer.pixels()->x;
      const V near = gather(pixels, index), front = hn::MulAdd(a_, near, way);
      const M meets = hn::And(looks, hn::And(front > set(0), front >= height));
      if (!any(meets)) continue;
      const V back = hn::MulAdd(a_, gather(pixels + 1, index), way);
      const M hides = hn::And(hn::And(meets, back <= height), within_radius(dx, dy, near, front));
      blocked = hn::Or(blocked, hides);
    }
    return blocked;
  }

  /// Whether fronts of this nearness that are e above the tangent plane are within the radius.
  HWY_INLINE M within_radius(V dx, V dy, V near, V e) const {
    const float radius = march_.radius;
    if (radius > 1e18f) return e == e;
    const V scale = kOrthographic ? set(1) : set(1) / near;
    const V above = e * scale, s = dot(V2{dx, dy}, side_.across) * scale;
    const SlicePoint front{s, hn::NegMulAdd(s, side_.slope, above)};
    return dot(front, front) <= set(radius * radius);
  }

  const March& march_;
  const std::vector<DepthBounds>& bounds_;  ///< by layer
  const MarchReceiver& p_;
  const SideFrame& side_;
  const RayInSlice& ray_;
  V a_, b_, growth_;
  V end_;     ///< t where the ray leaves the frame, or the radius
  VI x_, y_;  ///< of the receivers
  Axis along_x_, along_y_;
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
