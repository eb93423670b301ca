// SPDX-License-Identifier: Apache-2.0
//
// A vector of pixels that gather light, compiled once for every instruction set.
#if defined(SSDO_RECEIVER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_RECEIVER_INL_H_
#undef SSDO_RECEIVER_INL_H_
#else
#define SSDO_RECEIVER_INL_H_
#endif

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What every method knows of the pixels that gather. Camera space.
struct Receiver {
  V x, y;               ///< pixel of the raster
  V3 position, normal;  ///< unit normal
  M valid;              ///< lanes that show a surface
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
