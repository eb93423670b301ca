// SPDX-License-Identifier: Apache-2.0
//
// The polynomials of the real spherical harmonics, without the constants that make them
// orthonormal: once, for numbers and for vectors of numbers. Compiled once for every instruction
// set.
#if defined(SSDO_MATH_SPHERICAL_HARMONICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_MATH_SPHERICAL_HARMONICS_INL_H_
#undef SSDO_MATH_SPHERICAL_HARMONICS_INL_H_
#else
#define SSDO_MATH_SPHERICAL_HARMONICS_INL_H_
#endif

#include <hwy/highway.h>

#include "math/spherical_harmonics.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// a b + c, a b - c and c - a b of numbers, beside Highway's functions of vectors.
HWY_INLINE float MulAdd(float a, float b, float c) { return a * b + c; }
HWY_INLINE float MulSub(float a, float b, float c) { return a * b - c; }
HWY_INLINE float NegMulAdd(float a, float b, float c) { return c - a * b; }

/// Calls `add(i, value)` for the functions of the bands kFirst to kLast in the unit directions
/// (x, y, z); i is l * l + l + m. `set` makes a T of a float.
template <int kFirst, int kLast, class T, class Set, class Add>
HWY_INLINE void for_each_sh_polynomial(T x, T y, T z, const Set& set, const Add& add) {
  static_assert(kLast <= kShOrder);
  if constexpr (kFirst == 0) add(0, set(1));
  if constexpr (kFirst <= 1 && kLast >= 1) add(1, y), add(2, z), add(3, x);
  // Cosine and sine of m times the azimuth, times sin(polar)^m; sin2 has half of that value.
  const T xx = x * x, yy = y * y, zz = z * z;
  const T sin2 = x * y, cos2 = xx - yy;
  const T sin3_over_y = MulSub(set(3), xx, yy), cos3_over_x = NegMulAdd(set(3), yy, xx);
  if constexpr (kFirst <= 2 && kLast >= 2) {
    add(4, sin2), add(5, y * z), add(6, MulSub(set(3), zz, set(1))), add(7, x * z), add(8, cos2);
  }
  if constexpr (kFirst <= 3 && kLast >= 3) {
    const T z5 = MulSub(set(5), zz, set(1));
    add(9, y * sin3_over_y), add(10, sin2 * z), add(11, y * z5);
    add(12, z * MulSub(set(5), zz, set(3))), add(13, x * z5), add(14, z * cos2);
    add(15, x * cos3_over_x);
  }
  if constexpr (kFirst <= 4 && kLast >= 4) {
    const T z71 = MulSub(set(7), zz, set(1)), z73 = z * MulSub(set(7), zz, set(3));
    add(16, sin2 * cos2), add(17, y * sin3_over_y * z), add(18, sin2 * z71), add(19, y * z73);
    add(20, MulAdd(MulSub(set(35), zz, set(30)), zz, set(3)));
    add(21, x * z73), add(22, cos2 * z71), add(23, x * cos3_over_x * z);
    add(24, xx * cos3_over_x - yy * sin3_over_y);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
