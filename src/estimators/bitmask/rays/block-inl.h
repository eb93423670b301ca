// SPDX-License-Identifier: Apache-2.0
//
// Pixels whose rays are on their way together; compiled once for every instruction set.
#if defined(SSDO_BITMASK_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_BLOCK_INL_H_
#undef SSDO_BITMASK_BLOCK_INL_H_
#else
#define SSDO_BITMASK_BLOCK_INL_H_
#endif

#include <algorithm>

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A vector of pixels wide and kRows high, or what of that is in a part of the raster.
struct Block {
  static constexpr int kRows = 4, kWidth = Interleaving::kPeriod * kLanes, kPixels = kRows * kWidth;

  Window part;

  /// The first of the numbers that the pixels of a vector have in their order in memory.
  HWY_INLINE int first_of(const Place& at) const {
    return ((at.y - part.y0) * Interleaving::kPeriod + at.column_phase) * kLanes;
  }

  /// The k-th pixel of an order in which those of squares of kRows x kRows follow on each other, by
  /// first_of().
  static int in_squares(int k) {
    constexpr int kSquare = kRows * kRows, kInLane = kPixels / kLanes;
    const int in_lane = k % kInLane, row = in_lane % kSquare / kRows,
              column_phase = in_lane / kSquare * kRows + in_lane % kRows;
    return (row * Interleaving::kPeriod + column_phase) * kLanes + k / kInLane;
  }
};

/// Numbers of the pixels of a block, by Block::first_of().
struct BlockValues {
  alignas(64) float values[Block::kPixels];

  HWY_INLINE V operator()(int i) const { return load(values + i); }
  HWY_INLINE void set_at(int i, V value) { store(value, values + i); }
};
struct BlockVectors {
  BlockValues x, y, z;

  HWY_INLINE V3 operator()(int i) const { return {x(i), y(i), z(i)}; }
  HWY_INLINE void set_at(int i, const V3& v) {
    x.set_at(i, v.x), y.set_at(i, v.y), z.set_at(i, v.z);
  }
};

/// Calls `work(block)` for the blocks of a part of the raster.
template <class Work>
HWY_INLINE void for_each_block(const MarchScene& scene, const Window& part, const Work& work) {
  const int phase = scene.layout.phase(), first = ((part.x0 + phase) & -Block::kWidth) - phase;
  for (int y = part.y0; y < part.y1; y += Block::kRows) {
    for (int x = first; x < part.x1; x += Block::kWidth) {
      work(Block{{std::max(x, part.x0), y, std::min(x + Block::kWidth, part.x1),
                  std::min(y + Block::kRows, part.y1)}});
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
