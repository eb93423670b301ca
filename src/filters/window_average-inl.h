// SPDX-License-Identifier: Apache-2.0
//
// The average of a pixel's neighbours, weighted by their place in the window and by how similar the
// surfaces are; compiled once for every instruction set.
//
//   out(p) = in(p) + sum_q a(q - p) w(p, q) (in(q) - in(p)) / sum_q a(q - p) w(p, q)
//
// Differences to the pixel are averaged instead of values, so that a constant plane keeps its bits.
#if defined(SSDO_FILTERS_WINDOW_AVERAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#undef SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#else
#define SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#endif

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "filters/filter_planes.h"
#include "filters/tile_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Least cosine between the normals of pixels that are averaged (Luna 2016, chapter 21).
constexpr float kLeastCosine = 0.8f;

/// Averages one tile. `similarity(p, q)` is w: 0 where one of both is no surface.
template <class Similarity>
class WindowAverage {
 public:
  WindowAverage(const FilterPlanes& noisy, const Surfaces& guide, const std::vector<Tap>& taps,
                const Similarity& similarity, const Tile& tile, FilterPlanes& out)
      : taps_(taps),
        similarity_(similarity),
        tile_(tile),
        half_(reach(taps,
                    [](const Tap& tap) { return std::max(std::abs(tap.dx), std::abs(tap.dy)); })),
        half_rows_(reach(taps, [](const Tap& tap) { return std::abs(tap.dy); })),
        rows_(views_of(noisy), guide, tile, half_, 2 * half_ + 1),
        out_(out),
        weights_(zeros(int(taps.size()) * kLanes)),
        averages_(zeros((rows_.components() + 1) * rows_.stride())) {}

  void run() {
    int gathered = tile_.y0 - half_rows_;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + half_rows_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) average(x, y);
      rows_.write(y, averages_.get(), weight_sum(), out_);
    }
  }

 private:
  template <class Extent>
  static int reach(const std::vector<Tap>& taps, const Extent& extent) {
    int most = 0;
    for (const Tap& tap : taps) most = std::max(most, extent(tap));
    return most;
  }

  float* weight_sum() const { return averages_.get() + rows_.components() * rows_.stride(); }

  /// A vector of pixels from column `x` of the tile on.
  HWY_INLINE void average(int x, int y) {
    const int stride = rows_.stride();
    const Shown p = rows_.shown(y, x + half_);
    V sum = set(0);
    float* weight = weights_.get();
    for (const Tap& tap : taps_) {
      const V w = set(tap.weight) * similarity_(p, rows_.shown(y + tap.dy, x + half_ + tap.dx));
      store(w, weight);
      weight += kLanes;
      sum = sum + w;
    }
    store(sum, weight_sum() + x);
    const V scale = set(1) / sum;
    for (int c = 0; c < rows_.components(); ++c) {
      const int channel = TileRows::kSurfelChannels + c;
      const V centre = load(rows_.row(y, channel) + x + half_);
      V difference = set(0);
      weight = weights_.get();
      for (const Tap& tap : taps_) {
        const V value = load(rows_.row(y + tap.dy, channel) + x + half_ + tap.dx);
        difference = hn::MulAdd(load(weight), value - centre, difference);
        weight += kLanes;
      }
      store(hn::MulAdd(difference, scale, centre), averages_.get() + c * stride + x);
    }
  }

  const std::vector<Tap>& taps_;
  const Similarity similarity_;
  const Tile tile_;
  const int half_, half_rows_;  ///< reach of the window, and of its rows
  TileRows rows_;
  FilterPlanes& out_;
  AlignedFloats weights_;   ///< by tap, a vector each
  AlignedFloats averages_;  ///< by component and column; after the components the weights' sum
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
