// SPDX-License-Identifier: Apache-2.0
//
// The prior in full resolution: see prior.h. Lanes are neighbouring pixels of a row. Compiled once
// for every instruction set.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "estimators/guessed.h"
#include "prior/prior.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "prior/lean.cpp"
#include <hwy/foreach_target.h>

#include "filters/similarity-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What a square that shows another surface weighs, where none shows the pixel's own.
constexpr float kOtherSurface = 1e-3f;

/// s is held to kLeastShare..1 - kLeastShare.
constexpr float kLeastShare = 0.02f;

/// A row of squares, spread to pixels: entry x is of the square whose centre is the last one not
/// right of pixel x, entry x + step of the next. Channels 0 to 6 are those of TileRows, then G and
/// u.
class SpreadRow {
 public:
  static constexpr int kGuesses = 7, kLean = 8, kChannels = 9;

  explicit SpreadRow(std::size_t width, int step)
      : step_(step), stride_(width + std::size_t(step) + kLanes), values_(kChannels * stride_) {}

  /// `columns` are those of the squares, by entry.
  void spread(const PriorField& field, int row, const std::vector<int>& columns) {
    const Squares& s = field.squares;
    for (std::size_t x = 0; x < columns.size(); ++x) {
      const std::size_t i = s.surfel.index(columns[x], row);
      const Surfel& q = s.surfel[i];
      const float of[kChannels] = {q.position.x, q.position.y, q.position.z,
                                   q.normal.x,   q.normal.y,   q.normal.z,
                                   q.rounding,   s.guesses[i], field.lean[i]};
      for (std::size_t c = 0; c < kChannels; ++c) values_[c * stride_ + x] = of[c];
    }
  }

  HWY_INLINE Shown shown(std::size_t x) const {
    const float* from = values_.data() + x;
    const auto stride = std::ptrdiff_t(stride_);
    return {load_apart(from, stride), load_apart(from + 3 * stride, stride),
            load(from + 6 * stride)};
  }
  HWY_INLINE V at(int channel, std::size_t x) const {
    return load(values_.data() + std::size_t(channel) * stride_ + x);
  }
  std::size_t next(std::size_t x) const { return x + std::size_t(step_); }

 private:
  int step_;
  std::size_t stride_;
  std::vector<float> values_;
};

/// G and u of a vector of pixels.
struct Prior {
  V guesses, lean;
};

/// The mean of four squares by distance and by how far they show the surface of `p`. `right` and
/// `low` are the shares of the squares to the right, and below.
HWY_INLINE Prior interpolate(const Shown& p, const SpreadRow& above, const SpreadRow& below,
                             std::size_t x, V right, V low) {
  const std::size_t next = above.next(x);
  const Shown q[4] = {above.shown(x), above.shown(next), below.shown(x), below.shown(next)};
  const V one = set(1), left = one - right, high = one - low;
  const V share[4] = {left * high, right * high, left * low, right * low};
  V sum = set(0), guesses = sum, lean = sum;
  for (int k = 0; k < 4; ++k) {
    const M exists = dot(q[k].normal, q[k].normal) > set(0);
    const V alike = similarity(p, q[k], [&]() HWY_ATTR { return q[3 - k]; });
    const V weight = hn::IfThenElseZero(exists, share[k] * (alike + set(kOtherSurface)));
    const SpreadRow& row = k < 2 ? above : below;
    const std::size_t at = k % 2 ? next : x;
    sum = sum + weight;
    guesses = hn::MulAdd(weight, row.at(SpreadRow::kGuesses, at), guesses);
    lean = hn::MulAdd(weight, row.at(SpreadRow::kLean, at), lean);
  }
  const M any_shows = sum > set(0);
  return {hn::IfThenElseZero(any_shows, guesses / sum),
          hn::IfThenElse(any_shows, lean / sum, set(0.5f))};
}

/// ao' of prior.h.
HWY_INLINE V leaned(V ao, const Prior& prior) {
  const V zero = set(0), one = set(1), g2 = prior.guesses * prior.guesses;
  const V spread = set(0.99f * 4) * ao * (one - ao) + set(0.01f) * g2 * g2,
          g = prior.guesses * hn::Sqrt(spread);
  const V lo = hn::Max(ao - g, zero), hi = hn::Min(ao + g, one), width = hi - lo;
  const V s =
      hn::Clamp((ao - lo) / hn::Max(width, set(1e-6f)), set(kLeastShare), set(1 - kLeastShare));
  const V open = s * prior.lean, closed = (one - s) * (one - prior.lean);
  return hn::Clamp(hn::MulAdd(width, open / (open + closed) - s, ao), lo, hi);
}

/// Columns or rows of squares around pixels, and the shares of the second ones.
struct Axis {
  std::vector<int> square;  ///< of the first one, by pixel, and `step` pixels farther
  std::vector<float> share;
};

inline Axis make_axis(int first_pixel, int first_square, int squares, int pixels, int step) {
  Axis axis;
  for (int i = 0; i < pixels + step; ++i) {
    const double at = (double(first_pixel + i) + 0.5) / step - 0.5, whole = std::floor(at);
    axis.square.push_back(std::clamp(int(whole) - first_square, 0, squares - 1));
    axis.share.push_back(float(at - whole));
  }
  axis.share.resize(axis.share.size() + kMostLanes);
  return axis;
}

void lean_rows(const PriorField& field, const Geometry& geometry, int y0, int y1,
               Products& products) {
  const Squares& s = field.squares;
  const int width = geometry.surfel.width, step = s.step,
            left = geometry.window.x0 - geometry.display.x0,
            top = geometry.window.y0 - geometry.display.y0;
  const Axis columns = make_axis(left, s.first.x, s.pixel.width, width, step),
             rows = make_axis(top, s.first.y, s.pixel.height, geometry.surfel.height, step);
  SpreadRow above(std::size_t(width), step), below(std::size_t(width), step);
  int spread_above = -1, spread_below = -1;
  for (int y = y0; y < y1; ++y) {
    const int row = rows.square[std::size_t(y)], next = rows.square[std::size_t(y + step)];
    if (row == spread_below) std::swap(above, below), std::swap(spread_above, spread_below);
    if (row != spread_above) above.spread(field, row, columns.square), spread_above = row;
    if (next != spread_below) below.spread(field, next, columns.square), spread_below = next;
    for (int x = 0; x < width; x += kLanes) {
      const int count = width - x;
      const std::size_t i = geometry.surfel.index(x, y);
      const Surfels surfels = surfels_at(geometry.surfel, x, y);
      if (!any(surfels.surface)) continue;
      const Shown p{surfels.position, surfels.normal, surfels.rounding};
      const Prior prior =
          interpolate(p, above, below, std::size_t(x), load(&columns.share[std::size_t(x)]),
                      set(rows.share[std::size_t(y)]));
      const V ao = load_first(count, &products.ao[i]),
              after = hn::IfThenElse(surfels.surface, leaned(ao, prior), ao);
      store_first(count, after, &products.ao[i]);
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(lean_rows);

void apply_prior(const PriorField& field, const Geometry& geometry, Products& products) {
  for_each_band(geometry.surfel.height, [&](int y0, int y1) {
    HWY_DYNAMIC_DISPATCH(lean_rows)(field, geometry, y0, y1, products);
  });
}

}  // namespace ssdo
#endif
