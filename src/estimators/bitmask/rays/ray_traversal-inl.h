// SPDX-License-Identifier: Apache-2.0
//
// The way of a ray over the frame, for a vector of pixels, each with its own direction. No solid as
// large as a pixel is missed: rays visit every pixel that they cross, except in cells
// (bitmask/rays/depth_bounds.h) whose solids all lie behind the ray, in front of it or below the
// receiver's tangent plane. Where a cell may hold a solid in the way, rays visit smaller cells in
// it (hierarchical depth: Greene, Kass and Miller, 1993).
//
// With t the distance in the picture, everything here is linear. e is the height of a point above
// the receiver's tangent plane, measured along the receiver's V and divided by the depth of the
// point (by 1 where the camera is orthographic):
//
//   e = a n + b + b_x dx + b_y dy     of a point of nearness n, (dx, dy) pixels away
//   e = g t                           of the ray, g > 0
//
// A solid is in the way where its front has e >= g t and its back e <= g (t + 1/2). The half is
// that of a pixel: where the ray leaves the pixel, the next one takes over. Near a silhouette a
// solid is less deep than a steep ray comes nearer from one pixel to the next, and the ray would
// pass behind the back in one pixel and in front of the solid in the next.
#if defined(SSDO_BITMASK_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_WALK_INL_H_
#undef SSDO_BITMASK_WALK_INL_H_
#else
#define SSDO_BITMASK_WALK_INL_H_
#endif

#include <algorithm>

#include "estimators/bitmask/rays/beams-inl.h"
#include "estimators/bitmask/rays/ray_in_slice-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Rays on their way over the frame, one in each lane. A ray that has met a solid or has left the
/// frame gives its lane to the next waiting ray: rays differ in length, and lanes that waited for
/// the longest ray of a vector would be idle for half of the time.
template <bool kOrthographic>
class RayTraversal {
 public:
  /// Rays are followed from `from_px` to `until_px`, distances in the picture.
  RayTraversal(const March& march, const std::vector<DepthBounds>& bounds, float from_px = 0,
               float until_px = 1e9f)
      : march_(march), bounds_(bounds), from_px_(from_px), until_px_(until_px) {
    clear();
  }

  /// Forgets all rays.
  HWY_INLINE void clear() { rays_.clear(); }

  /// Takes the rays of a vector of pixels in the lanes of `looks`, `i` by Block::first_of(). The
  /// other lanes meet nothing.
  HWY_INLINE void put(int i, const MarchReceiver& p, const SideFrame& side, const RayInSlice& ray,
                      M looks) {
    if (!any(looks)) return;
    const auto write = [&](RayField which, V value) HWY_ATTR { rays_.set_at(which, i, value); };
    const Interleaving& layout = march_.scene.layout;
    const V right = set(float(layout.width() - 1)), bottom = set(float(layout.height() - 1));
    const V leaves_frame = hn::Min(Axis(ray.step_x).exit(set(0) - p.x, right),
                                   Axis(ray.step_y).exit(set(0) - p.y, bottom));
    const V end = hn::Min(hn::Min(leaves_frame, ray.end_px), set(std::min(p.reach_px, until_px_)));
    // A ray along the view ray stays in its pixel.
    const M moves = hn::Max(hn::Abs(ray.step_x), hn::Abs(ray.step_y)) > set(0.5f);
    const V a = kOrthographic ? set(1) : p.plane;
    const V column = hn::Round(p.x), row = hn::Round(p.y);
    write(RayField::x, column), write(RayField::y, row);
    write(RayField::aside_x, p.x - column), write(RayField::aside_y, p.y - row);
    write(RayField::step_x, ray.step_x), write(RayField::step_y, ray.step_y);
    write(RayField::nearing, ray.nearing);
    write(RayField::a, a), write(RayField::b, kOrthographic ? p.rise + p.plane : p.rise);
    write(RayField::rise_x, p.rise_x), write(RayField::rise_y, p.rise_y);
    write(RayField::growth,
          hn::MulAdd(a, ray.nearing, hn::MulAdd(p.rise_x, ray.step_x, p.rise_y * ray.step_y)));
    write(RayField::across_x, side.across.x), write(RayField::across_y, side.across.y);
    write(RayField::slope, side.slope);
    // The pixel of a receiver does not block its ray.
    const V zero = set(0),
            leaves = hn::Min(Axis(ray.step_x).exit(zero, zero), Axis(ray.step_y).exit(zero, zero));
    write(RayField::from, hn::Max(leaves + set(kPastBorder), set(from_px_)));
    write(RayField::end, hn::IfThenElseZero(hn::And(looks, moves), end));
  }

  /// Follows all rays that have been put. `together`: rays of neighbours have similar directions.
  HWY_INLINE void run(bool together) {
    if (together) shorten_ways(march_.scene, bounds_, rays_);
    const D d;
    const DI di;
    const Interleaving& layout = march_.scene.layout;
    const VI one = set_int(1), left = set_int(bounds_[0].first_x()),
             top = set_int(bounds_[0].first_y()), right = left + set_int(layout.width() - 1),
             bottom = top + set_int(layout.height() - 1);
    RayState w;
    w.place = w.size = w.last_x = w.last_y = set_int(0);
    w.t = w.aside_x = w.aside_y = set(0);
    M looks = set(0) > set(0);
    int next = 0;
    while (true) {
      if (next < Block::kPixels && int(hn::CountTrue(d, looks)) <= kFewBusy)
        looks = fill(w, looks, next);
      if (!any(looks)) return;
      const V at = hn::IfThenElseZero(looks, w.t);
      // Rounding alone could lead beyond the frame.
      const VI at_x = hn::Clamp(w.x + hn::NearestInt(hn::MulAdd(at, w.step_x, w.aside_x)), left,
                                right),
               at_y = hn::Clamp(w.y + hn::NearestInt(hn::MulAdd(at, w.step_y, w.aside_y)), top,
                                bottom);
      // Takes the next larger cells where the ray has entered another cell of that size.
      const VI larger = hn::IfThenElse(w.size == set_int(0), set_int(DepthBounds::kSmallest),
                                       hn::Min(w.size + one, set_int(DepthBounds::kLargest)));
      const auto moved = hn::Or(at_x ^ w.last_x, at_y ^ w.last_y) >> larger;
      w.size = hn::IfThenElse(moved == set_int(0), w.size, larger);
      w.last_x = at_x, w.last_y = at_y;

      const VI column = at_x >> w.size, row = at_y >> w.size;
      const V low_x = hn::ConvertTo(d, (column << w.size) - w.x) - w.aside_x,
              low_y = hn::ConvertTo(d, (row << w.size) - w.y) - w.aside_y,
              extent = hn::ConvertTo(d, (one << w.size) - one);
      const V leaves = hn::Min(w.along_x.exit(low_x, extent), w.along_y.exit(low_y, extent));
      const M pixels = hn::RebindMask(d, w.size == set_int(0));
      const M in_pixel = hn::And(looks, pixels), in_cell = hn::AndNot(pixels, looks);
      M descends = hn::And(in_cell, looks);
      if (any(in_cell)) {
        const V half = set(0.5f) * extent;
        descends = hn::And(
            in_cell, may_meet(w, in_cell, column, row, low_x + half, low_y + half, half, leaves));
      }
      if (any(in_pixel)) {
        const M blocked = is_blocked(w, low_x, low_y, at_x, at_y, in_pixel);
        if (any(blocked)) {
          note_blocked(w, blocked);
          looks = hn::AndNot(blocked, looks);
        }
      }
      const VI smaller = hn::IfThenElseZero(w.size > set_int(DepthBounds::kSmallest), w.size - one);
      w.size = hn::IfThenElse(hn::RebindMask(di, descends), smaller, w.size);
      w.t = hn::IfThenElse(descends, w.t, hn::Max(leaves, w.t) + set(kPastBorder));
      looks = hn::And(looks, w.t < w.end);
    }
  }

  /// The distance in the picture at which each ray is blocked; negative: nothing in the frame
  /// blocks it.
  HWY_INLINE V blocked_px(int i) const { return rays_(RayField::blocked_px, i); }

 private:
  /// How far a ray steps past the border of a cell, in pixels.
  static constexpr float kPastBorder = 0.01f;

  /// At most this many lanes are busy when the others are given new rays.
  static constexpr int kFewBusy = kLanes * 3 / 4;

  /// How far beyond the middle of its pixel a solid ends, in pixels.
  static constexpr float kHalfPixel = 0.5f;

  /// A surface is known only at the middles of pixels, and its tangent plane from the middles of
  /// neighbours. A front less than kBendPx away may be the receiver's surface, bent in between: it
  /// blocks a ray only if it rises above the ray by more than a slope, which falls from kBend at
  /// the receiver to 0 at kBendPx.
  static constexpr float kBend = 0.1f, kBendPx = 8;

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
    /// The t at which the ray leaves cells; `low` is the middle of the first pixel of a cell.
    HWY_INLINE V exit(V low, V extent) const {
      return hn::MulAdd(extent, ahead, low + beside) * per_step;
    }
  };

  /// A ray in each lane.
  struct RayState {
    VI place;            ///< in the block
    VI x, y;             ///< the receiver's pixel in the grid of cells
    V aside_x, aside_y;  ///< from the pixel's middle to the receiver
    V step_x, step_y, a, b, rise_x, rise_y, growth, end;
    Axis along_x, along_y;
    V t;                      ///< how far the ray has come
    VI size, last_x, last_y;  ///< size of the cell that the ray is in; its pixel
  };

  /// Gives idle lanes the rays from `next` on; returns the lanes that are busy then.
  HWY_INLINE M fill(RayState& w, M looks, int& next) const {
    const DI di;
    alignas(64) int busy[kLanes], places[kLanes];
    hn::Store(hn::VecFromMask(di, hn::RebindMask(di, looks)), di, busy);
    hn::Store(w.place, di, places);
    alignas(64) int starts[kLanes] = {};
    const auto looks_for_nothing = [&](int k) {
      const int at = Block::in_squares(k);
      return !(rays_.of(RayField::end, at) > rays_.of(RayField::from, at));
    };
    for (int lane = 0; lane < kLanes; ++lane) {
      if (busy[lane]) continue;
      while (next < Block::kPixels && looks_for_nothing(next)) ++next;
      if (next == Block::kPixels) break;
      starts[lane] = 1, places[lane] = Block::in_squares(next++);
    }
    w.place = hn::Load(di, places);
    const auto int_starts = hn::Load(di, starts) != set_int(0);
    const M fresh = hn::RebindMask(D(), int_starts);
    const auto read = [&](RayField which) HWY_ATTR { return rays_.of(which, w.place); };
    w.aside_x = read(RayField::aside_x), w.aside_y = read(RayField::aside_y);
    w.step_x = read(RayField::step_x), w.step_y = read(RayField::step_y);
    w.a = read(RayField::a), w.b = read(RayField::b);
    w.rise_x = read(RayField::rise_x), w.rise_y = read(RayField::rise_y);
    w.growth = read(RayField::growth), w.end = read(RayField::end);
    w.along_x = Axis(w.step_x), w.along_y = Axis(w.step_y);
    w.x = hn::ConvertTo(di, read(RayField::x)) + set_int(bounds_[0].first_x());
    w.y = hn::ConvertTo(di, read(RayField::y)) + set_int(bounds_[0].first_y());
    w.t = hn::IfThenElse(fresh, read(RayField::from), w.t);
    w.size = hn::IfThenElse(int_starts, set_int(DepthBounds::kSmallest), w.size);
    w.last_x = hn::IfThenElse(int_starts, w.x, w.last_x);
    w.last_y = hn::IfThenElse(int_starts, w.y, w.last_y);
    return hn::Or(looks, fresh);
  }

  HWY_INLINE void note_blocked(const RayState& w, M blocked) {
    const DI di;
    alignas(64) int is_blocked[kLanes], places[kLanes];
    alignas(64) float t[kLanes];
    hn::Store(hn::VecFromMask(di, hn::RebindMask(di, blocked)), di, is_blocked);
    hn::Store(w.place, di, places);
    store(w.t, t);
    for (int lane = 0; lane < kLanes; ++lane)
      if (is_blocked[lane]) rays_.of(RayField::blocked_px, places[lane]) = t[lane];
  }

  /// Whether solids in the cells may block the rays between their present t and `to`. The middles
  /// of the cells are (dx, dy) away, and their outermost pixels `half` from these middles.
  HWY_INLINE M may_meet(const RayState& w, M looks, VI column, VI row, V dx, V dy, V half,
                        V to) const {
    const D d;
    const DI di;
    const VI rows = set_int(bounds_[0].rows());
    const VI halvings = hn::Max(w.size - set_int(DepthBounds::kSmallest), set_int(0));
    const VI first_row = hn::ShiftLeft<1>(rows - (rows >> halvings));
    const VI cell = hn::IfThenElseZero(
        hn::RebindMask(di, looks),
        hn::ShiftLeft<2>((first_row + row) * set_int(bounds_[0].columns()) + column));
    const V way = linear(w, dx, dy),
            lowest = hn::NegMulAdd(half, hn::Abs(w.rise_x) + hn::Abs(w.rise_y), way);
    M meets = hn::AndNot(looks, looks);
    for (const DepthBounds& layer : bounds_) {
      const float* cells = &layer.cells()->nearest;
      const V4 stored = gather4(cells, cell);  // DepthBounds::Stored
      const VI slopes = hn::BitCast(di, stored.y);
      const V slope_x = hn::BitCast(d, hn::And(slopes, set_int(int(0xffff0000u)))),
              slope_y = hn::BitCast(d, hn::ShiftLeft<16>(slopes));
      const V steep_x = hn::MulAdd(w.a, slope_x, w.rise_x),
              steep_y = hn::MulAdd(w.a, slope_y, w.rise_y);
      const V middle = hn::MulAdd(w.a, stored.x, way);
      const V front = hn::MulAdd(half, hn::Abs(steep_x) + hn::Abs(steep_y), middle);
      looks = hn::And(looks, hn::And(front > set(0), front >= w.growth * w.t));
      if (!any(looks)) return meets;  // what lies behind is lower still
      const V back = hn::MulAdd(w.a, stored.z, lowest);
      const M met = hn::And(looks, back <= w.growth * (to + set(kHalfPixel)));
      meets = hn::Or(meets, met);
      looks = hn::AndNot(met, looks);
    }
    return meets;
  }

  /// b + b_x dx + b_y dy
  HWY_INLINE V linear(const RayState& w, V dx, V dy) const {
    return hn::MulAdd(dx, w.rise_x, hn::MulAdd(dy, w.rise_y, w.b));
  }

  /// The lanes of `looks` in which a solid of the ray's pixel blocks the ray. The pixel is (dx, dy)
  /// away from the receiver, and (x, y) from the first pixel of the grid of cells.
  HWY_INLINE M is_blocked(const RayState& w, V dx, V dy, VI x, VI y, M looks) const {
    constexpr int kSmallest = DepthBounds::kSmallest;
    const VI in_cell = set_int((1 << kSmallest) - 1);
    const VI cell =
        hn::ShiftRight<kSmallest>(y) * set_int(bounds_[0].columns()) + hn::ShiftRight<kSmallest>(x);
    const VI pixel = hn::ShiftLeft<2 * kSmallest>(cell) +
                     hn::ShiftLeft<kSmallest>(hn::And(y, in_cell)) + hn::And(x, in_cell);
    // One gather reads the four numbers of two pixels.
    const VI one = set_int(1), index = hn::IfThenElseZero(hn::RebindMask(DI(), looks),
                                                          hn::ShiftLeft<1>(hn::AndNot(one, pixel)));
    const M is_second = hn::RebindMask(D(), hn::And(pixel, one) == one);
    // A pixel counts only if the ray passes nearest to its middle in its row or column: pixels that
    // the ray only touches would widen all solids by a part of a pixel.
    const V aside = hn::Abs(dx * w.step_y - dy * w.step_x);
    looks = hn::And(looks, aside <= set(0.5f) * hn::Max(hn::Abs(w.step_x), hn::Abs(w.step_y)));
    const V t = hn::MulAdd(dx, w.step_x, dy * w.step_y);
    const V way = linear(w, dx, dy), height = w.growth * t,
            clears = hn::MulAdd(t * saturate(hn::NegMulAdd(t, set(1 / kBendPx), set(1))),
                                set(kBend / march_.scene.fx), height);
    M blocked = hn::AndNot(looks, looks);
    for (const DepthBounds& layer : bounds_) {
      if (!any(looks)) return blocked;
      const float* pixels = &layer.pixels()->x;
      const V4 both = gather4(pixels, index);
      const V near = hn::IfThenElse(is_second, both.z, both.x), front = hn::MulAdd(w.a, near, way);
      const M meets = hn::And(looks, hn::And(front > set(0), front >= clears));
      looks = hn::AndNot(front < height, looks);
      if (!any(meets)) continue;
      const V back = hn::MulAdd(w.a, hn::IfThenElse(is_second, both.w, both.y), way);
      const M hides = hn::And(hn::And(meets, back <= hn::MulAdd(w.growth, set(kHalfPixel), height)),
                              within_radius(w, dx, dy, near, front));
      blocked = hn::Or(blocked, hides);
      looks = hn::AndNot(hides, looks);
    }
    return blocked;
  }

  /// Whether fronts of this nearness that are e above the tangent plane are within the radius.
  HWY_INLINE M within_radius(const RayState& w, V dx, V dy, V near, V e) const {
    const float radius = march_.radius;
    if (radius > kInfiniteLength) return e == e;
    const V2 across{rays_.of(RayField::across_x, w.place), rays_.of(RayField::across_y, w.place)};
    const V slope = rays_.of(RayField::slope, w.place);
    const V scale = kOrthographic ? set(1) : set(1) / near;
    const V above = e * scale, s = dot(V2{dx, dy}, across) * scale;
    const SlicePoint front{s, hn::NegMulAdd(s, slope, above)};
    return dot(front, front) <= set(radius * radius);
  }

  const March& march_;
  const std::vector<DepthBounds>& bounds_;  ///< by layer
  const float from_px_, until_px_;
  RaysOfBlock rays_;
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
