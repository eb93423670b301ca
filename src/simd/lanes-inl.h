// SPDX-License-Identifier: Apache-2.0
//
// The vocabulary of vector loops: numbers and vectors of three, one per lane, with the functions
// that shading languages have. Compiled once for every instruction set; include it after
// <hwy/foreach_target.h>. The width follows the instruction set: one lane in the scalar build,
// which is the reference of the others.
#if defined(SSDO_SIMD_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_LANES_INL_H_
#undef SSDO_SIMD_LANES_INL_H_
#else
#define SSDO_SIMD_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <glm/vec3.hpp>

#include "math/light_range.h"
#include "math/luminance.h"
#include "simd/width.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, kMostLanes>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;    ///< a float per lane
using VI = hn::Vec<DI>;  ///< an int per lane
using VU = hn::Vec<DU>;  ///< 32 bits per lane
using M = hn::Mask<D>;   ///< a condition per lane

constexpr int kLanes = int(hn::MaxLanes(D()));

HWY_INLINE V set(float value) { return hn::Set(D(), value); }
HWY_INLINE VI set_int(int value) { return hn::Set(DI(), value); }
HWY_INLINE VU set_bits(unsigned value) { return hn::Set(DU(), value); }

/// 0, 1, 2, ... from `first` on.
HWY_INLINE V iota(float first) { return hn::Iota(D(), first); }

/// Values side by side in memory, one for each lane.
HWY_INLINE V load(const float* from) { return hn::LoadU(D(), from); }
HWY_INLINE void store(V values, float* to) { hn::StoreU(values, D(), to); }

/// from[index], an index for each lane.
HWY_INLINE V gather(const float* from, VI index) { return hn::GatherIndex(D(), from, index); }

/// Four values per lane.
struct V4 {
  V x, y, z, w;
};

#if HWY_TARGET != HWY_SCALAR
/// Four values from each of the places at[0], at[4], at[8], ... on, a block of the vector for each.
template <class Tag>
HWY_INLINE hn::Vec<Tag> blocks_from(Tag d, const float* from, const int* at) {
  if constexpr (hn::MaxLanes(Tag()) <= 4) {
    return hn::LoadU(d, from + *at);
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(d, blocks_from(half, from, at + hn::MaxLanes(half)),
                       blocks_from(half, from, at));
  }
}
#endif

/// from[index] to from[index + 3], side by side: a load for each lane and a transposition, where
/// gather() looks up each value by itself.
HWY_INLINE V4 gather4(const float* from, VI index) {
#if HWY_TARGET == HWY_SCALAR
  const float* at = from + hn::GetLane(index);
  return {set(at[0]), set(at[1]), set(at[2]), set(at[3])};
#else
  const D d;
  alignas(64) int at[kLanes];
  hn::Store(index, DI(), at);
  const V r0 = blocks_from(d, from, at), r1 = blocks_from(d, from, at + 1),
          r2 = blocks_from(d, from, at + 2), r3 = blocks_from(d, from, at + 3);
  const hn::Repartition<double, D> pairs;
  const auto xy01 = hn::BitCast(pairs, hn::InterleaveLower(d, r0, r1)),
             xy23 = hn::BitCast(pairs, hn::InterleaveLower(d, r2, r3)),
             zw01 = hn::BitCast(pairs, hn::InterleaveUpper(d, r0, r1)),
             zw23 = hn::BitCast(pairs, hn::InterleaveUpper(d, r2, r3));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, xy01, xy23)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, xy01, xy23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, zw01, zw23)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, zw01, zw23))};
#endif
}

HWY_INLINE bool any(M m) { return !hn::AllFalse(D(), m); }
HWY_INLINE bool all(M m) { return hn::AllTrue(D(), m); }

/// Whether no bit is set in any lane.
HWY_INLINE bool none(VU bits) { return hn::AllTrue(DU(), bits == set_bits(0)); }

HWY_INLINE V saturate(V x) { return hn::Min(hn::Max(x, set(0)), set(1)); }

/// t^2 (3 - 2t), t in 0..1.
HWY_INLINE V smooth(V t) { return t * t * hn::NegMulAdd(set(2), t, set(3)); }

/// From 0 at `from` to 1 at `to`, as in GLSL.
HWY_INLINE V smoothstep(V from, V to, V x) { return smooth(saturate((x - from) / (to - from))); }

/// 1 / sqrt(x). The processor's estimate would make a march a twentieth faster, but with AVX2 it
/// differs between makers of processors.
HWY_INLINE V reciprocal_sqrt(V x) { return set(1) / hn::Sqrt(x); }

/// A place in a plane.
struct V2 {
  V x, y;
};

HWY_INLINE V dot(const V2& a, const V2& b) { return hn::MulAdd(a.x, b.x, a.y * b.y); }

/// A point, a direction, or a colour with red in x.
struct V3 {
  V x, y, z;
};

HWY_INLINE V3 set(const glm::vec3& v) { return {set(v.x), set(v.y), set(v.z)}; }

HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator-(const V3& a) { return {hn::Neg(a.x), hn::Neg(a.y), hn::Neg(a.z)}; }
HWY_INLINE V3 operator*(const V3& a, V s) { return {a.x * s, a.y * s, a.z * s}; }
HWY_INLINE V3 operator/(const V3& a, V s) { return {a.x / s, a.y / s, a.z / s}; }

/// Channel by channel.
HWY_INLINE V3 operator*(const V3& a, const V3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// a s + b
HWY_INLINE V3 mul_add(const V3& a, V s, const V3& b) {
  return {hn::MulAdd(a.x, s, b.x), hn::MulAdd(a.y, s, b.y), hn::MulAdd(a.z, s, b.z)};
}
HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, a.z * b.z));
}
HWY_INLINE V3 cross(const V3& a, const V3& b) {
  return {hn::MulSub(a.y, b.z, a.z * b.y), hn::MulSub(a.z, b.x, a.x * b.z),
          hn::MulSub(a.x, b.y, a.y * b.x)};
}

HWY_INLINE V3 if_then_else(M m, const V3& yes, const V3& no) {
  return {hn::IfThenElse(m, yes.x, no.x), hn::IfThenElse(m, yes.y, no.y),
          hn::IfThenElse(m, yes.z, no.z)};
}
HWY_INLINE V3 if_then_else_zero(M m, const V3& yes) {
  return {hn::IfThenElseZero(m, yes.x), hn::IfThenElseZero(m, yes.y), hn::IfThenElseZero(m, yes.z)};
}

HWY_INLINE V3 saturate(const V3& v) { return {saturate(v.x), saturate(v.y), saturate(v.z)}; }

/// Unit vector; 0 of 0.
HWY_INLINE V3 normalise(const V3& a) {
  const V length2 = dot(a, a);
  return a * hn::IfThenElseZero(length2 > set(0), set(1) / hn::Sqrt(length2));
}

/// What is left of `a` across the unit vector `n`, made unit: Gram-Schmidt.
HWY_INLINE V3 unit_across(const V3& a, const V3& n) {
  return normalise(mul_add(n, hn::Neg(dot(a, n)), a));
}

/// luminance() of math/luminance.h
HWY_INLINE V luminance(const V3& color) {
  return dot(set(glm::vec3(kLumaRed, kLumaGreen, kLumaBlue)), color);
}

/// within_range() of math/light_range.h
HWY_INLINE V within_range(V light) {
  const V clamped = hn::Min(hn::Max(light, set(-kBrightest)), set(kBrightest));
  return hn::IfThenElseZero(light == light, clamped);
}
HWY_INLINE V3 within_range(const V3& light) {
  return {within_range(light.x), within_range(light.y), within_range(light.z)};
}

/// Vectors side by side in memory, x, y, z, x, y, z, ...
HWY_INLINE V3 load3(const float* from) {
  V3 values;
  hn::LoadInterleaved3(D(), from, values.x, values.y, values.z);
  return values;
}
HWY_INLINE void store3(const V3& values, float* to) {
  hn::StoreInterleaved3(values.x, values.y, values.z, D(), to);
}
static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
HWY_INLINE V3 load(const glm::vec3* from) { return load3(&from->x); }
HWY_INLINE void store(const V3& values, glm::vec3* to) { store3(values, &to->x); }

/// Vectors whose coordinates lie in rows, `stride` floats apart.
HWY_INLINE V3 load_apart(const float* from, std::ptrdiff_t stride) {
  return {load(from), load(from + stride), load(from + 2 * stride)};
}
HWY_INLINE void store_apart(const V3& values, std::ptrdiff_t stride, float* to) {
  store(values.x, to), store(values.y, to + stride), store(values.z, to + 2 * stride);
}

/// Reads the first `count` lanes, or all where there are fewer; 0 in the others.
template <class T>
HWY_INLINE auto load_first(int count, const T* from) {
  if (count >= kLanes) return load(from);
  T values[kLanes] = {};
  for (int i = 0; i < count; ++i) values[i] = from[i];
  return load(values);
}

/// Writes the first `count` lanes, or all where there are fewer.
template <class Values, class T>
HWY_INLINE void store_first(int count, const Values& values, T* to) {
  if (count >= kLanes) return store(values, to);
  T all_values[kLanes];
  store(values, all_values);
  for (int i = 0; i < count; ++i) to[i] = all_values[i];
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
