// SPDX-License-Identifier: Apache-2.0
//
// What lies beyond a raster that is a part of the frame, for a vector of pixels: an overview of the
// frame (OverviewScene). Slices read its planes by rows; rays, and surfaces that go on beyond the
// border, read its own raster.
#if defined(SSDO_BITMASK_OVERVIEW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_OVERVIEW_INL_H_
#undef SSDO_BITMASK_OVERVIEW_INL_H_
#else
#define SSDO_BITMASK_OVERVIEW_INL_H_
#endif

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Pixels of a picture.
struct OverviewPixels {
  VI x, y;
};

/// The pixels with these numbers, row by row.
HWY_INLINE OverviewPixels pixels_of(VI number, int width) {
  const DI di;
  const VI wide = set_int(width), one = set_int(1);
  VI y = hn::ConvertTo(di, hn::ConvertTo(D(), number) * set(1 / float(width)));
  // Rounding may have led to the row above or below.
  y = hn::IfThenElse(number < y * wide, y - one, y);
  y = hn::IfThenElse(number < (y + one) * wide, y, y + one);
  return {number - y * wide, y};
}

HWY_INLINE VI index_of(const Interleaving& layout, const OverviewPixels& at) {
  const VI x = at.x + set_int(layout.phase());
  return (hn::ShiftLeft<Interleaving::kShift>(at.y) +
          hn::And(x, set_int(Interleaving::kPeriod - 1))) *
             set_int(int(layout.stride())) +
         hn::ShiftRight<Interleaving::kShift>(x) + set_int(Interleaving::kPad);
}
HWY_INLINE VI index_of(const OverviewRaster& far, const OverviewPixels& at) {
  return at.y * set_int(int(far.layout.stride())) + at.x + set_int(Interleaving::kPad);
}

/// Where the samples of a vector of receivers are: the planes, and the place in them of a step of
/// (0, 0).
struct Sampled {
  const MarchPlanes& planes;
  int row, rows, column, columns;
  std::ptrdiff_t index;
};

HWY_INLINE Sampled in_raster(const March& march, const Place& place) {
  const Interleaving& layout = march.scene.layout;
  return {march.scene, place.y, layout.height(), place.column, layout.columns(), place.index};
}

HWY_INLINE Sampled in_overview(const March& march, const Place& place) {
  const MarchScene& scene = march.scene;
  const OverviewRaster& far = march.far->raster;
  const int row = ((place.y + scene.first_y) >> Interleaving::kShift) - far.first_y,
            column = (scene.first_x >> Interleaving::kShift) + place.column - far.first_x;
  return {march.far->planes, row, far.height, column, far.width, far.index(column, row)};
}

/// A march over the raster of an overview in place of its own.
inline March march_in_overview(const March& march) {
  March far{march.far->scene, march.pattern, march.radius, march.extend};
  if (march.cut) far.cut = &march.far->cut;
  return far;
}

/// A receiver, and a side of a slice, in the pixels of the overview.
HWY_INLINE MarchReceiver in_overview_pixels(const March& march, MarchReceiver p) {
  const MarchScene &scene = march.scene, &far = march.far->scene;
  constexpr float kSide = Interleaving::kPeriod;
  const auto place = [&](V x, int first, int far_first) HWY_ATTR {
    return (x + set(float(first) - kSide / 2)) * set(1 / kSide) - set(float(far_first));
  };
  p.x = place(p.x, scene.first_x, far.first_x), p.y = place(p.y, scene.first_y, far.first_y);
  p.rise_x = p.rise_x * set(kSide), p.rise_y = p.rise_y * set(kSide);
  p.reach_px /= kSide, p.own_reach_px = p.own_reach_px * set(1 / kSide);
  return p;
}
HWY_INLINE SideFrame in_overview_pixels(SideFrame side) {
  const V pixels = set(float(Interleaving::kPeriod));
  side.across = {side.across.x * pixels, side.across.y * pixels};
  return side;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
