// SPDX-License-Identifier: Apache-2.0
//
// Where the rays of small squares of pixels may meet something: the ways before and behind are
// ruled out by bounds for all sixteen rays at once, and most rays that meet nothing end here
// (Boulos, Wald and Shirley 2006, Geometric and Arithmetic Culling Methods for Entire Ray Packets).
// Compiled once for every instruction set.
//
// After t pixels, a ray that began at x_i with the nearness r_i is at x_i + t s_i and has the
// nearness r_i + t q_i, and a front is in its way only if it is as near (ray_traversal-inl.h). For
// the rays of a square, all of these lie between bounds that are linear in t. Nearness is relative
// to the mean tangent plane of the square, so that a plane is no nearer than the rays that leave
// it, however flat they are.
#if defined(SSDO_BITMASK_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_BEAMS_INL_H_
#undef SSDO_BITMASK_BEAMS_INL_H_
#else
#define SSDO_BITMASK_BEAMS_INL_H_
#endif

#include <limits>

#include "estimators/bitmask/rays/depth_bounds.h"
#include "estimators/bitmask/rays/rays_of_block-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The interval in which a number of some rays lies, in each lane.
struct Between {
  V least, most;

  /// The empty interval. Written out, so that it is compiled for the instruction set of its
  /// callers.
  HWY_INLINE Between()
      : least(set(std::numeric_limits<float>::infinity())),
        most(set(-std::numeric_limits<float>::infinity())) {}

  HWY_INLINE void add(M counts, V value) {
    least = hn::Min(least, hn::IfThenElse(counts, value, least));
    most = hn::Max(most, hn::IfThenElse(counts, value, most));
  }
  /// Sets the other lanes to 0.
  HWY_INLINE void keep_where(M counts) {
    least = hn::IfThenElseZero(counts, least), most = hn::IfThenElseZero(counts, most);
  }
};

/// The rays of a square of Block::kRows pixels in each lane.
class Beams {
 public:
  /// The squares of the vectors of pixels from column phase `first` on.
  HWY_INLINE Beams(const RaysOfBlock& rays, int first) {
    V count = set(0), sum_x = count, sum_y = count;
    Between slopes_x, slopes_y;
    for_each(first, [&](int i) HWY_ATTR {
      const M goes = goes_on(rays, i);
      const V inverse = set(-1) / rays(RayField::a, i),
              slope_x = rays(RayField::rise_x, i) * inverse,
              slope_y = rays(RayField::rise_y, i) * inverse;
      count = count + hn::IfThenElseZero(goes, set(1));
      sum_x = sum_x + hn::IfThenElseZero(goes, slope_x);
      sum_y = sum_y + hn::IfThenElseZero(goes, slope_y);
      slopes_x.add(goes, slope_x), slopes_y.add(goes, slope_y);
      x_.add(goes, rays(RayField::x, i) + rays(RayField::aside_x, i));
      y_.add(goes, rays(RayField::y, i) + rays(RayField::aside_y, i));
      step_x_.add(goes, rays(RayField::step_x, i));
      step_y_.add(goes, rays(RayField::step_y, i));
      from_ = hn::Min(from_, hn::IfThenElse(goes, rays(RayField::from, i), from_));
      end_ = hn::Max(end_, hn::IfThenElseZero(goes, rays(RayField::end, i)));
    });
    // Lanes without rays: nothing infinite.
    const M looks = count > set(0);
    for (Between* sum : {&slopes_x, &slopes_y, &x_, &y_, &step_x_, &step_y_})
      sum->keep_where(looks);
    from_ = hn::IfThenElseZero(looks, from_);
    const V share = set(1) / hn::Max(count, set(1));
    slope_x_ = sum_x * share, slope_y_ = sum_y * share;
    V largest = set(0);
    for_each(first, [&](int i) HWY_ATTR {
      const M goes = goes_on(rays, i);
      const V nearness = hn::Neg(rays(RayField::b, i)) / rays(RayField::a, i),
              x = rays(RayField::x, i) + rays(RayField::aside_x, i) - x_.least,
              y = rays(RayField::y, i) + rays(RayField::aside_y, i) - y_.least;
      above_.add(goes, nearness - hn::MulAdd(x, slope_x_, y * slope_y_));
      rising_.add(goes,
                  rays(RayField::nearing, i) - hn::MulAdd(rays(RayField::step_x, i), slope_x_,
                                                          rays(RayField::step_y, i) * slope_y_));
      largest = hn::Max(largest, hn::IfThenElseZero(goes, hn::Abs(nearness)));
    });
    above_.keep_where(looks), rising_.keep_where(looks);
    // A ray visits pixels up to half a pixel beside it, and measures heights over its own tangent
    // plane.
    const V apart = hn::Max(slopes_x.most - slope_x_, slope_x_ - slopes_x.least) +
                    hn::Max(slopes_y.most - slope_y_, slope_y_ - slopes_y.least);
    const V off = hn::MulAdd(set(kBesideRay), apart, largest * set(kRounding));
    above_.least = above_.least - off, above_.most = above_.most + off;
  }

  /// The t between which rays may meet something; `least` exceeds `most` if none meets anything.
  HWY_INLINE Between find_in_the_way(const MarchScene& scene,
                                     const std::vector<DepthBounds>& bounds) const {
    Between found;
    V t = from_, step = set(kFirstStep);
    M busy = end_ > from_, first = busy;
    while (any(busy)) {
      const V to = hn::Min(t + step, end_);
      const M clear = is_clear(scene, bounds, t, to);
      // Until something is met, steps are halved to find where it begins.
      const M refines = hn::AndNot(clear, hn::And(first, step > set(kLeastStep)));
      const M meets = hn::AndNot(hn::Or(clear, refines), busy);
      found.add(meets, t), found.add(meets, to);
      first = hn::AndNot(meets, first);
      t = hn::IfThenElse(refines, t, to);
      step = hn::IfThenElse(refines, step * set(0.5f), hn::Min(step * set(2), set(kMostStep)));
      busy = hn::And(busy, t < end_);
    }
    return found;
  }

  /// Calls `work(i)` for the vectors of pixels of the squares, by Block::first_of().
  template <class Work>
  static HWY_INLINE void for_each(int first, const Work& work) {
    for (int row = 0; row < Block::kRows; ++row) {
      for (int phase = first; phase < first + Block::kRows; ++phase)
        work((row * Interleaving::kPeriod + phase) * kLanes);
    }
  }

 private:
  static constexpr float kFirstStep = 2, kLeastStep = 4, kMostStep = 128;

  /// The largest distance, in pixels, between a ray and the middle of a pixel that it visits, with
  /// the step of a walk past the border of a cell.
  static constexpr float kBesideRay = 0.52f;

  /// The largest rounding error of a nearness, relative to it.
  static constexpr float kRounding = 2e-6f;

  static HWY_INLINE M goes_on(const RaysOfBlock& rays, int i) {
    return rays(RayField::end, i) > rays(RayField::from, i);
  }

  /// The interval of a coordinate between two t.
  static HWY_INLINE Between place(const Between& start, const Between& step, V t, V to) {
    Between at;
    at.least = start.least + hn::Min(t * step.least, to * step.least) - set(kBesideRay);
    at.most = start.most + hn::Max(t * step.most, to * step.most) + set(kBesideRay);
    return at;
  }

  /// Whether, between two t, all rays pass in front of the solids near their way, or behind them.
  HWY_INLINE M is_clear(const MarchScene& scene, const std::vector<DepthBounds>& bounds, V t,
                        V to) const {
    const D d;
    const DI di;
    const V zero = set(0), half = set(0.5f);
    const auto inside = [&](Between at, int size) HWY_ATTR {
      const V last = set(float(size - 1));
      at.least = hn::Clamp(at.least, zero, last), at.most = hn::Clamp(at.most, zero, last);
      return at;
    };
    const Between x = inside(place(x_, step_x_, t, to), scene.layout.width()),
                  y = inside(place(y_, step_y_, t, to), scene.layout.height());
    // Cells about as large as the box, so that it touches at most two in a row and in a column.
    const V extent = hn::Max(x.most - x.least, y.most - y.least) + set(1);
    const VI needed = hn::ShiftRight<23>(hn::BitCast(di, extent)) - set_int(126),
             size =
                 hn::Clamp(needed, set_int(DepthBounds::kSmallest), set_int(DepthBounds::kLargest));
    M clear = hn::RebindMask(d, needed < set_int(DepthBounds::kLargest + 1));
    const DepthBounds& grid = bounds.front();  // as of all layers
    const VI first_x = set_int(grid.first_x()), first_y = set_int(grid.first_y()),
             columns[2] = {(hn::ConvertTo(di, x.least) + first_x) >> size,
                           (hn::ConvertTo(di, x.most) + first_x) >> size},
             rows[2] = {(hn::ConvertTo(di, y.least) + first_y) >> size,
                        (hn::ConvertTo(di, y.most) + first_y) >> size};
    const VI all_rows = set_int(grid.rows()),
             first_row = hn::ShiftLeft<1>(all_rows -
                                          (all_rows >> (size - set_int(DepthBounds::kSmallest))));
    const V last = hn::ConvertTo(d, (set_int(1) << size) - set_int(1));
    // A linear function is least at one of the two t and largest at the other. Solids end half a
    // pixel beyond the middle of theirs.
    const V least = above_.least + hn::Min(t * rising_.least, to * rising_.least),
            most = above_.most + hn::Max(t * rising_.most, (to + half) * rising_.most);
    for (const VI row : rows) {
      const V top = hn::ConvertTo(d, (row << size) - first_y), y0 = hn::Max(y.least, top),
              y1 = hn::Min(y.most, top + last), middle_y = half * (y0 + y1),
              half_y = hn::Max(half * (y1 - y0), zero);
      for (const VI column : columns) {
        const V left = hn::ConvertTo(d, (column << size) - first_x), x0 = hn::Max(x.least, left),
                x1 = hn::Min(x.most, left + last), middle_x = half * (x0 + x1),
                half_x = hn::Max(half * (x1 - x0), zero);
        const VI cell = hn::ShiftLeft<2>((first_row + row) * set_int(grid.columns()) + column);
        const V plane = hn::MulAdd(slope_x_, middle_x - x_.least, slope_y_ * (middle_y - y_.least));
        const V lowest =
            hn::NegMulAdd(half_x, hn::Abs(slope_x_), plane) - half_y * hn::Abs(slope_y_);
        const V highest = plane + (plane - lowest);
        M undecided = clear;
        for (const DepthBounds& layer : bounds) {
          const float* cells = &layer.cells()->nearest;
          const V4 stored = gather4(cells, cell);  // DepthBounds::Stored
          const VI slopes = hn::BitCast(di, stored.y);
          const V slope_x = hn::BitCast(d, hn::And(slopes, set_int(int(0xffff0000u)))),
                  slope_y = hn::BitCast(d, hn::ShiftLeft<16>(slopes));
          const V steep =
              hn::MulAdd(half_x, hn::Abs(slope_x - slope_x_), half_y * hn::Abs(slope_y - slope_y_));
          const V front = stored.x - plane +
                          hn::MulAdd(slope_x, middle_x - left - half * last,
                                     slope_y * (middle_y - top - half * last));
          undecided = hn::And(undecided, front + steep >= least);
          if (!any(undecided)) break;  // what lies behind is lower still
          const M behind = stored.z - highest > most;
          clear = hn::AndNot(hn::AndNot(behind, undecided), clear);
          undecided = hn::And(undecided, behind);
        }
      }
    }
    return clear;
  }

  Between x_, y_, step_x_, step_y_;  ///< where they begin, and how they go on over the picture
  V from_ = set(std::numeric_limits<float>::infinity()), end_ = set(0);  ///< between which t
  V slope_x_, slope_y_;     ///< of the mean tangent plane, per pixel
  Between above_, rising_;  ///< the nearness less that of this plane, and per pixel
};

/// Shortens the ways of all rays of a block to the part between the first and the last thing that
/// they may meet.
HWY_INLINE void shorten_ways(const MarchScene& scene, const std::vector<DepthBounds>& bounds,
                             RaysOfBlock& rays) {
  for (int first = 0; first < Interleaving::kPeriod; first += Block::kRows) {
    const Between found = Beams(rays, first).find_in_the_way(scene, bounds);
    Beams::for_each(first, [&](int i) HWY_ATTR {
      rays.set_at(RayField::from, i, hn::Max(found.least, rays(RayField::from, i)));
      rays.set_at(RayField::end, i, hn::Min(found.most, rays(RayField::end, i)));
    });
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
