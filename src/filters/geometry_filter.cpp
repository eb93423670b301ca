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
// centre, which one of an even width T has not.
//
// For T = 8 this would be 81 neighbours. But that window is the mean of four windows of T = 4 whose
// centres are (+-2, +-2) pixels away, so a second pass computes it from the result of the first:
//
//   out(p) = m(p) + 1/4 sum_q w(p, q) l(p, q) (m(q) - m(p)),   m the result for T = 4
//   l = ramp(|b_q - b_p| / (r (b_p + b_q + (A_p + A_q) / 4))),   b the brightness of m, A = b / ao
//
// w reduces the share of a q across a geometric edge, and l that of a q whose ao or direct light
// differs by more than noise, which lies across the edge of a shadow. In a dark pixel, noise is
// large relative to its own light b but small relative to its unoccluded light A, so the tolerance
// of l grows with A. Bounce light has more noise and no sharp shadows: l = 1.
//
// Lanes are neighbouring pixels of a row; two rows at a time share their loads. Pixels without a
// surface have a normal of 0 here, so that w is 0. This file is compiled once for every instruction
// set.
#include "filters/geometry_filter.h"

#include <cstdlib>
#include <optional>

#include "filters/tap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/geometry_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/tile_rows-inl.h"
#include "scene/same_surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kStepTolerance = 0.15f;  ///< r; measured, with the 1/4 before A

/// Signed distance of q from p's tangent plane.
HWY_INLINE V above_plane(const Shown& p, const Shown& q) {
  return dot(q.position - p.position, p.normal);
}

/// The factor of w that depends on the plane, with `above` = n_p . (q - p) and the distance by
/// which rounding may have moved it. Not inlined, since it is rarely needed: for most neighbours a
/// comparison of squares shows that the factor is 1.
HWY_NOINLINE V plane_ramp(V above, V rounding, V distance2, const Shown& p, const Shown& o) {
  const V off_plane = hn::Max(set(0), hn::Abs(above) - rounding),
          bend = hn::Max(set(0), hn::Abs(above + above_plane(p, o)) - rounding - rounding);
  const M exists = dot(o.normal, o.normal) > set(0);
  const V h = hn::IfThenElse(exists, hn::Min(off_plane, bend), off_plane);
  return hn::IfThenElse(distance2 > set(0), plane_weight(h / hn::Sqrt(distance2)), set(1));
}

/// w(p, q); 0 where one of them shows no surface. `opposite()` gives the pixel on p's other side.
template <class Opposite>
HWY_INLINE V similarity(const Shown& p, const Shown& q, const Opposite& opposite) {
  const V turn = normal_weight(dot(p.normal, q.normal));
  const V3 to_q = q.position - p.position;
  const V distance2 = dot(to_q, to_q), above = above_plane(p, q);
  const V rounding = p.rounding + q.rounding;
  const V off_plane = hn::Max(set(0), hn::Abs(above) - rounding);
  if (all(within_sine(off_plane, distance2, kPlaneSine / 2))) return turn;
  return turn * plane_ramp(above, rounding, distance2, p, opposite());
}

class TileFilter {
 public:
  TileFilter(const Products& noisy, const Geometry& geometry, int pattern_size, const Tile& tile,
             Products& out)
      : half_(pattern_size / 2),
        tile_(tile),
        rows_(noisy, geometry.surfel, tile, half_, window() + 1, out),
        weights_(zeros((window() + 1) * window() * 2 * kLanes)),
        averages_(zeros(2 * (rows_.components() + 1) * rows_.stride())) {}

  void run() {
    int gathered = tile_.y0 - half_;
    for (int y = tile_.y0; y < tile_.y1; y += 2) {
      for (; gathered <= y + 1 + half_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) filter(x, y);
      rows_.write(y, average(0, 0), weight_sum(0));
      if (y + 1 < tile_.y1) rows_.write(y + 1, average(1, 0), weight_sum(1));
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

  /// A vector of pixels from column `x` of the tile on, in rows `y` and `y` + 1.
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
    store(sum0, weight_sum(0) + x);
    store(sum1, weight_sum(1) + x);
  }

  /// kCount components of both rows, from `c` on.
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
  AlignedFloats weights_;   ///< by neighbour and row, a vector each
  AlignedFloats averages_;  ///< by row, component and column; last component: sum of the weights
};

/// b and A of a pixel: its brightness, and about what it would be without occlusion.
struct Brightness {
  V value, open;
};

/// l(p, q).
HWY_INLINE V likeness(const Brightness& p, const Brightness& q) {
  const V scale = hn::MulAdd(set(0.25f), p.open + q.open, p.value + q.value);
  const V step = hn::Abs(q.value - p.value) / hn::Max(scale, set(1e-30f));
  return saturate(hn::NegMulAdd(step, set(2 / kStepTolerance), set(2)));
}

/// The second pass.
class CornerFilter {
 public:
  CornerFilter(const Products& means, const Geometry& geometry, int offset, const Tile& tile,
               Products& out)
      : offset_(offset),
        tile_(tile),
        rows_(means, geometry.surfel, tile, offset, 2 * offset + 1, out),
        results_(zeros((rows_.components() + 1) * rows_.stride())) {
    int channel = TileRows::kSurfelChannels;
    for (const Part& part : rows_.parts()) {
      if (part.noisy == means.ao.pixels.data()) ao_ = channel;
      channel += part.components;
    }
  }

  void run() {
    int gathered = tile_.y0 - offset_;
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (; gathered <= y + offset_; ++gathered) rows_.gather(gathered);
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) filter(x, y);
      rows_.write(y, results_.get(), is_surface());
    }
  }

 private:
  static constexpr float kLeastOpen = 0.02f;

  float* is_surface() const { return results_.get() + rows_.components() * rows_.stride(); }

  /// A vector of pixels from column `x` of the tile on.
  HWY_INLINE void filter(int x, int y) {
    const int stride = rows_.stride();
    const int above = y - offset_, below = y + offset_, left = x, right = x + 2 * offset_;
    const Shown p = rows_.shown(y, x + offset_);
    const Shown q0 = rows_.shown(above, left), q1 = rows_.shown(above, right),
                q2 = rows_.shown(below, left), q3 = rows_.shown(below, right);
    const auto weight = [&](const Shown& q, const Shown& opposite) HWY_ATTR {
      return set(0.25f) * similarity(p, q, [&]() HWY_ATTR { return opposite; });
    };
    const V w0 = weight(q0, q3), w1 = weight(q1, q2), w2 = weight(q2, q1), w3 = weight(q3, q0);
    store(dot(p.normal, p.normal), is_surface() + x);
    int c = 0;
    for (const Part& part : rows_.parts()) {
      const auto mean_at = [&](int k, int row, int column) HWY_ATTR {
        return load(rows_.row(row, TileRows::kSurfelChannels + c + k) + column);
      };
      V v0 = w0, v1 = w1, v2 = w2, v3 = w3;
      if (part.shadowed) {
        const auto brightness_at = [&](int row, int column) HWY_ATTR {
          V value = mean_at(0, row, column);
          if (part.components == 3)
            value = value + mean_at(1, row, column) + mean_at(2, row, column);
          if (!ao_) return Brightness{value, value};
          const V ao = load(rows_.row(row, *ao_) + column);
          return Brightness{value, value / hn::Max(ao, set(kLeastOpen))};
        };
        const Brightness own = brightness_at(y, x + offset_);
        v0 = v0 * likeness(own, brightness_at(above, left));
        v1 = v1 * likeness(own, brightness_at(above, right));
        v2 = v2 * likeness(own, brightness_at(below, left));
        v3 = v3 * likeness(own, brightness_at(below, right));
      }
      for (int k = 0; k < part.components; ++k) {
        const V own = mean_at(k, y, x + offset_);
        V sum = hn::MulAdd(v0, mean_at(k, above, left) - own, own);
        sum = hn::MulAdd(v1, mean_at(k, above, right) - own, sum);
        sum = hn::MulAdd(v2, mean_at(k, below, left) - own, sum);
        sum = hn::MulAdd(v3, mean_at(k, below, right) - own, sum);
        store(sum, results_.get() + (c + k) * stride + x);
      }
      c += part.components;
    }
  }

  const int offset_;
  const Tile tile_;
  TileRows rows_;
  std::optional<int> ao_;  ///< its channel
  AlignedFloats results_;  ///< by component and column; last component: 0 without a surface
};

void filter_tile(const Products& noisy, const Geometry& geometry, int pattern_size,
                 const Tile& tile, Products& out) {
  TileFilter(noisy, geometry, pattern_size, tile, out).run();
}

void filter_corners(const Products& means, const Geometry& geometry, int offset, const Tile& tile,
                    Products& out) {
  CornerFilter(means, geometry, offset, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(filter_tile);
HWY_EXPORT(filter_corners);

Products filter_geometry(Products noisy, const Geometry& geometry, int pattern_size) {
  constexpr int kMostAtOnce = 4;
  const int width = geometry.surfel.width, height = geometry.surfel.height;
  const bool twice = pattern_size > kMostAtOnce;
  Products means = like(noisy);
  for_each_tile(width, height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(filter_tile)
    (noisy, geometry, twice ? pattern_size / 2 : pattern_size, tile, means);
  });
  if (!twice) return means;
  for_each_tile(width, height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(filter_corners)(means, geometry, pattern_size / 4, tile, noisy);
  });
  return noisy;
}

}  // namespace ssdo
#endif
