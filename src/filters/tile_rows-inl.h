// SPDX-License-Identifier: Apache-2.0
//
// Rows of a tile, held apart by component for vector loops; compiled once for every instruction
// set.
#if defined(SSDO_FILTERS_TILE_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_FILTERS_TILE_ROWS_INL_H_
#undef SSDO_FILTERS_TILE_ROWS_INL_H_
#else
#define SSDO_FILTERS_TILE_ROWS_INL_H_
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/cache_control.h>

#include <algorithm>
#include <vector>

#include "estimators/estimator.h"
#include "parallel/tiles.h"
#include "scene/geometry.h"
#include "scene/surfel-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

using AlignedFloats = hwy::AlignedFreeUniquePtr<float[]>;

constexpr int kLine = kMostLanes;  ///< floats in a cache line

constexpr int round_up(int count, int unit) { return (count + unit - 1) / unit * unit; }

inline AlignedFloats zeros(int count) {
  AlignedFloats values = hwy::AllocateAligned<float>(std::size_t(count));
  std::fill_n(values.get(), count, 0.0f);
  return values;
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

/// What is done to an average.
enum class Finish { none, clamp, normalise };

/// A plane of one or three components per pixel.
struct Part {
  const float* noisy;
  float* out;
  int components;
  Finish finish;
  bool shadowed;  ///< steps of it are edges of shadows
};

/// Those planes that exist.
inline std::vector<Part> parts_of(const Products& noisy, Products& out) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  std::vector<Part> parts;
  const auto add = [&](const auto& from, auto& to, Finish finish, bool shadowed) {
    if (from.empty()) return;
    parts.push_back({reinterpret_cast<const float*>(from.pixels.data()),
                     reinterpret_cast<float*>(to.pixels.data()),
                     int(sizeof(from[0]) / sizeof(float)), finish, shadowed});
  };
  for_each_plane(
      [&](const Product& product, const auto& from, auto& to) {
        const Finish finish = product.kind == ProductKind::share       ? Finish::clamp
                              : product.kind == ProductKind::direction ? Finish::normalise
                                                                       : Finish::none;
        add(from, to, finish, product.shadowed);
      },
      noisy, out);
  // Several passes are one mean: shares are clamped after the last (shares.cpp).
  for_each_share(
      [&](const auto& from, auto& to) {
        const bool emitted = static_cast<const void*>(&from) == &noisy.shares.emitted;
        add(from, to, Finish::none, !emitted);
      },
      noisy, out);
  return parts;
}

/// What pixels side by side show. What is not a surface has no normal.
struct Shown {
  V3 position, normal;
  V rounding;
};

/// The latest rows of a tile and its halo. Channels 0 to 6 are the position, the normal and the
/// rounding of Surfel, the others are the components of the products; all are 0 for what is not a
/// surface, be it outside the picture.
class TileRows {
 public:
  static constexpr int kSurfelChannels = 7;

  /// Holds `height` rows; the halo is `half` pixels wide.
  TileRows(const Products& noisy, const Plane<Surfel>& surfel, const Tile& tile, int half,
           int height, Products& out)
      : surfel_(surfel),
        tile_(tile),
        half_(half),
        height_(height),
        parts_(parts_of(noisy, out)),
        stride_(round_up(round_up(tile.x1 - tile.x0, kLanes) + 2 * half, kLine)) {
    for (const Part& part : parts_) components_ += part.components;
    rows_ = zeros(height_ * channels() * stride_);
    surface_ = zeros(stride_);
  }

  const std::vector<Part>& parts() const { return parts_; }
  int components() const { return components_; }  ///< of all products
  int stride() const { return stride_; }          ///< from a channel to the next

  /// Channel `c` of picture row `y`; its entry 0 lies half a window left of the tile.
  const float* row(int y, int c) const { return rows_.get() + offset(y, c); }

  /// What row `y` shows from entry `x` on.
  HWY_INLINE Shown shown(int y, int x) const {
    const float* from = row(y, 0) + x;
    return {load_apart(from, stride_), load_apart(from + 3 * stride_, stride_),
            load(from + 6 * stride_)};
  }

  /// Takes row `y` in, in place of the row that was taken in `height` rows ago.
  void gather(int y) {
    float* to = rows_.get() + offset(y, 0);
    if (y < 0 || y >= surfel_.height) {
      std::fill_n(to, channels() * stride_, 0.0f);
      return;
    }
    const int left = tile_.x0 - half_, x0 = std::max(left, 0),
              count = std::min(tile_.x1 + half_, surfel_.width) - x0;
    const std::size_t first = surfel_.index(x0, y);
    if (y + kAhead < surfel_.height) fetch(surfel_.index(x0, y + kAhead), count);
    to += x0 - left;
    gather_surfels(&surfel_[first], count, to);
    to += kSurfelChannels * stride_;
    for (const Part& part : parts_) {
      gather_part(part, first, count, to);
      to += part.components * stride_;
    }
  }

  /// Writes row `y` of the tile from averages by component, which it finishes, and what is noisy
  /// where `weight` is 0.
  void write(int y, float* averages, const float* weight) const {
    const std::size_t first = surfel_.index(tile_.x0, y);
    const int count = tile_.x1 - tile_.x0;
    for (const Part& part : parts_) {
      finish(part.finish, averages, count);
      write_part(part, first, count, averages, weight);
      averages += part.components * stride_;
    }
  }

 private:
  static constexpr int kAhead = 2;  ///< rows; measured

  int channels() const { return kSurfelChannels + components_; }
  int offset(int y, int c) const {
    const int slot = (y - tile_.y0 + half_) % height_;
    return (slot * channels() + c) * stride_;
  }

  /// Tells the processor that these pixels are needed soon; a tile's rows are too short for it to
  /// find out. Inlined, as g++ 12 drops calls of a function that does nothing else.
  HWY_INLINE void fetch(std::size_t first, int count) const {
    const auto each_line = [](const float* from, int floats) {
      for (int i = 0; i < floats; i += kLine) hwy::Prefetch(from + i);
    };
    each_line(&surfel_[first].position.x, count * int(sizeof(Surfel) / sizeof(float)));
    for (const Part& part : parts_)
      each_line(part.noisy + first * std::size_t(part.components), count * part.components);
  }

  void gather_surfels(const Surfel* from, int count, float* to) {
    const auto single = [&](int i) {
      const glm::vec3 p = from[i].position, n = from[i].normal;
      const bool surface = from[i].is_surface();
      const float values[kSurfelChannels] = {p.x, p.y, p.z, n.x, n.y, n.z, from[i].rounding};
      surface_[std::size_t(i)] = surface;
      for (int c = 0; c < kSurfelChannels; ++c) to[c * stride_ + i] = surface ? values[c] : 0.0f;
    };
    const auto whole = [&](int i) HWY_ATTR {
      const Surfels q = load_surfels(from + i);
      store(hn::IfThenElseZero(q.surface, set(1)), surface_.get() + i);
      store_apart(if_then_else_zero(q.surface, q.position), stride_, to + i);
      store_apart(if_then_else_zero(q.surface, q.normal), stride_, to + 3 * stride_ + i);
      store(hn::IfThenElseZero(q.surface, q.rounding), to + 6 * stride_ + i);
    };
    cover(count, whole, single);
  }

  void gather_part(const Part& part, std::size_t first, int count, float* to) const {
    const float* from = part.noisy + first * std::size_t(part.components);
    const auto whole = [&](int i) HWY_ATTR {
      const M surface = load(surface_.get() + i) != set(0);
      float* at = to + i;
      if (part.components == 1) return store(hn::IfThenElseZero(surface, load(from + i)), at);
      store_apart(if_then_else_zero(surface, load3(from + 3 * i)), stride_, at);
    };
    cover(count, whole, [&](int i) {
      const bool surface = surface_[std::size_t(i)] != 0;
      for (int c = 0; c < part.components; ++c)
        to[c * stride_ + i] = surface ? from[i * part.components + c] : 0.0f;
    });
  }

  void finish(Finish how, float* averages, int count) const {
    if (how == Finish::none) return;
    for (int i = 0; i < count; i += kLanes) {
      float* at = averages + i;
      if (how == Finish::clamp) {
        store(saturate(load(at)), at);
      } else {
        store_apart(normalise(load_apart(at, stride_)), stride_, at);
      }
    }
  }

  void write_part(const Part& part, std::size_t first, int count, const float* from,
                  const float* weight) const {
    const float* noisy = part.noisy + first * std::size_t(part.components);
    float* to = part.out + first * std::size_t(part.components);
    const auto single = [&](int i) {
      for (int c = 0; c < part.components; ++c) {
        const int at = i * part.components + c;
        to[at] = weight[i] > 0 ? from[c * stride_ + i] : noisy[at];
      }
    };
    const auto whole = [&](int i) HWY_ATTR {
      if (!all(load(weight + i) > set(0))) {
        for (int k = i; k < i + kLanes; ++k) single(k);
      } else if (part.components == 1) {
        store(load(from + i), to + i);
      } else {
        store3(load_apart(from + i, stride_), to + 3 * i);
      }
    };
    cover(count, whole, single);
  }

  const Plane<Surfel>& surfel_;
  const Tile tile_;
  const int half_, height_;
  const std::vector<Part> parts_;
  const int stride_;
  int components_ = 0;
  AlignedFloats rows_;     ///< by row modulo the height, channel and column
  AlignedFloats surface_;  ///< 1 on a surface, of the row that is gathered
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
