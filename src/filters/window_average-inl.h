// SPDX-License-Identifier: Apache-2.0
//
// The average of a pixel's neighbours, weighted by where they stand in the window and by how alike
// the surfaces are; compiled once for every instruction set.
//
//   out(p) = in(p) + sum_q a(q - p) w(p, q) (in(q) - in(p)) / sum_q a(q - p) w(p, q)
//
// Differences are averaged, not values: a field that is the same everywhere stays as it is, to the
// last bit.
#if defined(SSDO_FILTERS_WINDOW_AVERAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#undef SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#else
#define SSDO_FILTERS_WINDOW_AVERAGE_INL_H_
#endif

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "filters/tap.h"
#include "filters/tile_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Camera-space depth and normal of pixels side by side. What is no surface has no normal.
struct SurfaceLanes {
  V z, nx, ny, nz;
};

HWY_INLINE SurfaceLanes load_surface(const float* from, int stride) {
  const D d;
  const auto channel = [&](int c) HWY_ATTR { return hn::LoadU(d, from + c * stride); };
  return {channel(2), channel(3), channel(4), channel(5)};
}

/// N_p . N_q: about 1 for p = q on a surface, 0 where one of them is none.
HWY_INLINE V cosine(const SurfaceLanes& p, const SurfaceLanes& q) {
  return hn::MulAdd(p.nx, q.nx, hn::MulAdd(p.ny, q.ny, p.nz * q.nz));
}

/// Averages one tile. `similarity(p, q)` is w: 0 where one of both is no surface.
template <class Similarity>
class WindowAverage {
 public:
  WindowAverage(const Products& noisy, const Geometry& geometry, const std::vector<Tap>& taps,
                const Similarity& similarity, const Tile& tile, Products& out)
      : taps_(taps),
        similarity_(similarity),
        tile_(tile),
        half_(reach(taps,
                    [](const Tap& tap) { return std::max(std::abs(tap.dx), std::abs(tap.dy)); })),
        half_rows_(reach(taps, [](const Tap& tap) { return std::abs(tap.dy); })),
        rows_(noisy, geometry.surfel, tile, half_, 2 * half_ + 1, out),
        weights_(zeros(int(taps.size()) * kLanes)),
        averages_(zeros((rows_.components() + 1) * rows_.stride())) {}

  void run() {
    int gathered = tile_.y0 - half_rows_;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + half_rows_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) average(x, y);
      rows_.write(y, averages_.get(), weight_sum());
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
    const D d;
    const int stride = rows_.stride();
    const SurfaceLanes p = load_surface(rows_.row(y, 0) + x + half_, stride);
    V sum = hn::Zero(d);
    float* weight = weights_.get();
    for (const Tap& tap : taps_) {
      const float* q = rows_.row(y + tap.dy, 0) + x + half_ + tap.dx;
      const V w = hn::Set(d, tap.weight) * similarity_(p, load_surface(q, stride));
      hn::Store(w, d, weight);
      weight += kLanes;
      sum = sum + w;
    }
    hn::Store(sum, d, weight_sum() + x);
    const V scale = hn::Set(d, 1.0f) / sum;
    for (int c = 0; c < rows_.components(); ++c) {
      const int channel = TileRows::kSurfelChannels + c;
      const V centre = hn::LoadU(d, rows_.row(y, channel) + x + half_);
      V difference = hn::Zero(d);
      weight = weights_.get();
      for (const Tap& tap : taps_) {
        const V value = hn::LoadU(d, rows_.row(y + tap.dy, channel) + x + half_ + tap.dx);
        difference = hn::MulAdd(hn::Load(d, weight), value - centre, difference);
        weight += kLanes;
      }
      hn::Store(hn::MulAdd(difference, scale, centre), d, averages_.get() + c * stride + x);
    }
  }

  const std::vector<Tap>& taps_;
  const Similarity similarity_;
  const Tile tile_;
  const int half_, half_rows_;  ///< reach of the window, and of its rows
  TileRows rows_;
  AlignedFloats weights_;   ///< by tap, a vector each
  AlignedFloats averages_;  ///< by component and column; after the components the weights' sum
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
