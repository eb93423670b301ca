// SPDX-License-Identifier: Apache-2.0
//
// The rays of a block of pixels, one from each; compiled once for every instruction set.
#if defined(SSDO_BITMASK_RAYS_OF_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_RAYS_OF_BLOCK_INL_H_
#undef SSDO_BITMASK_RAYS_OF_BLOCK_INL_H_
#else
#define SSDO_BITMASK_RAYS_OF_BLOCK_INL_H_
#endif

#include <hwy/aligned_allocator.h>

#include <algorithm>

#include "estimators/bitmask/rays/block-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What is known of each ray; see ray_traversal-inl.h. A ray is followed only if its `end` exceeds
/// its `from`.
enum class RayField {
  x,
  y,  ///< the receiver's pixel
  aside_x,
  aside_y,  ///< from its middle to the receiver
  step_x,
  step_y,
  nearing,
  a,
  b,
  rise_x,
  rise_y,
  growth,
  across_x,
  across_y,
  slope,
  from,        ///< t up to which nothing is in its way
  end,         ///< t where it leaves the frame, or the radius
  blocked_px,  ///< t of what it has met; negative: it has met nothing
  count
};

/// The numbers of all rays of a block, one RayField after another, by Block::first_of().
class RaysOfBlock {
 public:
  RaysOfBlock()
      : numbers_(hwy::AllocateAligned<float>(std::size_t(RayField::count) * Block::kPixels)) {
    std::fill_n(numbers_.get(), std::size_t(RayField::count) * Block::kPixels, 0.0f);
  }

  /// The numbers of a vector of pixels.
  HWY_INLINE V operator()(RayField which, int i) const { return load(first(which) + i); }
  HWY_INLINE void set_at(RayField which, int i, V value) { store(value, first(which) + i); }

  /// The numbers of single pixels.
  HWY_INLINE V of(RayField which, VI at) const { return gather(first(which), at); }
  float& of(RayField which, int at) { return first(which)[at]; }
  float of(RayField which, int at) const { return first(which)[at]; }

  /// All rays look for nothing, and have met nothing.
  HWY_INLINE void clear() {
    std::fill_n(first(RayField::from), Block::kPixels, 0.0f);
    std::fill_n(first(RayField::end), Block::kPixels, 0.0f);
    std::fill_n(first(RayField::blocked_px), Block::kPixels, -1.0f);
  }

 private:
  float* first(RayField which) const {
    return numbers_.get() + std::size_t(which) * std::size_t(Block::kPixels);
  }

  hwy::AlignedFreeUniquePtr<float[]> numbers_;
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
