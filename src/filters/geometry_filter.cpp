// SPDX-License-Identifier: Apache-2.0
//
// The geometry-aware blur of screen-space directional occlusion (Ritschel et al. 2009, section 5):
// a window of the pattern's size, weighted by how far a neighbour's position lies from the pixel's
// tangent plane and by how far their normals differ.
//
//   out(p) = sum_q b(q) w(p, q) in(q) / sum_q b(q) w(p, q)
//   w = ramp(|n_p . (q - p)| / (t |q - p|)) * ramp((1 - n_p . n_q) / (1 - c))
//   ramp(x) = 1 up to 1/2, falling to 0 at 1
//
// The first argument is the sine of the angle by which q leaves the tangent plane, so that the
// weight knows no unit and no resolution. The flat part matters: where a surface bends gently, all
// members of the pattern have to weigh the same, or the pattern shows through.
//
// The window is T + 1 wide, with b = 1/2 at its ends: each of the T x T members of the pattern
// then has a total weight of exactly 1, which removes the pattern on a plane, and the window has a
// centre, which T alone has not.
//
// Lanes are pixels that lie side by side. Of each tile the T + 1 rows that a window covers are held
// apart by component, so that a neighbour of a whole vector of pixels is one load; what is not a
// surface has no normal there, so that its weight is 0. This file is compiled once for every
// instruction set.
#include "filters/geometry_filter.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "parallel/isa.h"
#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/geometry_filter.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

constexpr float kPlaneTolerance = 0.3f;  ///< t: the sine of 17 degrees
constexpr float kNormalCosine = 0.8f;    ///< c: normals 37 degrees apart share nothing

constexpr int kLanes = int(hn::MaxLanes(D()));

/// What a pixel is compared by. `rounding`: see Surfel.
struct Lanes {
  V x, y, z, nx, ny, nz, rounding;
};
constexpr int kSurfelChannels = 7;

HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, az * bz));
}

HWY_INLINE V clamp01(V x) {
  const D d;
  return hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1.0f));
}

/// ramp(off_plane / (t distance)). Most neighbours lie in the flat part, which squares can tell.
HWY_INLINE V plane_ramp(V off_plane, V distance2) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  constexpr float kFlat = kPlaneTolerance / 2;
  if (hn::AllTrue(d, off_plane * off_plane <= distance2 * hn::Set(d, kFlat * kFlat))) return one;
  const V sine = off_plane / hn::Sqrt(distance2);
  return hn::IfThenElse(
      distance2 > hn::Zero(d),
      clamp01(hn::NegMulAdd(sine, hn::Set(d, 2 / kPlaneTolerance), hn::Set(d, 2.0f))), one);
}

/// w(p, q), 0 where one of them has no normal.
HWY_INLINE V similarity(const Lanes& p, const Lanes& q) {
  const D d;
  const V x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
  const V off_plane =
      hn::Max(hn::Zero(d), hn::Abs(dot3(x, y, z, p.nx, p.ny, p.nz)) - (p.rounding + q.rounding));
  // 2 - 2 (1 - cosine) / (1 - c)
  constexpr float kSlope = 2 / (1 - kNormalCosine);
  const V cosine = dot3(p.nx, p.ny, p.nz, q.nx, q.ny, q.nz);
  const V turn = clamp01(hn::MulAdd(cosine, hn::Set(d, kSlope), hn::Set(d, 2 - kSlope)));
  return turn * plane_ramp(off_plane, dot3(x, y, z, x, y, z));
}

/// Calls `whole(i)` for vectors that together cover entries 0 to count - 1, some of them twice;
/// `single(i)` for each entry where there are fewer than a vector holds.
template <class Whole, class Single>
HWY_INLINE void cover(int count, const Whole& whole, const Single& single) {
  if (count < kLanes) {
    for (int i = 0; i < count; ++i) single(i);
  } else {
    for (int i = 0; i < count; i += kLanes) whole(std::min(i, count - kLanes));
  }
}

enum class Finish { none, clamp, normalise };

/// A plane of one or three components per pixel.
struct Part {
  const float* noisy;
  float* out;
  int components;
  Finish finish;
};

std::vector<Part> parts_of(const Products& noisy, Products& out) {
  std::vector<Part> parts;
  const auto add = [&](const Plane<float>& from, Plane<float>& to, Finish finish) {
    if (!from.empty()) parts.push_back({from.pixels.data(), to.pixels.data(), 1, finish});
  };
  const auto add3 = [&](const Plane<glm::vec3>& from, Plane<glm::vec3>& to, Finish finish) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    if (!from.empty()) parts.push_back({&from.pixels[0].x, &to.pixels[0].x, 3, finish});
  };
  add3(noisy.direct, out.direct, Finish::none);
  add3(noisy.bounce, out.bounce, Finish::none);
  add3(noisy.bent, out.bent, Finish::normalise);
  add(noisy.ao, out.ao, Finish::clamp);
  add(noisy.error, out.error, Finish::none);
  return parts;
}

class TileFilter {
 public:
  TileFilter(const Products& noisy, const Geometry& geometry, int pattern_size, const Tile& tile,
             Products& out)
      : surfel_(geometry.surfel),
        half_(pattern_size / 2),
        tile_(tile),
        parts_(parts_of(noisy, out)),
        stride_((round_up(tile.x1 - tile.x0) + 2 * half_ + kLine - 1) / kLine * kLine) {
    for (const Part& part : parts_) products_ += part.components;
    rows_.resize(std::size_t(window()) * std::size_t(channels()) * std::size_t(stride_));
    weights_.resize(std::size_t(window() * window() * kLanes));
    result_.resize(std::size_t((products_ + 1) * stride_));
    surface_.resize(std::size_t(stride_));
  }

  void run() {
    for (int y = tile_.y0 - half_; y < tile_.y1 + half_; ++y) {
      gather(y);
      if (y - half_ < tile_.y0) continue;
      for (int x = 0; x < tile_.x1 - tile_.x0; x += kLanes) filter(x, y - half_);
      write(y - half_);
    }
  }

 private:
  static constexpr int kLine = 16;  ///< floats

  static int round_up(int count) { return (count + kLanes - 1) / kLanes * kLanes; }
  int window() const { return 2 * half_ + 1; }
  int channels() const { return kSurfelChannels + products_; }

  /// Channel `c` of picture row `y`; its entry 0 is half a window left of the tile.
  float* row(int y, int c) {
    const int slot = (y - tile_.y0 + half_) % window();
    return rows_.data() + (slot * channels() + c) * stride_;
  }
  float* result(int c) { return result_.data() + c * stride_; }

  void gather(int y) {
    if (y < 0 || y >= surfel_.height) {
      std::fill(row(y, 0), row(y, 0) + channels() * stride_, 0.0f);
      return;
    }
    const int x0 = std::max(tile_.x0 - half_, 0),
              count = std::min(tile_.x1 + half_, surfel_.width) - x0,
              left = x0 - (tile_.x0 - half_);
    const std::size_t first = surfel_.index(x0, y);
    gather_surfels(&surfel_[first], count, row(y, 0) + left);
    if (y + 2 < surfel_.height) {
      const std::size_t next = first + 2 * std::size_t(surfel_.width);
      const auto fetch = [](const float* p, int n) {
        for (int i = 0; i < n; i += kLine) hwy::Prefetch(p + i);
      };
      fetch(&surfel_[next].position.x, count * 8);
      for (const Part& part : parts_)
        fetch(part.noisy + next * std::size_t(part.components), count * part.components);
    }
    float* to = row(y, kSurfelChannels) + left;
    for (const Part& part : parts_) {
      gather_part(part, first, count, to);
      to += part.components * stride_;
    }
  }

  /// Components of 0 for what is not a surface.
  void gather_surfels(const Surfel* from, int count, float* to) {
    const auto single = [&](int i) {
      const Surfel& s = from[i];
      const bool surface = s.position.w != 0;
      const float values[kSurfelChannels] = {s.position.x, s.position.y, s.position.z, s.normal.x,
                                             s.normal.y,   s.normal.z,   s.normal.w};
      surface_[std::size_t(i)] = surface;
      for (int c = 0; c < kSurfelChannels; ++c) to[c * stride_ + i] = surface ? values[c] : 0.0f;
    };
#if HWY_TARGET == HWY_SCALAR
    for (int i = 0; i < count; ++i) single(i);
#else
    static_assert(sizeof(Surfel) == 8 * sizeof(float));
    const D d;
    cover(
        count,
        [&](int i) HWY_ATTR {
          // Position, normal, position, normal, ... of two halves of the vector.
          V x0, y0, z0, w0, x1, y1, z1, w1;
          hn::LoadInterleaved4(d, &from[i].position.x, x0, y0, z0, w0);
          hn::LoadInterleaved4(d, &from[i + kLanes / 2].position.x, x1, y1, z1, w1);
          const V w = hn::ConcatEven(d, w1, w0);
          const auto surface = w != hn::Zero(d);
          hn::StoreU(hn::IfThenElseZero(surface, hn::Set(d, 1.0f)), d, surface_.data() + i);
          const auto store = [&](V v, int c) HWY_ATTR {
            hn::StoreU(hn::IfThenElseZero(surface, v), d, to + c * stride_ + i);
          };
          store(hn::ConcatEven(d, x1, x0), 0);
          store(hn::ConcatEven(d, y1, y0), 1);
          store(hn::ConcatEven(d, z1, z0), 2);
          store(hn::ConcatOdd(d, x1, x0), 3);
          store(hn::ConcatOdd(d, y1, y0), 4);
          store(hn::ConcatOdd(d, z1, z0), 5);
          store(hn::ConcatOdd(d, w1, w0), 6);
        },
        single);
#endif
  }

  /// What is not a surface counts as 0, be it NaN.
  void gather_part(const Part& part, std::size_t first, int count, float* to) {
    const D d;
    const float* from = part.noisy + first * std::size_t(part.components);
    const auto single = [&](int i) {
      for (int c = 0; c < part.components; ++c)
        to[c * stride_ + i] = surface_[std::size_t(i)] != 0 ? from[i * part.components + c] : 0.0f;
    };
    cover(
        count,
        [&](int i) HWY_ATTR {
          const auto surface = hn::LoadU(d, surface_.data() + i) != hn::Zero(d);
          if (part.components == 1) {
            hn::StoreU(hn::IfThenElseZero(surface, hn::LoadU(d, from + i)), d, to + i);
          } else {
            V r, g, b;
            hn::LoadInterleaved3(d, from + 3 * i, r, g, b);
            hn::StoreU(hn::IfThenElseZero(surface, r), d, to + i);
            hn::StoreU(hn::IfThenElseZero(surface, g), d, to + stride_ + i);
            hn::StoreU(hn::IfThenElseZero(surface, b), d, to + 2 * stride_ + i);
          }
        },
        single);
  }

  HWY_INLINE Lanes load(const float* from) const {
    const D d;
    const auto channel = [&](int c) HWY_ATTR { return hn::LoadU(d, from + c * stride_); };
    return {channel(0), channel(1), channel(2), channel(3), channel(4), channel(5), channel(6)};
  }

  /// The results of the pixels from column `x` of the tile on.
  void filter(int x, int y) {
    const D d;
    const Lanes p = load(row(y, 0) + x + half_);
    V sum = hn::Zero(d);
    float* weight = weights_.data();
    for (int dy = -half_; dy <= half_; ++dy) {
      const float* from = row(y + dy, 0) + x;
      for (int dx = -half_; dx <= half_; ++dx) {
        const float border =
            (std::abs(dx) == half_ ? 0.5f : 1.0f) * (std::abs(dy) == half_ ? 0.5f : 1.0f);
        const V w = hn::Set(d, border) * similarity(p, load(from + half_ + dx));
        hn::StoreU(w, d, weight);
        weight += kLanes;
        sum = sum + w;
      }
    }
    hn::StoreU(sum, d, result(products_) + x);
    const V scale = hn::Set(d, 1.0f) / sum;
    int c = 0;
    for (; c + 4 <= products_; c += 4) average<4>(x, y, c, scale);
    if (products_ - c == 3) average<3>(x, y, c, scale);
    if (products_ - c == 2) average<2>(x, y, c, scale);
    if (products_ - c == 1) average<1>(x, y, c, scale);
  }

  template <int kCount>
  HWY_INLINE void average(int x, int y, int c, V scale) {
    const D d;
    V sum[kCount];
    for (V& s : sum) s = hn::Zero(d);
    const float* weight = weights_.data();
    for (int dy = -half_; dy <= half_; ++dy) {
      const float* from = row(y + dy, kSurfelChannels + c) + x;
      for (int dx = 0; dx < window(); ++dx) {
        const V w = hn::LoadU(d, weight);
        weight += kLanes;
        for (int k = 0; k < kCount; ++k)
          sum[k] = hn::MulAdd(w, hn::LoadU(d, from + k * stride_ + dx), sum[k]);
      }
    }
    for (int k = 0; k < kCount; ++k) hn::StoreU(sum[k] * scale, d, result(c + k) + x);
  }

  void write(int y) {
    const D d;
    const std::size_t first = surfel_.index(tile_.x0, y);
    const int count = tile_.x1 - tile_.x0;
    const float* weight = result(products_);
    int c = 0;
    for (const Part& part : parts_) {
      float* from = result(c);
      c += part.components;
      finish(part.finish, from, count);
      float* to = part.out + first * std::size_t(part.components);
      const auto single = [&](int i) {
        if (!(weight[i] > 0)) return;
        for (int k = 0; k < part.components; ++k)
          to[i * part.components + k] = from[k * stride_ + i];
      };
      cover(
          count,
          [&](int i) HWY_ATTR {
            if (!hn::AllTrue(d, hn::LoadU(d, weight + i) > hn::Zero(d))) {
              for (int k = i; k < i + kLanes; ++k) single(k);
            } else if (part.components == 1) {
              hn::StoreU(hn::LoadU(d, from + i), d, to + i);
            } else {
              hn::StoreInterleaved3(hn::LoadU(d, from + i), hn::LoadU(d, from + stride_ + i),
                                    hn::LoadU(d, from + 2 * stride_ + i), d, to + 3 * i);
            }
          },
          single);
    }
  }

  void finish(Finish how, float* values, int count) {
    const D d;
    if (how == Finish::none) return;
    for (int i = 0; i < count; i += kLanes) {
      const V x = hn::LoadU(d, values + i);
      if (how == Finish::clamp) {
        hn::StoreU(clamp01(x), d, values + i);
        continue;
      }
      float* second = values + stride_ + i;
      float* third = second + stride_;
      const V y = hn::LoadU(d, second), z = hn::LoadU(d, third), zero = hn::Zero(d);
      const V length2 = dot3(x, y, z, x, y, z);
      const V scale = hn::IfThenElse(length2 > zero, hn::Set(d, 1.0f) / hn::Sqrt(length2), zero);
      hn::StoreU(x * scale, d, values + i);
      hn::StoreU(y * scale, d, second);
      hn::StoreU(z * scale, d, third);
    }
  }

  const Plane<Surfel>& surfel_;
  const int half_;
  const Tile tile_;
  const std::vector<Part> parts_;
  const int stride_;
  int products_ = 0;            ///< components of all parts
  std::vector<float> rows_;     ///< by row modulo the window, channel and column
  std::vector<float> weights_;  ///< of a vector of pixels, by neighbour
  std::vector<float> result_;   ///< of a row, by component and column; then the sum of weights
  std::vector<float> surface_;  ///< 1 on a surface, of the row that is gathered
};

void filter_tile(const Products& noisy, const Geometry& geometry, int pattern_size,
                 const Tile& tile, Products& out) {
  TileFilter(noisy, geometry, pattern_size, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(filter_tile);

Products filter_geometry(const Products& noisy, const Geometry& geometry, int pattern_size) {
  choose_isa();
  Products out = noisy;
  for_each_tile(geometry.surfel.width, geometry.surfel.height, [&](const Tile& tile) {
    HWY_DYNAMIC_DISPATCH(filter_tile)(noisy, geometry, pattern_size, tile, out);
  });
  return out;
}

}  // namespace ssdo
#endif
