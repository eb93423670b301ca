// SPDX-License-Identifier: Apache-2.0
//
// The geometry-aware blur of screen-space directional occlusion (Ritschel et al. 2009, section 5):
// a window of the pattern's size, weighted by how far a neighbour's position lies from the pixel's
// tangent plane and by how far their normals differ.
//
//   out(p) = sum_q b(q) w(p, q) in(q) / sum_q b(q) w(p, q)
//   w = ramp(h / (t |q - p|)) * ramp((1 - n_p . n_q) / (1 - c))
//   h = min(|n_p . (q - p)|, |n_p . (q - p) + n_p . (o - p)|),   o on the other side of p
//   ramp(x) = 1 up to 1/2, falling to 0 at 1
//
// The first argument is the sine of the angle by which q leaves the tangent plane, so that the
// weight knows no unit and no resolution. Smooth normals of a coarse mesh may lean away from its
// faces: there the plane cuts the surface, but what q rises above it, o falls below. The flat part
// matters: where a surface bends gently, all members of the pattern have to weigh the same, or the
// pattern shows through.
//
// The window is T + 1 wide, with b = 1/2 at its ends: each of the T x T members of the pattern
// then has a total weight of exactly 1, which removes the pattern on a plane, and the window has a
// centre, which T alone has not.
//
// For T = 8 this would be 81 neighbours. But it is also the mean of four windows of T = 4 about the
// pixels (+-2, +-2) away, so that a second pass makes it of what the first has left:
//
//   out(p) = m(p) + 1/4 sum_q w(p, q) l(p, q) (m(q) - m(p)),   m the result for T = 4
//   l = ramp(|b_q - b_p| / (r (b_p + b_q + (A_p + A_q) / 4))),   b the brightness of m, A = b / ao
//
// What leads over an edge counts as the pixel's own mean. So does, by l, what leads over a step of
// ao or direct light that is more than noise: the edge of a shadow. The noise of what is dark is
// small beside the light that it would have in the open, which is about A, not beside its own. A
// bounce has more noise and no such steps: l = 1.
//
// Lanes are pixels that lie side by side; two rows at a time share their loads. What is not a
// surface has no normal here, so that it weighs 0. This file is compiled once for every
// instruction set.
#include "filters/geometry_filter.h"

#include <cstdlib>
#include <optional>

#include "filters/tap.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/geometry_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/tile_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kPlaneTolerance = 0.3f;  ///< t: the sine of 17 degrees
constexpr float kNormalCosine = 0.8f;    ///< c: normals 37 degrees apart share nothing
constexpr float kStepTolerance = 0.15f;  ///< r; measured, with the 1/4 before A

/// Position, normal and rounding.
struct Pixels {
  V x, y, z, nx, ny, nz, rounding;
};

HWY_INLINE Pixels load_pixels(const float* from, int stride) {
  const D d;
  const auto channel = [&](int c) HWY_ATTR { return hn::LoadU(d, from + c * stride); };
  return {channel(0), channel(1), channel(2), channel(3), channel(4), channel(5), channel(6)};
}

HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, az * bz));
}

HWY_INLINE V clamp01(V x) {
  const D d;
  return hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1.0f));
}

/// How far q lies from p's tangent plane, signed.
HWY_INLINE V above_plane(const Pixels& p, const Pixels& q) {
  return dot3(q.x - p.x, q.y - p.y, q.z - p.z, p.nx, p.ny, p.nz);
}

/// ramp(h / (t |q - p|)); `above` is n_p . (q - p), which rounding may have moved so much. Few ask
/// for it: most neighbours lie in the flat part, which squares can tell.
HWY_NOINLINE V plane_ramp(V above, V rounding, V distance2, const Pixels& p, const Pixels& o) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const V off_plane = hn::Max(zero, hn::Abs(above) - rounding),
          bend = hn::Max(zero, hn::Abs(above + above_plane(p, o)) - rounding - rounding);
  const auto exists = dot3(o.nx, o.ny, o.nz, o.nx, o.ny, o.nz) > zero;
  const V sine = hn::IfThenElse(exists, hn::Min(off_plane, bend), off_plane) / hn::Sqrt(distance2);
  const V ramp = clamp01(hn::NegMulAdd(sine, hn::Set(d, 2 / kPlaneTolerance), hn::Set(d, 2.0f)));
  return hn::IfThenElse(distance2 > zero, ramp, one);
}

/// w(p, q), 0 where one of them has no normal. `opposite()` is the pixel on p's other side.
template <class Opposite>
HWY_INLINE V similarity(const Pixels& p, const Pixels& q, const Opposite& opposite) {
  const D d;
  // 2 - 2 (1 - cosine) / (1 - c)
  constexpr float kSlope = 2 / (1 - kNormalCosine);
  const V cosine = dot3(p.nx, p.ny, p.nz, q.nx, q.ny, q.nz);
  const V turn = clamp01(hn::MulAdd(cosine, hn::Set(d, kSlope), hn::Set(d, 2 - kSlope)));
  const V x = q.x - p.x, y = q.y - p.y, z = q.z - p.z, distance2 = dot3(x, y, z, x, y, z);
  const V above = above_plane(p, q), rounding = p.rounding + q.rounding;
  const V off_plane = hn::Max(hn::Zero(d), hn::Abs(above) - rounding);
  constexpr float kFlat = kPlaneTolerance / 2;
  if (hn::AllTrue(d, off_plane * off_plane <= distance2 * hn::Set(d, kFlat * kFlat))) return turn;
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
  /// Components that are averaged in one go: two rows of them leave registers free in AVX2.
  static constexpr int kAtOnce = 5;

  int window() const { return 2 * half_ + 1; }
  float* average(int k, int c) const {
    return averages_.get() + (k * (rows_.components() + 1) + c) * rows_.stride();
  }
  float* weight_sum(int k) const { return average(k, rows_.components()); }

  /// b, of an offset in one dimension.
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
    const D d;
    const int stride = rows_.stride();
    const Pixels p0 = load_pixels(rows_.row(y, 0) + x + half_, stride),
                 p1 = load_pixels(rows_.row(y + 1, 0) + x + half_, stride);
    V sum0 = hn::Zero(d), sum1 = sum0;
    float* weight = weights_.get();
    for (int dy = -half_; dy <= half_ + 1; ++dy) {
      const auto pixels_at = [&](int row, int dx) HWY_ATTR {
        return load_pixels(rows_.row(row, 0) + x + half_ + dx, stride);
      };
      const float border0 = border(dy), border1 = border(dy - 1);
      for (int dx = -half_; dx <= half_; ++dx, weight += 2 * kLanes) {
        const Pixels q = pixels_at(y + dy, dx);
        if (border0 != 0) {
          const auto opposite = [&]() HWY_ATTR { return pixels_at(y - dy, -dx); };
          const V w = hn::Set(d, border(dx) * border0) * similarity(p0, q, opposite);
          hn::Store(w, d, weight);
          sum0 = sum0 + w;
        }
        if (border1 != 0) {
          const auto opposite = [&]() HWY_ATTR { return pixels_at(y + 2 - dy, -dx); };
          const V w = hn::Set(d, border(dx) * border1) * similarity(p1, q, opposite);
          hn::Store(w, d, weight + kLanes);
          sum1 = sum1 + w;
        }
      }
    }
    hn::Store(sum0, d, weight_sum(0) + x);
    hn::Store(sum1, d, weight_sum(1) + x);
  }

  /// kCount components of both rows, from `c` on.
  template <int kCount>
  HWY_INLINE void average_rows(int x, int y, int c) {
    const D d;
    const int stride = rows_.stride();
    V sum0[kCount], sum1[kCount];
    for (int k = 0; k < kCount; ++k) sum0[k] = sum1[k] = hn::Zero(d);
    const float* weight = weights_.get();
    for (int dy = -half_; dy <= half_ + 1; ++dy) {
      const float* from = rows_.row(y + dy, TileRows::kSurfelChannels + c) + x;
      const bool in0 = dy <= half_, in1 = dy > -half_;
      for (int dx = 0; dx < window(); ++dx, weight += 2 * kLanes) {
        for (int k = 0; k < kCount; ++k) {
          const V value = hn::LoadU(d, from + k * stride + dx);
          if (in0) sum0[k] = hn::MulAdd(hn::Load(d, weight), value, sum0[k]);
          if (in1) sum1[k] = hn::MulAdd(hn::Load(d, weight + kLanes), value, sum1[k]);
        }
      }
    }
    const V one = hn::Set(d, 1.0f), scale0 = one / hn::Load(d, weight_sum(0) + x),
            scale1 = one / hn::Load(d, weight_sum(1) + x);
    for (int k = 0; k < kCount; ++k) {
      hn::Store(sum0[k] * scale0, d, average(0, c + k) + x);
      hn::Store(sum1[k] * scale1, d, average(1, c + k) + x);
    }
  }

  const int half_;
  const Tile tile_;
  TileRows rows_;
  AlignedFloats weights_;   ///< by neighbour and row, a vector each
  AlignedFloats averages_;  ///< by row, component and column; after the components the weights' sum
};

/// How bright a pixel is, and would about be in the open.
struct Brightness {
  V value, open;
};

/// l(p, q).
HWY_INLINE V likeness(const Brightness& p, const Brightness& q) {
  const D d;
  const V scale = hn::MulAdd(hn::Set(d, 0.25f), p.open + q.open, p.value + q.value);
  const V step = hn::Abs(q.value - p.value) / hn::Max(scale, hn::Set(d, 1e-30f));
  return clamp01(hn::NegMulAdd(step, hn::Set(d, 2 / kStepTolerance), hn::Set(d, 2.0f)));
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
    const D d;
    const int stride = rows_.stride();
    const int above = y - offset_, below = y + offset_, left = x, right = x + 2 * offset_;
    const auto surface_at = [&](int row, int column) HWY_ATTR {
      return load_pixels(rows_.row(row, 0) + column, stride);
    };
    const Pixels p = surface_at(y, x + offset_);
    const Pixels q0 = surface_at(above, left), q1 = surface_at(above, right),
                 q2 = surface_at(below, left), q3 = surface_at(below, right);
    const V quarter = hn::Set(d, 0.25f);
    const auto weight = [&](const Pixels& q, const Pixels& opposite) HWY_ATTR {
      return quarter * similarity(p, q, [&]() HWY_ATTR { return opposite; });
    };
    const V w0 = weight(q0, q3), w1 = weight(q1, q2), w2 = weight(q2, q1), w3 = weight(q3, q0);
    hn::Store(dot3(p.nx, p.ny, p.nz, p.nx, p.ny, p.nz), d, is_surface() + x);
    int c = 0;
    for (const Part& part : rows_.parts()) {
      const auto mean_at = [&](int k, int row, int column) HWY_ATTR {
        return hn::LoadU(d, rows_.row(row, TileRows::kSurfelChannels + c + k) + column);
      };
      V v0 = w0, v1 = w1, v2 = w2, v3 = w3;
      if (part.shadowed) {
        const auto brightness_at = [&](int row, int column) HWY_ATTR {
          V value = mean_at(0, row, column);
          if (part.components == 3)
            value = value + mean_at(1, row, column) + mean_at(2, row, column);
          if (!ao_) return Brightness{value, value};
          const V ao = hn::LoadU(d, rows_.row(row, *ao_) + column);
          return Brightness{value, value / hn::Max(ao, hn::Set(d, kLeastOpen))};
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
        hn::Store(sum, d, results_.get() + (c + k) * stride + x);
      }
      c += part.components;
    }
  }

  const int offset_;
  const Tile tile_;
  TileRows rows_;
  std::optional<int> ao_;  ///< its channel
  AlignedFloats results_;  ///< by component and column; after the components 0 where no surface is
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
