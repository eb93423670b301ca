// SPDX-License-Identifier: Apache-2.0
//
// One side of a slice, marched over the frame by a vector of pixels; see bitmask.cpp.
//
// Steps grow with the distance, so that a march sees few pixels of what is far. Taken for points
// they lose half a step at the upper edge of all that rises, and what is thinner than a step: over
// seven frames ao came out 0.023 too open at 24 steps. So each pixel stands for its stretch of the
// way, over which its surface goes on as its tangent plane. On a plane this is exact, and over an
// edge, or something thin, right on average, as where steps fall differs from pixel to pixel.
#if defined(SSDO_BITMASK_SIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_SIDE_INL_H_
#undef SSDO_BITMASK_SIDE_INL_H_
#else
#define SSDO_BITMASK_SIDE_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A straight piece of surface in a slice.
struct Piece {
  V inner_s, inner_v, outer_s, outer_v;
};

/// Where a piece ends: a share of the way to its pixel, at this depth. `rise` and `across` are
/// those of the pixel.
template <bool kOrthographic>
HWY_INLINE void end_at(const Receiver& p, const Half& half, V share, V depth, V rise, V across,
                       V& s, V& v) {
  s = across * share;
  if constexpr (!kOrthographic) s = s * depth;
  const V end_rise = hn::MulAdd(share, rise - p.rise, p.rise);
  v = hn::NegMulAdd(s, half.slope, height_above<kOrthographic>(p, end_rise, depth));
}

/// Most that depth grows or shrinks, as a factor, from a pixel to the ends of its piece: a piece of
/// a plane that is seen edge-on, or meets the horizon within the step, ends before.
constexpr float kMostDeepening = 2;

/// The piece that the pixel at `i` stands for. `rise` and `across` are those of its middle.
template <bool kOrthographic>
HWY_INLINE Piece piece_at(const MarchScene& scene, const Receiver& p, const Half& half,
                          const SliceStep& step, std::ptrdiff_t i, V depth, V rise, V across) {
  const D d;
  const auto load = [&](const InterleavedPlane& plane)
                        HWY_ATTR { return hn::LoadU(d, plane.data() + i); };
  const V mx = load(scene.nx), my = load(scene.ny), mz = load(scene.nz);
  const V ex = hn::Set(d, step.dx / scene.fx), ey = hn::Set(d, -step.dy / scene.fy);
  // M.r, r the ray through the pixel, and how much it changes over the way there.
  const V one = hn::Set(d, 1.0f);
  V m_ray = hn::Zero(d) - mz;
  if constexpr (!kOrthographic)
    m_ray = hn::MulAdd(mx, p.slope_x + ex, hn::MulAdd(my, p.slope_y + ey, m_ray));
  m_ray = hn::Min(m_ray, hn::Set(d, -1e-9f));
  const V m_way = dot2(mx, my, ex, ey);
  const auto end = [&](float of_way, bool inner, V& s, V& v) HWY_ATTR {
    V share = hn::Set(d, of_way), end_depth;
    if constexpr (kOrthographic) {
      // Depth has no scale here: it changes by no more than the way is long.
      const V limit = hn::Abs(across), change = (one - share) * m_way / m_ray;
      const V limited = hn::Clamp(change, hn::Zero(d) - limit, limit);
      share = hn::IfThenElse(limited != change, one - limited * m_ray / m_way, share);
      end_depth = depth + limited;
    } else {
      V end_ray = hn::MulAdd(share - one, m_way, m_ray);
      const V limited = hn::Clamp(end_ray, hn::Set(d, kMostDeepening) * m_ray,
                                  hn::Set(d, 1 / kMostDeepening) * m_ray);
      const M beyond = limited != end_ray;
      if (!hn::AllFalse(d, beyond)) {
        share = hn::IfThenElse(beyond, one + (limited - m_ray) / m_way, share);
        end_ray = limited;
      }
      end_depth = depth * m_ray / end_ray;
    }
    // Where a round thing turns away, its tangent plane would come far before it.
    if (inner) end_depth = hn::Max(end_depth, depth);
    end_at<kOrthographic>(p, half, share, end_depth, rise, across, s, v);
  };
  Piece piece;
  end(step.inner, true, piece.inner_s, piece.inner_v);
  end(step.outer, false, piece.outer_s, piece.outer_v);
  return piece;
}

/// The piece of what is covered at this depth. Its slope is unknown: it faces the viewer.
template <bool kOrthographic>
HWY_INLINE Piece covered_piece(const Receiver& p, const Half& half, const SliceStep& step, V depth,
                               V rise, V across) {
  const D d;
  const V inner = hn::Set(d, step.inner), outer = hn::Set(d, step.outer);
  Piece piece;
  end_at<kOrthographic>(p, half, inner, depth, rise, across, piece.inner_s, piece.inner_v);
  end_at<kOrthographic>(p, half, outer, depth, rise, across, piece.outer_s, piece.outer_v);
  return piece;
}

/// Leaves what lies within the radius. Gives where that is anything.
HWY_INLINE M clip(Piece& piece, float radius) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V s = piece.inner_s, v = piece.inner_v, ls = piece.outer_s - s, lv = piece.outer_v - v;
  const V per_length = one / hn::Sqrt(hn::Max(dot2(ls, lv, ls, lv), hn::Set(d, 1e-30f)));
  const V us = ls * per_length, uv = lv * per_length;
  // The line comes as near to the receiver as `nearest`, at its `foot`, and is within the radius
  // for half a chord to both sides.
  const V nearest = hn::MulSub(s, uv, v * us), foot = zero - dot2(s, v, us, uv),
          half_chord2 = hn::NegMulAdd(nearest, nearest, hn::Set(d, radius * radius));
  const V half_chord = hn::Sqrt(hn::Max(half_chord2, zero));
  const V from = hn::Max(zero, (foot - half_chord) * per_length),
          to = hn::Min(one, (foot + half_chord) * per_length);
  piece.inner_s = hn::MulAdd(from, ls, s), piece.inner_v = hn::MulAdd(from, lv, v);
  piece.outer_s = hn::MulAdd(to, ls, s), piece.outer_v = hn::MulAdd(to, lv, v);
  return hn::And(half_chord2 > zero, from < to);
}

/// The sectors that a piece hides whose middle lies at s, `above` the receiver's tangent plane, and
/// reaches back by `depth`.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind_piece(const Receiver& p, const Half& half, Piece piece, V s, V above,
                                   V depth, float radius, V start) {
  const D d;
  M meets = above > hn::Zero(d);
  if (radius < 1e18f) meets = hn::And(meets, clip(piece, radius));
  const auto sector = [&](V x, V y) HWY_ATTR { return sector_of(y, dot2(x, y, x, y), start); };
  const VU inner = sector(piece.inner_s, piece.inner_v),
           outer = sector(piece.outer_s, piece.outer_v);
  const SlicePoint back = back_of<kOrthographic>(p, s, hn::NegMulAdd(s, half.slope, above), depth);
  const VU from = hn::Min(inner, outer),
           to = hn::Max(hn::Max(inner, outer), sector(back.s, back.v));
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(to), bits_from(from)));
}

/// Marches from near to far and gives the sectors that stay open. `seen` and `covered` hear of
/// samples of what is seen and of what it covers: their index, how far in pixels they lie from the
/// receiver, and the sectors in which they are the first.
template <bool kOrthographic, class Seen, class Covered>
HWY_INLINE VU march_side(const March& march, const Receiver& p, const Half& half,
                         const SliceSide& side, std::ptrdiff_t at, int y, int column, float reach,
                         const Seen& seen, const Covered& covered) {
  const D d;
  const MarchScene& scene = march.scene;
  const V zero = hn::Zero(d), start = start_of_sectors(side.phase);
  const int height = scene.layout.height(), columns = scene.layout.columns();
  const int lanes = int(hn::Lanes(d));
  VU open = half.above;
  for (const SliceStep& step : side.steps) {
    const int row = y + step.row, first = column + step.column_shift;
    if (step.inner_px > reach || row < 0 || row >= height || first >= columns || first + lanes <= 0)
      break;
    const std::ptrdiff_t i = at + step.offset;
    const auto load = [&](const InterleavedPlane& plane)
                          HWY_ATTR { return hn::LoadU(d, plane.data() + i); };
    // The next vector of receivers looks at the pixels beside these. There are too many such
    // streams for the processor to see.
    hwy::Prefetch(scene.depth.data() + i + 2 * lanes - 1);
    hwy::Prefetch(scene.behind.data() + i + 2 * lanes - 1);
    hwy::Prefetch(scene.thickness.data() + i + 2 * lanes - 1);
    hwy::Prefetch(scene.nx.data() + i + 2 * lanes - 1);
    hwy::Prefetch(scene.ny.data() + i + 2 * lanes - 1);
    hwy::Prefetch(scene.nz.data() + i + 2 * lanes - 1);
    const V dx = hn::Set(d, step.dx), dy = hn::Set(d, step.dy);
    const V rise = hn::MulAdd(dx, p.rise_x, hn::MulAdd(dy, p.rise_y, p.rise));
    const V depth = load(scene.depth), behind = load(scene.behind);
    const V above = height_above<kOrthographic>(p, rise, depth),
            above_behind = height_above<kOrthographic>(p, rise, behind);
    const M rises_behind = above_behind > zero;
    if (hn::AllFalse(d, hn::Or(above > zero, rises_behind))) continue;
    const V across = dot2(dx, dy, half.across_x, half.across_y);
    const auto sectors = [&](V of_depth, V of_above, V thickness, const auto& piece) HWY_ATTR {
      const V s = kOrthographic ? across : of_depth * across;
      return step.inner == step.outer
                 ? sectors_behind<kOrthographic>(p, half, s, of_above, thickness, march.radius,
                                                 start)
                 : sectors_behind_piece<kOrthographic>(p, half, piece(), s, of_above, thickness,
                                                       march.radius, start);
    };
    const VU bits = sectors(depth, above, load(scene.thickness), [&]() HWY_ATTR {
      return piece_at<kOrthographic>(scene, p, half, step, i, depth, rise, across);
    });
    seen(i, step, hn::And(open, bits));
    open = hn::AndNot(bits, open);
    if (!hn::AllFalse(d, rises_behind)) {
      const VU bits_behind =
          sectors(behind, above_behind, load(scene.behind_thickness), [&]() HWY_ATTR {
            return covered_piece<kOrthographic>(p, half, step, behind, rise, across);
          });
      covered(i, step, hn::And(open, bits_behind));
      open = hn::AndNot(bits_behind, open);
    }
  }
  return open;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
