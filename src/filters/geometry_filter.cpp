// SPDX-License-Identifier: Apache-2.0
//
// The geometry-aware blur of screen-space directional occlusion (Ritschel et al. 2009, section 5):
// a window of the pattern's size, weighted by how far a neighbour's position lies from the pixel's
// tangent plane and by how far their normals differ.
//
//   out(p) = sum_q b(q) w(p, q) in(q) / sum_q b(q) w(p, q)
//   h = min(|n_p . (q - p)|, |n_p . (q - p) + n_p . (o - p)|),   o on the other side of p
//
// w is the weight of scene/same_surface.h with h / |q - p| for the sine. The second term of h is
// for smooth normals of a coarse mesh, which lean away from its faces: there the tangent plane cuts
// through the surface, and q lies above it by as much as o lies below it.
//
// The window is T + 1 wide, with b = 1/2 at its ends. Then each of the T x T members of the pattern
// has a total weight of exactly 1, which removes the pattern on a plane; and the window has a
// centre, unlike one of an even width T.
//
// A blade of grass, a leaf or a hair shares its surface with few pixels, and the mean of so few
// members of the pattern is noisy. Where the sum W of the b w is small, every q of the window that
// resembles p, by v of filters/similarity-inl.h, has more weight, by
//
//   e (1/W - 1/W_0) b(q) v(p, q),   W_0 = 3/8 T^2
//
// A plane has W = T^2, and where straight edges meet in a corner of it W is 25/64 of that at least,
// so that only thin things change. On path-traced grass and leaves ao is off by 2 to 3 % less, for
// any e from 0.8 to 1.5.
//
// For T = 8 this would be 81 neighbours. But that window is the mean of four windows of T = 4 whose
// centres are (+-2, +-2) pixels away, so a second pass computes it from the result of the first:
//
//   out(p) = m(p) + 1/4 sum_q w(p, q) l(p, q) (m(q) - m(p)),   m the result for T = 4
//   l = ramp(|b_q - b_p| / (r (b_p + b_q + 1/2))),   b the mean over the channels of m
//
// w lowers the weight of a q across a geometric edge; l lowers that of a q across the edge of a
// shadow, whose ao or share of the light differs by more than noise. Noise in a dark pixel is large
// relative to its own b but small relative to the 1 of an open pixel; so 1/4 is added for each of
// the two pixels. Bounce light has more noise and no sharp shadows: l = 1.
//
// bounce = R (1 - ao), R the mean radiance of the occluders. In the second pass ao keeps edges that
// bounce does not, so that their means would not belong together: a white furnace, ao + bounce = 1,
// was off by up to 0.08. So R is averaged, by 1 - ao, and multiplied by the 1 - ao that the pass
// gives:
//
//   out(p) = (mean of bounce + e bounce(p)) / (mean of 1 - ao + e (1 - ao(p))) (1 - ao_out(p))
//
// with l = 1 in both means. e is small: where the neighbours of p are open, R is that of p alone.
//
// Lanes are neighbouring pixels of a row; two rows at a time share their loads. Pixels without a
// surface have a normal of 0 here, so that w is 0. This file is compiled once for every instruction
// set.
#include "filters/geometry_filter.h"

#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/geometry_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/similarity-inl.h"
#include "filters/tile_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kStepTolerance = 0.15f;  ///< r; measured, with the 1/4
constexpr float kResembling = 1.5f;      ///< e

class TileFilter {
 public:
  TileFilter(const FilterPlanes& noisy, const Surfaces& guide, int pattern_size, const Tile& tile,
             FilterPlanes& out)
      : half_(pattern_size / 2),
        tile_(tile),
        rows_(views_of(noisy), guide, tile, half_, window() + 1),
        out_(out),
        weights_(zeros((window() + 1) * window() * 2 * kLanes)),
        averages_(zeros(2 * (rows_.components() + 1) * rows_.stride())) {}

  void run() {
    int gathered = tile_.y0 - half_;
    for (int y = tile_.y0; y < tile_.y1; y += 2) {
      for (; gathered <= y + 1 + half_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) filter(x, y);
      rows_.write(y, average(0, 0), weight_sum(0), out_);
      if (y + 1 < tile_.y1) rows_.write(y + 1, average(1, 0), weight_sum(1), out_);
    }
  }

 private:
  /// Components that are averaged at once: the sums of two rows of them fit AVX2's 16 registers.
  static constexpr int kAtOnce = 5;

  int window() const { return 2 * half_ + 1; }
  float* average(int k, int c) const {
    return averages_.get() + (k * (rows_.components() + 1) + c) * rows_.stride();
  }
  float* weight_sum(int k) const { return average(k, rows_.components()); }

  /// b for an offset in one dimension.
  float border(int offset) const {
    const int distance = std::abs(offset);
    return distance < half_ ? 1.0f : distance == half_ ? 0.5f : 0.0f;
  }

  /// W_0
  float enough() const { return 1.5f * float(half_ * half_); }

  /// Filters a vector of pixels from column `x` of the tile on, in rows `y` and `y` + 1.
  void filter(int x, int y) {
    weigh(x, y);
    const int components = rows_.components();
    int c = 0;
    for (; c + kAtOnce <= components; c += kAtOnce) average_rows<kAtOnce>(x, y, c);
    switch (components - c) {
      case 4:
        return average_rows<4>(x, y, c);
      case 3:
        return average_rows<3>(x, y, c);
      case 2:
        return average_rows<2>(x, y, c);
      case 1:
        return average_rows<1>(x, y, c);
    }
  }

  /// b w of each neighbour of both rows, and the sums.
  HWY_INLINE void weigh(int x, int y) {
    const Shown p0 = rows_.shown(y, x + half_), p1 = rows_.shown(y + 1, x + half_);
    V sum0 = set(0), sum1 = sum0;
    float* weight = weights_.get();
    for (int dy = -half_; dy <= half_ + 1; ++dy) {
      const auto shown_at = [&](int row, int dx)
                                HWY_ATTR { return rows_.shown(row, x + half_ + dx); };
      const float border0 = border(dy), border1 = border(dy - 1);
      for (int dx = -half_; dx <= half_; ++dx, weight += 2 * kLanes) {
        const Shown q = shown_at(y + dy, dx);
        if (border0 != 0) {
          const auto opposite = [&]() HWY_ATTR { return shown_at(y - dy, -dx); };
          const V w = set(border(dx) * border0) * similarity(p0, q, opposite);
          store(w, weight);
          sum0 = sum0 + w;
        }
        if (border1 != 0) {
          const auto opposite = [&]() HWY_ATTR { return shown_at(y + 2 - dy, -dx); };
          const V w = set(border(dx) * border1) * similarity(p1, q, opposite);
          store(w, weight + kLanes);
          sum1 = sum1 + w;
        }
      }
    }
    if (any(hn::Min(sum0, sum1) < set(enough()))) {
      add_resembling(x, y, p0, 0, sum0);
      add_resembling(x, y + 1, p1, 1, sum1);
    }
    store(sum0, weight_sum(0) + x);
    store(sum1, weight_sum(1) + x);
  }

  /// Adds to the weights of row `k` of the two, whose sum is `sum`, for what resembles `p`.
  HWY_NOINLINE void add_resembling(int x, int y, const Shown& p, int k, V& sum) {
    // A surface has a weight of 1 for itself, if its normal is one.
    const V share = hn::IfThenElseZero(
        sum >= set(1), set(kResembling) * hn::Max(set(1) / sum - set(1 / enough()), set(0)));
    for (int dy = -half_; dy <= half_; ++dy) {
      float* weight = weights_.get() + ((dy + half_ + k) * window() * 2 + k) * kLanes;
      for (int dx = -half_; dx <= half_; ++dx, weight += 2 * kLanes) {
        const Shown q = rows_.shown(y + dy, x + half_ + dx);
        const V more = share * set(border(dx) * border(dy)) * resemblance(p, q);
        store(load(weight) + more, weight);
        sum = sum + more;
      }
    }
  }

  /// Averages kCount components, from `c` on, of both rows.
  template <int kCount>
  HWY_INLINE void average_rows(int x, int y, int c) {
    const int stride = rows_.stride();
    V sum0[kCount], sum1[kCount];
    for (int k = 0; k < kCount; ++k) sum0[k] = sum1[k] = set(0);
    const float* weight = weights_.get();
    for (int dy = -half_; dy <= half_ + 1; ++dy) {
      const float* from = rows_.row(y + dy, TileRows::kSurfelChannels + c) + x;
      const bool in0 = dy <= half_, in1 = dy > -half_;
      for (int dx = 0; dx < window(); ++dx, weight += 2 * kLanes) {
        for (int k = 0; k < kCount; ++k) {
          const V value = load(from + k * stride + dx);
          if (in0) sum0[k] = hn::MulAdd(load(weight), value, sum0[k]);
          if (in1) sum1[k] = hn::MulAdd(load(weight + kLanes), value, sum1[k]);
        }
      }
    }
    const V scale0 = set(1) / load(weight_sum(0) + x), scale1 = set(1) / load(weight_sum(1) + x);
    for (int k = 0; k < kCount; ++k) {
      store(sum0[k] * scale0, average(0, c + k) + x);
      store(sum1[k] * scale1, average(1, c + k) + x);
    }
  }

  const int half_;
  const Tile tile_;
  TileRows rows_;
  FilterPlanes& out_;
  AlignedFloats weights_;   ///< by neighbour and row, a vector each
  AlignedFloats averages_;  ///< by row, component and column; last component: sum of the weights
};

/// l(p, q), from the brightness of both.
HWY_INLINE V likeness(V p, V q) {
  const V step = hn::Abs(q - p) / hn::Max(p + q + set(0.5f), set(0.25f));
  return saturate(hn::NegMulAdd(step, set(2 / kStepTolerance), set(2)));
}

/// A value for each of the four neighbours of the second pass.
struct Corners {
  V v[4];

  HWY_INLINE V operator[](int k) const { return v[k]; }
};

/// own + sum of weights (values - own)
HWY_INLINE V average(V own, const Corners& weights, const Corners& values) {
  V sum = own;
  for (int k = 0; k < 4; ++k) sum = hn::MulAdd(weights[k], values[k] - own, sum);
  return sum;
}

/// The second pass.
class CornerFilter {
 public:
  CornerFilter(const FilterPlanes& means, const Surfaces& guide, int offset, const Tile& tile,
               FilterPlanes& out)
      : offset_(offset),
        tile_(tile),
        means_(means),
        rows_(views_of(means), guide, tile, offset, 2 * offset + 1),
        out_(out),
        results_(zeros((rows_.components() + 1) * rows_.stride())) {
    int c = 0;
    for (const FilterPlane& mean : means) {
      if (mean.filtering.coupling == Coupling::visibility) ao_ = c;
      if (mean.filtering.coupling == Coupling::occluders) bounces_.push_back(c);
      c += mean.components();
    }
  }

  void run() {
    int gathered = tile_.y0 - offset_;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + offset_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) filter(x, y);
      rows_.write(y, results_.get(), is_surface(), out_);
    }
  }

 private:
  static constexpr float kOwnRadiance = 1e-3f;  ///< e

  float* result(int c) const { return results_.get() + c * rows_.stride(); }
  float* is_surface() const { return result(rows_.components()); }

  /// The result of the first pass for component `c`.
  HWY_INLINE V mean(int c, int x, int y) const {
    return load(rows_.row(y, TileRows::kSurfelChannels + c) + x + offset_);
  }
  HWY_INLINE Corners means_around(int c, int x, int y) const {
    const int d = offset_;
    return {{mean(c, x - d, y - d), mean(c, x + d, y - d), mean(c, x - d, y + d),
             mean(c, x + d, y + d)}};
  }

  /// w / 4 of the four neighbours.
  HWY_INLINE Corners weigh(int x, int y) const {
    const int left = x, right = x + 2 * offset_, above = y - offset_, below = y + offset_;
    const Shown p = rows_.shown(y, x + offset_);
    const Shown q[4] = {rows_.shown(above, left), rows_.shown(above, right),
                        rows_.shown(below, left), rows_.shown(below, right)};
    store(dot(p.normal, p.normal), is_surface() + x);
    Corners weights;
    for (int k = 0; k < 4; ++k) {
      const V w = similarity(p, q[k], [&]() HWY_ATTR { return q[3 - k]; });
      weights.v[k] = set(0.25f) * w;
    }
    return weights;
  }

  /// w l / 4 for the components from `c` on that belong together.
  HWY_INLINE Corners weigh_shadowed(int c, int components, int x, int y, Corners weights) const {
    V own = mean(c, x, y);
    Corners around = means_around(c, x, y);
    if (components == 3) {
      const auto third_of = [](V a, V b, V d) HWY_ATTR { return (a + b + d) * set(1.0f / 3); };
      const Corners second = means_around(c + 1, x, y), third = means_around(c + 2, x, y);
      own = third_of(own, mean(c + 1, x, y), mean(c + 2, x, y));
      for (int k = 0; k < 4; ++k) around.v[k] = third_of(around[k], second[k], third[k]);
    }
    for (int k = 0; k < 4; ++k) weights.v[k] = weights[k] * likeness(own, around[k]);
    return weights;
  }

  /// Filters a vector of pixels from column `x` of the tile on.
  HWY_INLINE void filter(int x, int y) {
    const Corners weights = weigh(x, y);
    int c = 0;
    for (const FilterPlane& plane : means_) {
      const Corners of_plane =
          plane.filtering.shadowed ? weigh_shadowed(c, plane.components(), x, y, weights) : weights;
      for (const int end = c + plane.components(); c < end; ++c)
        store(average(mean(c, x, y), of_plane, means_around(c, x, y)), result(c) + x);
    }
    if (ao_ && !bounces_.empty()) hold_bounces_to_ao(x, y, weights);
  }

  /// Turns the mean bounce of each light, and of all, into the mean radiance of the occluders times
  /// 1 - ao, with the new ao.
  HWY_INLINE void hold_bounces_to_ao(int x, int y, const Corners& weights) {
    const V e = set(kOwnRadiance), one = set(1), own_closed = one - mean(*ao_, x, y),
            closed = one - average(mean(*ao_, x, y), weights, means_around(*ao_, x, y));
    // Where the mean of 1 - ao is below rounding, nothing hides.
    const V whole = hn::MulAdd(e, own_closed, closed);
    const V scale = hn::IfThenElseZero(whole > set(1e-6f), (one - load(result(*ao_) + x)) / whole);
    for (const int bounce : bounces_) {
      for (int c = bounce; c < bounce + 3; ++c) {
        float* at = result(c) + x;
        store(hn::MulAdd(e, mean(c, x, y), load(at)) * scale, at);
      }
    }
  }

  const int offset_;
  const Tile tile_;
  const FilterPlanes& means_;
  TileRows rows_;
  FilterPlanes& out_;
  std::optional<int> ao_;     ///< its first component
  std::vector<int> bounces_;  ///< the first component of each
  AlignedFloats results_;     ///< by component and column; last component: 0 without a surface
};

void filter_tile(const FilterPlanes& noisy, const Surfaces& guide, int pattern_size,
                 const Tile& tile, FilterPlanes& out) {
  TileFilter(noisy, guide, pattern_size, tile, out).run();
}

void filter_corners(const FilterPlanes& means, const Surfaces& guide, int offset, const Tile& tile,
                    FilterPlanes& out) {
  CornerFilter(means, guide, offset, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(filter_tile);
HWY_EXPORT(filter_corners);

FilterPlanes filter_geometry(FilterPlanes noisy, const Surfaces& guide, int pattern_size) {
  constexpr int kMostAtOnce = 4;
  const bool twice = pattern_size > kMostAtOnce;
  FilterPlanes means = like(noisy);
  for_each_tile(guide.width, guide.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(filter_tile)
    (noisy, guide, twice ? pattern_size / 2 : pattern_size, tile, means);
  });
  if (!twice) return means;
  for_each_tile(guide.width, guide.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(filter_corners)(means, guide, pattern_size / 4, tile, noisy);
  });
  return noisy;
}

}  // namespace ssdo
#endif
