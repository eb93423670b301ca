// SPDX-License-Identifier: Apache-2.0
//
// The way of a ray over the frame, for a vector of pixels, each with a direction of its own. No
// solid of a pixel or more is missed: rays visit every pixel that they cross, but for those of
// cells (bitmask/rays/depth_bounds.h) whose solids all lie behind the ray, in front of it or below
// the receiver's tangent plane. Where a cell may hold something in the way they look at smaller
// ones (hierarchical depth: Greene, Kass and Miller, 1993).
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

#include <hwy/aligned_allocator.h>

#include <algorithm>

#include "estimators/bitmask/rays/depth_bounds.h"
#include "estimators/bitmask/rays/ray_in_slice-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Rays on their way over the frame, one in each lane. A ray that has met something or has left the
/// frame gives its lane to the next that waits: rays differ in length, and lanes that wait for the
/// longest of a vector would be idle for half of the time.
template <bool kOrthographic>
class Walk {
 public:
  /// Room for `most` rays, which go from one distance in the picture to another.
  Walk(const March& march, const std::vector<DepthBounds>& bounds, int most, float from_px = 0,
       float until_px = 1e9f)
      : march_(march),
        bounds_(bounds),
        most_(most),
        from_px_(from_px),
        until_px_(until_px),
        numbers_(hwy::AllocateAligned<float>(std::size_t(kStride * most))) {
    clear();
  }

  /// Forgets all rays.
  HWY_INLINE void clear() {
    for (int place = 0; place < most_; ++place) number(place, kEnd) = 0;
  }

  /// Takes the lanes of `looks`, into places 0 to `most` - 1 of the queue. Rays that are close to
  /// each other there should be so in the picture too: they visit the same cells. The other lanes
  /// meet nothing.
  HWY_INLINE void put(VI places, const MarchReceiver& p, const SideFrame& side,
                      const RayInSlice& ray, M looks) {
    const VI at = places * set_int(kStride);
    const auto write = [&](Number which, V value)
                           HWY_ATTR { hn::ScatterIndex(value, D(), numbers_.get() + which, at); };
    write(kBlockedPx, set(-1));
    if (!any(looks)) return;
    const Interleaving& layout = march_.scene.layout;
    const V right = set(float(layout.width() - 1)), bottom = set(float(layout.height() - 1));
    const V leaves_frame = hn::Min(Axis(ray.step_x).exit(set(0) - p.x, right),
                                   Axis(ray.step_y).exit(set(0) - p.y, bottom));
    const V end = hn::Min(hn::Min(leaves_frame, ray.end_px), set(std::min(p.reach_px, until_px_)));
    // A ray along the view ray stays in its pixel.
    const M moves = hn::Max(hn::Abs(ray.step_x), hn::Abs(ray.step_y)) > set(0.5f);
    const V a = kOrthographic ? set(1) : p.plane;
    const V column = hn::Round(p.x), row = hn::Round(p.y);
    write(kX, column), write(kY, row);
    write(kAsideX, p.x - column), write(kAsideY, p.y - row);
    write(kStepX, ray.step_x), write(kStepY, ray.step_y);
    write(kA, a), write(kB, kOrthographic ? p.rise + p.plane : p.rise);
    write(kRiseX, p.rise_x), write(kRiseY, p.rise_y);
    write(kGrowth,
          hn::MulAdd(a, ray.nearing, hn::MulAdd(p.rise_x, ray.step_x, p.rise_y * ray.step_y)));
    write(kAcrossX, side.across.x), write(kAcrossY, side.across.y), write(kSlope, side.slope);
    const M has_way = hn::And(hn::And(looks, moves), end > set(from_px_));
    write(kEnd, hn::IfThenElseZero(has_way, end));
  }

  /// Sends all rays that have been put.
  HWY_INLINE void run() {
    const D d;
    const DI di;
    const Interleaving& layout = march_.scene.layout;
    const VI one = set_int(1), left = set_int(bounds_[0].first_x()),
             top = set_int(bounds_[0].first_y()), right = left + set_int(layout.width() - 1),
             bottom = top + set_int(layout.height() - 1);
    Way w;
    w.place = w.size = w.last_x = w.last_y = set_int(0);
    w.t = w.aside_x = w.aside_y = set(0);
    M looks = set(0) > set(0);
    int next = 0;
    while (true) {
      if (next < most_ && int(hn::CountTrue(d, looks)) <= kFewBusy) looks = fill(w, looks, next);
      if (!any(looks)) return;
      const V at = hn::IfThenElseZero(looks, w.t);
      // Beyond the frame only by rounding.
      const VI at_x = hn::Clamp(w.x + hn::NearestInt(hn::MulAdd(at, w.step_x, w.aside_x)), left,
                                right),
               at_y = hn::Clamp(w.y + hn::NearestInt(hn::MulAdd(at, w.step_y, w.aside_y)), top,
                                bottom);
      // To larger cells where the ray has come into another of them.
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

  /// The distance in the picture of what is in the way of rays; negative: they see past what the
  /// frame shows.
  HWY_INLINE V blocked_px(VI places) const { return numbers(places, kBlockedPx); }

 private:
  /// Past the border of a cell, in pixels.
  static constexpr float kPastBorder = 0.01f;

  /// With so few lanes busy it pays to fill the others.
  static constexpr int kFewBusy = kLanes * 3 / 4;

  /// What is known of each ray.
  enum Number {
    kX,
    kY,  ///< the receiver's pixel
    kAsideX,
    kAsideY,  ///< from its middle to the receiver
    kStepX,
    kStepY,
    kA,
    kB,
    kRiseX,
    kRiseY,
    kGrowth,
    kAcrossX,
    kAcrossY,
    kSlope,
    kEnd,  ///< t where the ray leaves the frame, or the radius
    kBlockedPx,
    kNumbers,
    kStride = 16  ///< those of a ray are in one line of the cache
  };
  static_assert(kNumbers <= kStride);

  float& number(int place, Number which) const {
    return numbers_[std::size_t(place * kStride + which)];
  }
  HWY_INLINE V numbers(VI places, Number which) const {
    return gather(numbers_.get() + which, places * set_int(kStride));
  }

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

  /// A ray in each lane.
  struct Way {
    VI place;            ///< in the queue
    VI x, y;             ///< the receiver's pixel in the grid of cells
    V aside_x, aside_y;  ///< from its middle to the receiver
    V step_x, step_y, a, b, rise_x, rise_y, growth, end;
    Axis along_x, along_y;
    V t;                      ///< how far it has come
    VI size, last_x, last_y;  ///< of the cell that it has come to, and the pixel
  };

  /// Gives idle lanes the rays from `next` on; returns the lanes that are busy then.
  HWY_INLINE M fill(Way& w, M looks, int& next) const {
    const DI di;
    alignas(64) int busy[kLanes], places[kLanes];
    hn::Store(hn::VecFromMask(di, hn::RebindMask(di, looks)), di, busy);
    hn::Store(w.place, di, places);
    alignas(64) int starts[kLanes] = {};
    for (int lane = 0; lane < kLanes; ++lane) {
      if (busy[lane]) continue;
      while (next < most_ && !(number(next, kEnd) > 0)) ++next;
      if (next == most_) break;
      starts[lane] = 1, places[lane] = next++;
    }
    w.place = hn::Load(di, places);
    const auto int_starts = hn::Load(di, starts) != set_int(0);
    const M fresh = hn::RebindMask(D(), int_starts);
    const auto read = [&](Number which) HWY_ATTR { return numbers(w.place, which); };
    w.aside_x = read(kAsideX), w.aside_y = read(kAsideY);
    w.step_x = read(kStepX), w.step_y = read(kStepY);
    w.a = read(kA), w.b = read(kB);
    w.rise_x = read(kRiseX), w.rise_y = read(kRiseY);
    w.growth = read(kGrowth), w.end = read(kEnd);
    w.along_x = Axis(w.step_x), w.along_y = Axis(w.step_y);
    w.x = hn::ConvertTo(di, read(kX)) + set_int(bounds_[0].first_x());
    w.y = hn::ConvertTo(di, read(kY)) + set_int(bounds_[0].first_y());
    // Their own pixels are not in the way.
    const V zero = set(0), leaves = hn::Min(w.along_x.exit(zero, zero), w.along_y.exit(zero, zero));
    w.t = hn::IfThenElse(fresh, hn::Max(leaves + set(kPastBorder), set(from_px_)), w.t);
    w.size = hn::IfThenElse(int_starts, set_int(DepthBounds::kSmallest), w.size);
    w.last_x = hn::IfThenElse(int_starts, w.x, w.last_x);
    w.last_y = hn::IfThenElse(int_starts, w.y, w.last_y);
    return hn::Or(looks, fresh);
  }

  HWY_INLINE void note_blocked(const Way& w, M blocked) const {
    const DI di;
    alignas(64) int is_blocked[kLanes], places[kLanes];
    alignas(64) float t[kLanes];
    hn::Store(hn::VecFromMask(di, hn::RebindMask(di, blocked)), di, is_blocked);
    hn::Store(w.place, di, places);
    store(w.t, t);
    for (int lane = 0; lane < kLanes; ++lane)
      if (is_blocked[lane]) number(places[lane], kBlockedPx) = t[lane];
  }

  /// Whether something of the cells may be in the way from where rays are to `to`. The middles of
  /// cells are (dx, dy) away and their outermost pixels `half` from those.
  HWY_INLINE M may_meet(const Way& w, M looks, VI column, VI row, V dx, V dy, V half, V to) const {
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
      const V nearest = gather(cells, cell);
      const VI slopes = hn::BitCast(di, gather(cells + 1, cell));
      const V slope_x = hn::BitCast(d, hn::And(slopes, set_int(int(0xffff0000u)))),
              slope_y = hn::BitCast(d, hn::ShiftLeft<16>(slopes));
      const V steep_x = hn::MulAdd(w.a, slope_x, w.rise_x),
              steep_y = hn::MulAdd(w.a, slope_y, w.rise_y);
      const V middle = hn::MulAdd(w.a, nearest, way);
      const V front = hn::MulAdd(half, hn::Abs(steep_x) + hn::Abs(steep_y), middle);
      looks = hn::And(looks, hn::And(front > set(0), front >= w.growth * w.t));
      if (!any(looks)) return meets;  // what lies behind is lower still
      const V back = hn::MulAdd(w.a, gather(cells + 2, cell), lowest);
      const M met = hn::And(looks, back <= w.growth * to);
      meets = hn::Or(meets, met);
      looks = hn::AndNot(met, looks);
    }
    return meets;
  }

  /// b + b_x dx + b_y dy
  HWY_INLINE V linear(const Way& w, V dx, V dy) const {
    return hn::MulAdd(dx, w.rise_x, hn::MulAdd(dy, w.rise_y, w.b));
  }

  /// Which lanes of `looks` have a solid of their pixel in the way. The pixel is (dx, dy) away, and
  /// (x, y) in the grid of cells.
  HWY_INLINE M is_blocked(const Way& w, V dx, V dy, VI x, VI y, M looks) const {
    constexpr int kSmallest = DepthBounds::kSmallest;
    const VI in_cell = set_int((1 << kSmallest) - 1);
    const VI cell =
        hn::ShiftRight<kSmallest>(y) * set_int(bounds_[0].columns()) + hn::ShiftRight<kSmallest>(x);
    const VI pixel = hn::ShiftLeft<2 * kSmallest>(cell) +
                     hn::ShiftLeft<kSmallest>(hn::And(y, in_cell)) + hn::And(x, in_cell);
    const VI index = hn::IfThenElseZero(hn::RebindMask(DI(), looks), hn::ShiftLeft<1>(pixel));
    // A pixel stands for its row or column of the ray if that passes nearest to its middle; those
    // that it only touches would widen everything by a part of a pixel.
    const V aside = hn::Abs(dx * w.step_y - dy * w.step_x);
    looks = hn::And(looks, aside <= set(0.5f) * hn::Max(hn::Abs(w.step_x), hn::Abs(w.step_y)));
    const V t = hn::MulAdd(dx, w.step_x, dy * w.step_y);
    const V way = linear(w, dx, dy), height = w.growth * t;
    M blocked = hn::AndNot(looks, looks);
    for (const DepthBounds& layer : bounds_) {
      if (!any(looks)) return blocked;
      const float* pixels = &layer.pixels()->x;
      const V near = gather(pixels, index), front = hn::MulAdd(w.a, near, way);
      const M meets = hn::And(looks, hn::And(front > set(0), front >= height));
      looks = hn::AndNot(front < height, looks);
      if (!any(meets)) continue;
      const V back = hn::MulAdd(w.a, gather(pixels + 1, index), way);
      const M hides =
          hn::And(hn::And(meets, back <= height), within_radius(w, dx, dy, near, front));
      blocked = hn::Or(blocked, hides);
      looks = hn::AndNot(hides, looks);
    }
    return blocked;
  }

  /// Whether fronts of this nearness that are e above the tangent plane are within the radius.
  HWY_INLINE M within_radius(const Way& w, V dx, V dy, V near, V e) const {
    const float radius = march_.radius;
    if (radius > kEndless) return e == e;
    const V2 across{numbers(w.place, kAcrossX), numbers(w.place, kAcrossY)};
    const V slope = numbers(w.place, kSlope);
    const V scale = kOrthographic ? set(1) : set(1) / near;
    const V above = e * scale, s = dot(V2{dx, dy}, across) * scale;
    const SlicePoint front{s, hn::NegMulAdd(s, slope, above)};
    return dot(front, front) <= set(radius * radius);
  }

  const March& march_;
  const std::vector<DepthBounds>& bounds_;  ///< by layer
  const int most_;
  const float from_px_, until_px_;
  hwy::AlignedFreeUniquePtr<float[]> numbers_;  ///< those of all rays, one Number after another
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
