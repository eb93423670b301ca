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

#include "filters/filter_planes.h"
#include "parallel/tiles.h"
#include "scene/surfaces.h"
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

/// A plane that is read: the components of one pixel after the other.
struct PlaneView {
  const float* values;
  int components;
};

inline std::vector<PlaneView> views_of(const FilterPlanes& planes) {
  std::vector<PlaneView> views;
  for (const FilterPlane& plane : planes) views.push_back({plane.values(), plane.components()});
  return views;
}

/// What pixels side by side show. What is not a surface has no normal.
struct Shown {
  V3 position, normal;
  V rounding;
};

/// The latest rows of a tile and its halo. Channels 0 to 6 are the position, the normal and the
/// rounding of Surfel, the others are the components of the planes; all are 0 for what is not a
/// surface, be it outside the picture.
class TileRows {
 public:
  static constexpr int kRounding = 6, kSurfelChannels = 7;

  /// Holds `height` rows; the halo is `half` pixels wide.
  TileRows(std::vector<PlaneView> noisy, const Surfaces& guide, const Tile& tile, int half,
           int height)
      : guide_(guide),
        tile_(tile),
        half_(half),
        height_(height),
        planes_(std::move(noisy)),
        stride_(round_up(round_up(tile.x1 - tile.x0, kLanes) + 2 * half, kLine)) {
    for (const PlaneView& plane : planes_) components_ += plane.components;
    rows_ = zeros(height_ * channels() * stride_);
    surface_ = zeros(stride_);
  }

  int components() const { return components_; }  ///< of all planes
  int stride() const { return stride_; }          ///< from a channel to the next

  /// Channel `c` of picture row `y`; its entry 0 lies half a window left of the tile.
  const float* row(int y, int c) const { return rows_.get() + offset(y, c); }

  /// What row `y` shows from entry `x` on.
  HWY_INLINE Shown shown(int y, int x) const {
    const float* from = row(y, 0) + x;
    return {load_apart(from, stride_), load_apart(from + 3 * stride_, stride_),
            load(from + kRounding * stride_)};
  }

  /// Takes row `y` in, in place of the row that was taken in `height` rows ago.
  void gather(int y) {
    float* to = rows_.get() + offset(y, 0);
    if (y < 0 || y >= guide_.height) {
      std::fill_n(to, channels() * stride_, 0.0f);
      return;
    }
    const int left = tile_.x0 - half_, x0 = std::max(left, 0),
              count = std::min(tile_.x1 + half_, guide_.width) - x0;
    const std::size_t first = guide_.index(x0, y);
    if (y + kAhead < guide_.height) fetch(guide_.index(x0, y + kAhead), count);
    to += x0 - left;
    gather_surfels(first, count, to);
    to += kSurfelChannels * stride_;
    for (const PlaneView& plane : planes_) {
      gather_plane(plane, first, count, to);
      to += plane.components * stride_;
    }
  }

  /// Writes row `y` of the tile to `out`, whose planes are like those that are read. Applies
  /// Filtering::finish to `averages` (by component); a pixel whose `weight` is 0 keeps its value.
  void write(int y, float* averages, const float* weight, FilterPlanes& out) const {
    const std::size_t first = guide_.index(tile_.x0, y);
    const int count = tile_.x1 - tile_.x0;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      const std::size_t at = first * std::size_t(planes_[k].components);
      finish(out[k].filtering.finish, averages, count);
      write_plane({planes_[k].values + at, planes_[k].components}, out[k].values() + at, count,
                  averages, weight);
      averages += planes_[k].components * stride_;
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
    for (const auto* planes : {&guide_.position, &guide_.normal})
      for (const Plane<float>& plane : *planes) each_line(&plane[first], count);
    each_line(&guide_.rounding[first], count);
    for (const PlaneView& plane : planes_)
      each_line(plane.values + first * std::size_t(plane.components), count * plane.components);
  }

  void gather_surfels(std::size_t first, int count, float* to) {
    const float* const from[kSurfelChannels] = {
        &guide_.position[0][first], &guide_.position[1][first], &guide_.position[2][first],
        &guide_.normal[0][first],   &guide_.normal[1][first],   &guide_.normal[2][first],
        &guide_.rounding[first]};
    const auto single = [&](int i) {
      const bool surface = from[kRounding][i] >= 0;
      surface_[std::size_t(i)] = surface;
      for (int c = 0; c < kSurfelChannels; ++c) to[c * stride_ + i] = surface ? from[c][i] : 0.0f;
    };
    const auto whole = [&](int i) HWY_ATTR {
      const M surface = load(from[kRounding] + i) >= set(0);
      store(hn::IfThenElseZero(surface, set(1)), surface_.get() + i);
      for (int c = 0; c < kSurfelChannels; ++c)
        store(hn::IfThenElseZero(surface, load(from[c] + i)), to + c * stride_ + i);
    };
    cover(count, whole, single);
  }

  void gather_plane(const PlaneView& plane, std::size_t first, int count, float* to) const {
    const float* from = plane.values + first * std::size_t(plane.components);
    const auto whole = [&](int i) HWY_ATTR {
      const M surface = load(surface_.get() + i) != set(0);
      float* at = to + i;
      if (plane.components == 1) return store(hn::IfThenElseZero(surface, load(from + i)), at);
      store_apart(if_then_else_zero(surface, load3(from + 3 * i)), stride_, at);
    };
    cover(count, whole, [&](int i) {
      const bool surface = surface_[std::size_t(i)] != 0;
      for (int c = 0; c < plane.components; ++c)
        to[c * stride_ + i] = surface ? from[i * plane.components + c] : 0.0f;
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

  void write_plane(const PlaneView& noisy, float* to, int count, const float* from,
                   const float* weight) const {
    const auto single = [&](int i) {
      for (int c = 0; c < noisy.components; ++c) {
        const int at = i * noisy.components + c;
        to[at] = weight[i] > 0 ? from[c * stride_ + i] : noisy.values[at];
      }
    };
    const auto whole = [&](int i) HWY_ATTR {
      if (!all(load(weight + i) > set(0))) {
        for (int k = i; k < i + kLanes; ++k) single(k);
      } else if (noisy.components == 1) {
        store(load(from + i), to + i);
      } else {
        store3(load_apart(from + i, stride_), to + 3 * i);
      }
    };
    cover(count, whole, single);
  }

  const Surfaces& guide_;
  const Tile tile_;
  const int half_, height_;
  const std::vector<PlaneView> planes_;
  const int stride_;
  int components_ = 0;
  AlignedFloats rows_;     ///< by row modulo the height, channel and column
  AlignedFloats surface_;  ///< 1 on a surface, of the row that is gathered
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
