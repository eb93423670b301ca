// SPDX-License-Identifier: Apache-2.0
//
// From a coarse scale to the next finer one, as in Unity's package, which has it from Microsoft's
// MiniEngine.
//
// First a blur of five pixels along rows, then along columns, (a/2 + b + c + d + e/2) / 4. Inverse
// depth is linear on a plane, so that three pixels lie on one where the slopes d1, d2 between
// them agree:
//
//   (d1 d2 + s)^2 > t (d1^2 + s) (d2^2 + s),
//
// the squared cosine between (sqrt s, d1) and (sqrt s, d2). Where they do not, the neighbour's
// value gives way to the one before it.
//
// Then each fine pixel takes the four coarse pixels around it with their bilinear weights 9 : 3 : 3
// : 1 over the difference in depth,
//
//   w_i = b_i / (|Z - Z_i| / far + e),   open = fine (sum w_i open_i + n) / (sum w_i + n).
//
// n draws towards open where no coarse pixel is near in depth.
//
// Inverse depths and tolerances are in units of a far plane, which a picture does not have: it is
// a parameter here. Values are kept as floats, where the source has 8 bits.
#include "estimators/msvo/scales.h"

#include <algorithm>

#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/msvo/scales.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_COARSE_ROWS_
#define SSDO_COARSE_ROWS_
namespace ssdo {

/// A coarse row and its neighbour on the side of a fine one.
struct CoarseRows {
  const float *near_open, *far_open, *near_depth, *far_depth;
};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Whether three pixels with differences `d1`, `d2` of inverse depth between them lie on a plane.
HWY_INLINE M is_straight(const Upsampling& how, V d1, V d2) {
  const V s = set(how.step), both = hn::MulAdd(d1, d2, s);
  return both * both > hn::MulAdd(d1, d1, s) * hn::MulAdd(d2, d2, s) * set(how.blur_tolerance);
}

/// The blurred value of the middle one of five pixels, from their values and depths.
HWY_INLINE V blur(const Upsampling& how, const V (&open)[5], const V (&depth)[5]) {
  V inverse[5], slope[4];
  for (int i = 0; i < 5; ++i) inverse[i] = set(1 / how.inverse_far) / depth[i];
  for (int i = 0; i < 4; ++i) slope[i] = inverse[i + 1] - inverse[i];
  const M before = is_straight(how, slope[0], slope[1]),
          across = is_straight(how, slope[1], slope[2]),
          after = is_straight(how, slope[2], slope[3]);
  const V c = open[2], b = hn::IfThenElse(hn::Or(before, across), open[1], c),
          a = hn::IfThenElse(before, open[0], b),
          d = hn::IfThenElse(hn::Or(after, across), open[3], c),
          e = hn::IfThenElse(after, open[4], d);
  return hn::MulAdd(a + e, set(0.5f), b + c + d) * set(0.25f);
}

/// Row y from the column before the first to the one after the last.
void blur_along_row(const DepthScale& scale, const Upsampling& how, int y, float* to) {
  const float *open = scale.open.row(y), *depth = scale.depth.row(y);
  for (int x = -1; x <= scale.width; x += kLanes) {
    V values[5], depths[5];
    for (int i = 0; i < 5; ++i) {
      values[i] = load(open + x + i - 2);
      depths[i] = load(depth + x + i - 2);
    }
    store(blur(how, values, depths), to + x);
  }
}

/// Row y, which may be the one before the first or after the last, of what is blurred along rows.
void blur_along_columns(const DepthScale& scale, const PaddedPlane& rows, const Upsampling& how,
                        int y, float* to) {
  for (int x = -1; x <= scale.width; x += kLanes) {
    V values[5], depths[5];
    for (int i = 0; i < 5; ++i) {
      values[i] = load(scale.row(rows, y + i - 2) + x);
      depths[i] = load(scale.row(scale.depth, y + i - 2) + x);
    }
    store(blur(how, values, depths), to + x);
  }
}

/// The share of light that the four coarse pixels around fine ones at `depth` leave: those in
/// column x and, beside it, in column x + side.
HWY_INLINE V bilateral(const CoarseRows& rows, const Upsampling& how, V depth, int x, int side) {
  V weight_sum = set(how.noise), sum = weight_sum;
  const auto add = [&](const float* open, const float* coarse, float bilinear) HWY_ATTR {
    const V difference = hn::Abs(depth - load(coarse));
    const V weight =
        set(bilinear) / hn::MulAdd(difference, set(how.inverse_far), set(how.depth_tolerance));
    weight_sum = weight_sum + weight;
    sum = hn::MulAdd(weight, load(open), sum);
  };
  add(rows.near_open + x, rows.near_depth + x, 9);
  add(rows.near_open + x + side, rows.near_depth + x + side, 3);
  add(rows.far_open + x, rows.far_depth + x, 3);
  add(rows.far_open + x + side, rows.far_depth + x + side, 1);
  return sum / weight_sum;
}

/// A fine row, the first pixel of which is the right one in its coarse pixel where `odd` is 1.
void upsample_row(const CoarseRows& rows, const Upsampling& how, bool multiply, int coarse_width,
                  int odd, const float* depth, float* open) {
  const D d;
  const auto opened = [&](V fine_depth, V fine, int x, int side) HWY_ATTR {
    const V value = fine * bilateral(rows, how, fine_depth, x, side);
    return hn::IfThenElse(shows_surface(hn::Neg(fine_depth)), saturate(value), set(1));
  };
  for (int x = 0; x < coarse_width; x += kLanes) {
    // The left fine pixel of a coarse one looks to the left, the right one to the right.
    const int fine = 2 * x - odd;
    V left_depth, right_depth, left = set(1), right = set(1);
    hn::LoadInterleaved2(d, depth + fine, left_depth, right_depth);
    if (multiply) hn::LoadInterleaved2(d, open + fine, left, right);
    left = opened(left_depth, left, x, -1);
    right = opened(right_depth, right, x, 1);
    hn::StoreInterleaved2(left, right, d, open + fine);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(blur_along_row);
HWY_EXPORT(blur_along_columns);
HWY_EXPORT(upsample_row);

DepthScale::DepthScale(int w, int h, int x, int y)
    : width(w),
      height(h),
      left(x),
      top(y),
      depth(layout(width, height)),
      open(layout(width, height)) {}

void DepthScale::repeat_ends(PaddedPlane& plane, int y) const {
  float* row = plane.row(y);
  std::fill(row - kRepeats, row, row[0]);
  std::fill(row + width, row - PaddedLayout::kPad + layout(width, height).stride, row[width - 1]);
}

std::vector<DepthScale> make_depth_scales(const ViewPlanes& planes, int coarsest) {
  // Only the lowest bits matter: where the display window's corner is in its pixel of each scale.
  const int period = 2 << coarsest, left = planes.first_column & (period - 1),
            top = planes.first_row & (period - 1);
  std::vector<DepthScale> scales;
  for (int k = 0; k <= coarsest; ++k) {
    const int x0 = left >> k, y0 = top >> k;
    DepthScale& scale = scales.emplace_back(((left + planes.width() - 1) >> k) - x0 + 1,
                                            ((top + planes.height() - 1) >> k) - y0 + 1, x0, y0);
    for_each_row(scale.height, [&](int y) {
      const float* z = planes.z.row(std::max(((y0 + y) << k) - top, 0));
      float* depth = scale.depth.row(y);
      for (int x = 0; x < scale.width; ++x) depth[x] = -z[std::max(((x0 + x) << k) - left, 0)];
      scale.repeat_ends(scale.depth, y);
    });
  }
  return scales;
}

void upsample(const DepthScale& coarse, const Upsampling& how, bool multiply, DepthScale& fine) {
  // One row more on both sides, as fine pixels of the border look beyond it.
  PaddedPlane rows(DepthScale::layout(coarse.width, coarse.height)),
      blurred(DepthScale::layout(coarse.width, coarse.height + 2));
  for_each_row(coarse.height, [&](int y) {
    HWY_DYNAMIC_DISPATCH(blur_along_row)(coarse, how, y, rows.row(y));
  });
  for_each_row(coarse.height + 2, [&](int y) {
    HWY_DYNAMIC_DISPATCH(blur_along_columns)(coarse, rows, how, y - 1, blurred.row(y));
  });
  for_each_row(fine.height, [&](int y) {
    const int absolute = fine.top + y, near = (absolute >> 1) - coarse.top,
              far = absolute & 1 ? near + 1 : near - 1;
    HWY_DYNAMIC_DISPATCH(upsample_row)
    ({blurred.row(near + 1), blurred.row(far + 1), coarse.row(coarse.depth, near),
      coarse.row(coarse.depth, far)},
     how, multiply, coarse.width, fine.left & 1, fine.depth.row(y), fine.open.row(y));
    fine.repeat_ends(fine.open, y);
  });
}

}  // namespace ssdo
#endif
