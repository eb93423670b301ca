// SPDX-License-Identifier: Apache-2.0
//
// Surfaces that are assumed to continue beyond the border of the frame, for a vector of pixels; see
// bitmask.cpp.
#if defined(SSDO_BITMASK_EXTENSION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_EXTENSION_INL_H_
#undef SSDO_BITMASK_EXTENSION_INL_H_
#else
#define SSDO_BITMASK_EXTENSION_INL_H_
#endif

#include <cmath>

#include "estimators/bitmask/solid_sectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Which borders of the frame marches go to.
struct MarchTowards {
  M right, bottom;  ///< else the left one, and the top one
};

/// Where the marches of the lanes leave the frame.
struct Border {
  V dx, dy;  ///< pixels from the receiver to the last pixel inside
  V distance_px;
  bool in_one_row;  ///< all lanes leave through the first row, or all through the last
  /// In one row: index of lane 0 in BorderValues; the others follow.
  std::ptrdiff_t first = 0;
  VI index;  ///< otherwise: index of each lane in BorderValues
  MarchTowards to;
  M in_side;  ///< of the first or last column

  HWY_INLINE V operator()(const BorderValues& values) const {
    return in_one_row ? load(values.data() + first) : gather(values.data(), index);
  }
};

/// Indices in BorderValues of pixels in the first or last column (`in_side`), or row.
HWY_INLINE VI border_index(const MarchScene& scene, V x, V y, M in_side, const MarchTowards& to) {
  const DI di;
  const Interleaving& layout = scene.layout;
  const VI shifted = hn::ConvertTo(di, x) + set_int(layout.phase());
  const auto offset = [&](M later, std::ptrdiff_t first, std::ptrdiff_t second) HWY_ATTR {
    return hn::IfThenElse(hn::RebindMask(di, later), set_int(int(second)), set_int(int(first)));
  };
  const VI in_row =
      hn::And(shifted, set_int(Interleaving::kPeriod - 1)) * set_int(int(layout.stride())) +
      hn::ShiftRight<Interleaving::kShift>(shifted) +
      offset(to.bottom, scene.border.in_row(false, 0, 0), scene.border.in_row(true, 0, 0));
  const VI in_column = hn::ConvertTo(di, y) + offset(to.right, scene.border.in_column(false, 0),
                                                     scene.border.in_column(true, 0));
  return hn::IfThenElse(hn::RebindMask(di, in_side), in_column, in_row);
}

/// Where marches along (dx, dy), a unit vector in pixels, leave the frame. `shared`: all lanes have
/// the same direction. Else the result may be moved by `aside_px`, a whole number, along the
/// border.
HWY_INLINE Border border_along(const MarchScene& scene, const MarchReceiver& p, V dx, V dy,
                               bool shared, float aside_px = 0) {
  const Interleaving& layout = scene.layout;
  constexpr int kPeriod = Interleaving::kPeriod;
  const int w = layout.width(), h = layout.height();
  const V zero = set(0), right = set(float(w - 1)), bottom = set(float(h - 1)), tiny = set(1e-5f);
  const M rightwards = dx > zero, downwards = dy > zero;
  const V to_side = hn::IfThenElse(rightwards, right - p.x, p.x) / hn::Max(hn::Abs(dx), tiny),
          to_end = hn::IfThenElse(downwards, bottom - p.y, p.y) / hn::Max(hn::Abs(dy), tiny);
  const M through_side = to_side < to_end;
  const V aside = hn::Round(to_end * dx);
  Border border;
  border.to = {rightwards, downwards};
  border.in_side = through_side;
  border.distance_px = hn::Min(to_side, to_end);
  border.in_one_row = shared && !any(hn::And(through_side, p.valid));
  if (border.in_one_row) {
    const int column_of_lane_0 = p.place.column_phase + int(hn::GetLane(aside));
    border.dx = aside;
    border.dy = hn::IfThenElse(downwards, bottom, zero) - p.y;
    border.first = scene.border.in_row(hn::GetLane(dy) > 0, column_of_lane_0 & (kPeriod - 1),
                                       p.place.column + (column_of_lane_0 >> Interleaving::kShift));
    return border;
  }
  const V beside = set(aside_px);
  const V edge_x = hn::IfThenElse(through_side, hn::IfThenElse(rightwards, right, zero),
                                  hn::Clamp(hn::Round(p.x + aside) + beside, zero, right)),
          edge_y = hn::IfThenElse(
              through_side,
              hn::Clamp(hn::Round(p.y + hn::Round(to_side * dy)) + beside, zero, bottom),
              hn::IfThenElse(downwards, bottom, zero));
  border.dx = edge_x - p.x, border.dy = edge_y - p.y;
  border.index = border_index(scene, edge_x, edge_y, through_side, border.to);
  return border;
}

/// How far a surface continues beyond the frame, in diagonals of the frame at its depth (the same
/// for a camera rolled by 90 degrees). Mean over four scenes of Cycles with 0.75, 1.5 and 3: RMSE
/// of ao without a radius 0.149, 0.136 and 0.135, relative error of direct light 0.460, 0.418 and
/// 0.423, of bounce light 0.447, 0.427 and 0.434.
constexpr float kExtension = 1.5f;

/// The piece of a surface in a slice that lies beyond the frame, from the border to its end.
struct Extension {
  SlicePoint start, end;  ///< at the border, and beyond it
  V above;                ///< height of the start over the receiver's tangent plane
  V distance2;            ///< to the border
  V depth;                ///< from front to back at the border
  M in_reach;             ///< whether the border is in reach of the lane
  M exists;               ///< whether the start is within the radius
};

/// Extends the surface at the border along its tangent plane, within the radius.
template <bool kOrthographic>
HWY_INLINE Extension extend(const March& march, const MarchReceiver& p, const SideFrame& side,
                            const Border& border) {
  const MarchScene& scene = march.scene;
  const V depth = border(scene.border_depth);
  const V rise = hn::MulAdd(border.dx, p.rise_x, hn::MulAdd(border.dy, p.rise_y, p.rise));
  Extension e;
  e.above = height_above<kOrthographic>(p, rise, depth);
  V s = dot(V2{border.dx, border.dy}, side.across);
  if constexpr (!kOrthographic) s = s * depth;
  e.start = {s, hn::NegMulAdd(s, side.slope, e.above)};
  e.distance2 = dot(e.start, e.start);
  const V radius2 = set(march.radius * march.radius);
  e.in_reach = border.distance_px <= p.own_reach_px;
  e.exists = hn::And(e.distance2 < radius2, e.in_reach);
  if (!any(e.in_reach)) return e;

  // The line where the tangent plane intersects the slice, pointing away from the frame.
  const V3 m{border(scene.border_normal[0]), border(scene.border_normal[1]),
             border(scene.border_normal[2])};
  SlicePoint line{dot(m, p.to_viewer), set(0) - dot(m, side.t)};
  const V scale = reciprocal_sqrt(dot(line, line));
  line = {line.s * scale, line.v * scale};
  const V frame = set(kExtension * std::hypot(float(scene.frame_width) / scene.fx,
                                              float(scene.frame_height) / scene.fy));
  V length = kOrthographic ? frame : frame * depth;
  const V thickness = border(scene.border_thickness);
  if (!scene.border_beyond.empty()) length = hn::Min(length, border(scene.border_beyond));
  e.depth = thickness;
  if constexpr (!kOrthographic) {
    const V3 ray{hn::MulAdd(border.dx, set(1 / scene.fx), p.slope_x),
                 hn::NegMulAdd(border.dy, set(1 / scene.fy), p.slope_y), set(1)};
    const V share = thickness / depth * reciprocal_sqrt(dot(ray, ray));
    e.depth = hn::Min(share, set(kInfiniteThicknessRatio));
  }
  if (march.radius < kInfiniteLength) {
    const V foot = dot(e.start, line);
    length = hn::Min(length, hn::Sqrt(hn::MulAdd(foot, foot, radius2 - e.distance2)) - foot);
  }
  e.end = along(e.start, length, line);
  return e;
}

/// The sectors hidden by the extension, and by the solid of the last pixel inside the frame.
template <bool kOrthographic>
HWY_INLINE VU extend_side(const March& march, const MarchReceiver& p, const SideFrame& side,
                          const Border& border) {
  const DU du;
  const Extension e = extend<kOrthographic>(march, p, side, border);
  if (!any(e.in_reach)) return set_bits(0);
  const VU here = sector_of(e.start.v, e.distance2, side.start);
  const VU leans_across = hn::VecFromMask(du, hn::RebindMask(du, e.end.s < set(0)));
  const VU there = hn::AndNot(leans_across, sector_of(e.end, side.start));
  const VU beyond = hn::IfThenElseZero(
      hn::RebindMask(du, e.exists),
      hn::AndNot(bits_from(hn::Max(here, there)), bits_from(hn::Min(here, there))));
  // The pixel at the border is sampled as well: the last step of the march may be far from it.
  const VU at_border =
      sectors_behind<kOrthographic>(p, side, e.start.s, e.above, e.depth, march.radius);
  return hn::Or(beyond, hn::IfThenElseZero(hn::RebindMask(du, e.in_reach), at_border));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
