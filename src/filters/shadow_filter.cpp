// SPDX-License-Identifier: Apache-2.0
//
// The filter of shadows. The ray of a pixel to one point of a sun is blocked or not; the T x T
// pixels of the pattern together sample all of the sun. But a sharp shadow, of a small sun or of
// something near, is the same for all points of the sun, and a mean over the pattern would blur it,
// or wash a thin one away. How wide the penumbra is follows from what is in the way: 2 a r, a the
// angular radius of the sun and r the distance to it (Fernando 2005, Percentage-Closer Soft
// Shadows, takes a mean of it too). So with the widths that blocked neighbours have found,
//
//   W(p)   = sum_q (1 - v(q)) w(p, q) c(q) W(q) / sum_q (1 - v(q)) w(p, q) c(q)
//   out(p) = sum_q b(q) w(p, q) c(q) v(q) / sum_q b(q) w(p, q) c(q)
//
// v being the shares, c the cosine of each ray, w that of geometry_filter.cpp and b a box, whole
// pixels and parts of those at its border. The box is B = W (1 + W / T) / 2 pixels wide, and T at
// most: a mean widens a penumbra by its own width, and a box of two pixels removes the shadow of
// what is three pixels wide. In the umbra of posts of 3 pixels, 15 % was lit with B = W; now it is
// 9 %, and without a filter 6 %. The error of walls and boxes is the same.
//
// Penumbras that are wider still have room for a mean over 2T x 2T pixels, in which points of the
// sun repeat. It is the mean of four windows whose centres are T / 2 aside,
//
//   out2(p) = out(p) + f / 4 sum_q w(p, q) (out(q) - out(p)),   f = (W / T - 1) / 3, 0 to 1
//
// times 8 out (1 - out), at most 1: the ends of a penumbra have no noise, and would become wider.
//
// Most pixels keep their share, because all of their neighbours have the same one.
#include "filters/shadow_filter.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shadow_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/similarity-inl.h"
#include "filters/tile_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

inline PlaneView view_of(const Plane<float>& plane) { return {plane.pixels.data(), 1}; }

class ShadowTile {
 public:
  ShadowTile(const NoisyShadow& noisy, const Surfaces& guide, int pattern_size, const Tile& tile,
             ShadowFound& out)
      : half_(pattern_size / 2),
        most_(float(pattern_size)),
        tile_(tile),
        rows_({view_of(noisy.share), view_of(noisy.sample.weight), view_of(noisy.sample.width_px)},
              guide, tile, half_, window()),
        extremes_(zeros(2 * window() * rows_.stride())),
        likeness_(zeros(window() * window() * kLanes)),
        result_(zeros(2 * rows_.stride())),
        out_(out) {}

  void run() {
    int gathered = tile_.y0 - half_;
    const int width = tile_.x1 - tile_.x0;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + half_; ++gathered) {
        rows_.gather(gathered);
        find_extremes(gathered);
      }
      float *const share = result_.get(), *const of_penumbra = share + rows_.stride();
      for (int x = 0; x < width; x += kLanes) {
        const Filtered found = filtered(x, y);
        store(found.share, share + x), store(found.penumbra, of_penumbra + x);
      }
      std::copy_n(share, width, &out_.share(tile_.x0, y));
      std::copy_n(of_penumbra, width, &out_.penumbra(tile_.x0, y));
    }
  }

 private:
  static constexpr int kShare = TileRows::kSurfelChannels, kWeight = kShare + 1,
                       kWidth = kShare + 2;

  int window() const { return 2 * half_ + 1; }

  /// The least and the largest share within half a window in row `y`, of surfaces.
  float* least(int y) const {
    const int slot = (y - tile_.y0 + half_) % window();
    return extremes_.get() + 2 * slot * rows_.stride();
  }
  float* largest(int y) const { return least(y) + rows_.stride(); }

  void find_extremes(int y) const {
    for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) {
      V low = set(2), high = set(-2);
      for (int dx = 0; dx < window(); ++dx) {
        const V share = load(rows_.row(y, kShare) + x + dx);
        const M surface = is_surface(rows_.shown(y, x + dx));
        low = hn::Min(low, hn::IfThenElse(surface, share, set(2)));
        high = hn::Max(high, hn::IfThenElse(surface, share, set(-2)));
      }
      store(low, least(y) + x), store(high, largest(y) + x);
    }
  }

  static HWY_INLINE M is_surface(const Shown& p) { return dot(p.normal, p.normal) > set(0); }

  /// The filtered share, and the width W of the penumbra: 0 where all neighbours have one share.
  struct Filtered {
    V share, penumbra;
  };

  /// A vector of pixels from column `x` of the tile on.
  Filtered filtered(int x, int y) const {
    V low = set(2), high = set(-2);
    for (int dy = -half_; dy <= half_; ++dy) {
      low = hn::Min(low, load(least(y + dy) + x));
      high = hn::Max(high, load(largest(y + dy) + x));
    }
    const V own = load(rows_.row(y, kShare) + x + half_);
    if (all(low >= high)) return {own, set(0)};
    const auto [width, penumbra] = penumbra_widths(x, y);
    const V reach = set(0.25f) * width * (set(1) + width * set(1 / most_)) + set(0.5f);
    V sum = set(0), weights = sum;
    const float* like = likeness_.get();
    for (int dy = -half_; dy <= half_; ++dy) {
      const V in_rows = saturate(reach - set(float(std::abs(dy))));
      for (int dx = -half_; dx <= half_; ++dx, like += kLanes) {
        const V in_box = in_rows * saturate(reach - set(float(std::abs(dx))));
        const V w = in_box * load(like) * load(rows_.row(y + dy, kWeight) + x + half_ + dx);
        weights = weights + w;
        sum = hn::MulAdd(w, load(rows_.row(y + dy, kShare) + x + half_ + dx), sum);
      }
    }
    return {hn::IfThenElse(weights > set(1e-6f), sum / weights, own), penumbra};
  }

  /// W(p) by widths of up to T, for the box, and of up to 4T pixels.
  struct Widths {
    V box, penumbra;
  };

  /// Fills likeness_ with w.
  Widths penumbra_widths(int x, int y) const {
    const Shown p = rows_.shown(y, x + half_);
    V in_box = set(0), sum = in_box, weights = in_box;
    float* like = likeness_.get();
    for (int dy = -half_; dy <= half_; ++dy) {
      for (int dx = -half_; dx <= half_; ++dx, like += kLanes) {
        const int at = x + half_ + dx;
        const V w = similarity(p, rows_.shown(y + dy, at),
                               [&]() HWY_ATTR { return rows_.shown(y - dy, x + half_ - dx); });
        store(w, like);
        const V blocked = w * load(rows_.row(y + dy, kWeight) + at) *
                          (set(1) - load(rows_.row(y + dy, kShare) + at));
        const V width = load(rows_.row(y + dy, kWidth) + at);
        weights = weights + blocked;
        sum = hn::MulAdd(blocked, width, sum);
        in_box = hn::MulAdd(blocked, hn::Min(width, set(most_)), in_box);
      }
    }
    // If the own ray is below the horizon (weight 0), only neighbours count, so the box is wide.
    const M sets = load(rows_.row(y, kWeight) + x + half_) <= set(0), blocks = weights > set(1e-6f);
    const V alone = hn::IfThenElse(sets, set(most_), set(1));
    const V box = hn::IfThenElse(blocks, in_box / weights, alone);
    return {hn::Max(box, set(1)), hn::IfThenElseZero(blocks, sum / weights)};
  }

  const int half_;
  const float most_;
  const Tile tile_;
  TileRows rows_;
  AlignedFloats extremes_;  ///< by row modulo the window: least, then largest
  AlignedFloats likeness_;  ///< w of each neighbour of a vector of pixels
  AlignedFloats result_;    ///< share, then W
  ShadowFound& out_;
};

/// The second pass: the mean of four windows around each pixel, as far as its penumbra is wider
/// than one.
class WidePenumbraTile {
 public:
  WidePenumbraTile(const ShadowFound& found, const Surfaces& guide, int pattern_size,
                   const Tile& tile, Plane<float>& out)
      : half_(pattern_size / 2),
        tile_(tile),
        rows_({view_of(found.share), view_of(found.penumbra)}, guide, tile, half_, 2 * half_ + 1),
        result_(zeros(rows_.stride())),
        out_(out) {}

  void run() {
    int gathered = tile_.y0 - half_;
    const int width = tile_.x1 - tile_.x0;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + half_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < width; x += kLanes) store(filtered(x, y), result_.get() + x);
      std::copy_n(result_.get(), width, &out_(tile_.x0, y));
    }
  }

 private:
  V filtered(int x, int y) const {
    constexpr int kShare = TileRows::kSurfelChannels, kPenumbra = kShare + 1;
    const int at = x + half_;
    const V own = load(rows_.row(y, kShare) + at),
            widths = load(rows_.row(y, kPenumbra) + at) * set(0.5f / float(half_)),
            inside = saturate(set(8) * own * (set(1) - own)),
            part = saturate((widths - set(1)) * set(1.0f / 3)) * inside;
    if (all(part <= set(0))) return own;
    const Shown p = rows_.shown(y, at);
    V sum = set(0);
    for (const int dy : {-half_, half_}) {
      for (const int dx : {-half_, half_}) {
        const V w = similarity(p, rows_.shown(y + dy, at + dx),
                               [&]() HWY_ATTR { return rows_.shown(y - dy, at - dx); });
        sum = hn::MulAdd(w, load(rows_.row(y + dy, kShare) + at + dx) - own, sum);
      }
    }
    return hn::MulAdd(set(0.25f) * part, sum, own);
  }

  const int half_;
  const Tile tile_;
  TileRows rows_;
  AlignedFloats result_;
  Plane<float>& out_;
};

void shadow_of_tile(const NoisyShadow& noisy, const Surfaces& guide, int pattern_size,
                    const Tile& tile, ShadowFound& out) {
  ShadowTile(noisy, guide, pattern_size, tile, out).run();
}

void wide_penumbra_of_tile(const ShadowFound& found, const Surfaces& guide, int pattern_size,
                           const Tile& tile, Plane<float>& out) {
  WidePenumbraTile(found, guide, pattern_size, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(shadow_of_tile);
HWY_EXPORT(wide_penumbra_of_tile);

Plane<float> filter_shadow(NoisyShadow noisy, const Surfaces& guide, int pattern_size) {
  ShadowFound found{Plane<float>::like(noisy.share), Plane<float>::like(noisy.share)};
  for_each_tile(guide.width, guide.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(shadow_of_tile)(noisy, guide, pattern_size, tile, found);
  });
  Plane<float> out = std::move(noisy.share);
  noisy = {};
  for_each_tile(guide.width, guide.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(wide_penumbra_of_tile)(found, guide, pattern_size, tile, out);
  });
  return out;
}

}  // namespace ssdo
#endif
