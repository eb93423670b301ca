// SPDX-License-Identifier: Apache-2.0
//
// The pieces of surface that the pixels of a march stand for; see bitmask.cpp.
//
// Steps grow with the distance, so that a march sees few pixels of what is far. Taken for points
// they lose half a step at the upper edge of all that rises, and what is thinner than a step: over
// seven frames ao came out 0.023 too open at 24 steps. So each pixel stands for its stretch of the
// way, over which its surface goes on as its tangent plane. On a plane this is exact, and over an
// edge, or something thin, right on average, as where steps fall differs from pixel to pixel.
#if defined(SSDO_BITMASK_PIECE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_PIECE_INL_H_
#undef SSDO_BITMASK_PIECE_INL_H_
#else
#define SSDO_BITMASK_PIECE_INL_H_
#endif

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
HWY_INLINE void end_at(const Receiver& p, const SideFrame& side, V share, V depth, V rise, V across,
                       V& s, V& v) {
  s = across * share;
  if constexpr (!kOrthographic) s = s * depth;
  const V end_rise = hn::MulAdd(share, rise - p.rise, p.rise);
  v = hn::NegMulAdd(s, side.slope, height_above<kOrthographic>(p, end_rise, depth));
}

/// Most that depth grows or shrinks, as a factor, from a pixel to the ends of its piece: a piece of
/// a plane that is seen edge-on, or meets the horizon within the step, ends before.
constexpr float kMostDeepening = 2;

/// The piece that the pixel at `i` stands for. `rise` and `across` are those of its middle.
template <bool kOrthographic>
HWY_INLINE Piece piece_at(const MarchScene& scene, const Receiver& p, const SideFrame& side,
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
    end_at<kOrthographic>(p, side, share, end_depth, rise, across, s, v);
  };
  Piece piece;
  end(step.inner, true, piece.inner_s, piece.inner_v);
  end(step.outer, false, piece.outer_s, piece.outer_v);
  return piece;
}

/// The piece of a front of unknown slope at this depth: it faces the viewer.
template <bool kOrthographic>
HWY_INLINE Piece piece_facing_viewer(const Receiver& p, const SideFrame& side,
                                     const SliceStep& step, V depth, V rise, V across) {
  const D d;
  const V inner = hn::Set(d, step.inner), outer = hn::Set(d, step.outer);
  Piece piece;
  end_at<kOrthographic>(p, side, inner, depth, rise, across, piece.inner_s, piece.inner_v);
  end_at<kOrthographic>(p, side, outer, depth, rise, across, piece.outer_s, piece.outer_v);
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
HWY_INLINE VU sectors_behind_piece(const Receiver& p, const SideFrame& side, Piece piece, V s,
                                   V above, V depth, float radius) {
  const D d;
  M meets = above > hn::Zero(d);
  if (radius < 1e18f) meets = hn::And(meets, clip(piece, radius));
  const auto sector = [&](V x, V y) HWY_ATTR { return sector_of(y, dot2(x, y, x, y), side.start); };
  const VU inner = sector(piece.inner_s, piece.inner_v),
           outer = sector(piece.outer_s, piece.outer_v);
  const SlicePoint back = back_of<kOrthographic>(p, s, hn::NegMulAdd(s, side.slope, above), depth);
  const VU from = hn::Min(inner, outer),
           to = hn::Max(hn::Max(inner, outer), sector(back.s, back.v));
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(to), bits_from(from)));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
