// SPDX-License-Identifier: Apache-2.0
//
// What methods do with a vector of pixels of ViewPlanes, compiled once for every instruction set.
// Lanes are pixels that lie side by side in a row.
#if defined(SSDO_VIEW_SPACE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_VIEW_SPACE_LANES_INL_H_
#undef SSDO_VIEW_SPACE_LANES_INL_H_
#else
#define SSDO_VIEW_SPACE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <glm/vec3.hpp>

#include "estimators/view_space/tiled_noise.h"
#include "estimators/view_space/view_planes.h"
#include "parallel/tiles.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, PaddedLayout::kPad>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
using M = hn::Mask<D>;

HWY_INLINE V set(float value) { return hn::Set(D(), value); }

struct V3 {
  V x, y, z;
};

HWY_INLINE V3 operator+(const V3& a, const V3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE V3 operator-(const V3& a, const V3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE V3 operator*(const V3& a, V s) { return {a.x * s, a.y * s, a.z * s}; }

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
/// Unit vector; 0 of 0.
HWY_INLINE V3 normalise(const V3& a) {
  const V length2 = dot(a, a);
  return a * hn::IfThenElseZero(length2 > set(0), set(1) / hn::Sqrt(length2));
}

/// What is left of `a` across the unit vector `n`, made unit: Gram-Schmidt.
HWY_INLINE V3 unit_across(const V3& a, const V3& n) {
  return normalise(mul_add(n, hn::Neg(dot(a, n)), a));
}

HWY_INLINE V saturate(V x) { return hn::Min(hn::Max(x, set(0)), set(1)); }

/// t^2 (3 - 2t), t = 0..1 from `from` to `to`, as in GLSL.
HWY_INLINE V smoothstep(V from, V to, V x) {
  const V t = saturate((x - from) / (to - from));
  return t * t * hn::NegMulAdd(set(2), t, set(3));
}

/// Lanes of pixels that gather. Lanes that are not valid hold a point in front of the viewer and a
/// normal of 0, so that arithmetic on them stays finite.
struct Receivers {
  V3 position, normal;
  V rounding;
  M valid;
};

HWY_INLINE V3 along_ray(const ViewPlanes& planes, V ray_x, V ray_y, V z) {
  if (planes.orthographic) return {ray_x, ray_y, z};
  return {ray_x * z, ray_y * z, z};
}

/// The pixel (x, y) and those to its right. May reach beyond the frame by less than a vector.
HWY_INLINE Receivers load_receivers(const ViewPlanes& planes, int x, int y) {
  const D d;
  Receivers p;
  const V z = hn::LoadU(d, planes.z.row(y) + x);
  p.valid = z > set(kBackgroundDepth);
  p.position = along_ray(planes, hn::LoadU(d, planes.ray_x() + x), set(planes.ray_y()[y]),
                         hn::IfThenElse(p.valid, z, set(-1)));
  p.normal = {hn::LoadU(d, planes.nx.row(y) + x), hn::LoadU(d, planes.ny.row(y) + x),
              hn::LoadU(d, planes.nz.row(y) + x)};
  p.rounding = hn::LoadU(d, planes.rounding.row(y) + x);
  return p;
}

/// The unit direction from each surface to the viewer.
HWY_INLINE V3 direction_to_viewer(const ViewPlanes& planes, int x, int y) {
  if (planes.orthographic) return {set(0), set(0), set(1)};
  return normalise({hn::LoadU(D(), planes.ray_x() + x), set(planes.ray_y()[y]), set(1)});
}

/// A pixel for each lane, and whether the frame has it. Where it has not, it is the pixel (0, 0).
struct Pixels {
  VI column, row;
  M inside;
};

/// The pixels in which the places (x, y) of the picture lie; not-a-number lies in none.
HWY_INLINE Pixels pixels_at(const ViewPlanes& planes, V x, V y) {
  const DI di;
  const V zero = set(0);
  const M inside = hn::And(hn::And(x >= zero, y >= zero), hn::And(x < set(float(planes.width())),
                                                                  y < set(float(planes.height()))));
  return {hn::ConvertTo(di, hn::IfThenElseZero(inside, x)),
          hn::ConvertTo(di, hn::IfThenElseZero(inside, y)), inside};
}

/// The pixels that show the camera-space points `p`, hidden or not. What is not in front of the
/// viewer is outside.
HWY_INLINE Pixels project(const ViewPlanes& planes, const V3& p) {
  const V w = planes.orthographic ? set(1) : set(-1) / p.z;
  // Whole pixels of the display window first: a crop then rounds like the whole.
  const V x = hn::Floor(hn::MulAdd(set(planes.fx), p.x * w, set(planes.cx)));
  const V y = hn::Floor(hn::NegMulAdd(set(planes.fy), p.y * w, set(planes.cy)));
  Pixels pixels =
      pixels_at(planes, x - set(float(planes.first_column)), y - set(float(planes.first_row)));
  pixels.inside = hn::And(pixels.inside, p.z < set(0));
  return pixels;
}

/// Values of a plane of the frame; `outside` where the frame has no such pixel.
HWY_INLINE V gather(const ViewPlanes& planes, const PaddedPlane& plane, const Pixels& at,
                    float outside) {
  const VI index = at.row * hn::Set(DI(), int(planes.layout.stride)) + at.column;
  return hn::IfThenElse(at.inside, hn::GatherIndex(D(), plane.row(0), index), set(outside));
}

/// Outside the frame is background.
HWY_INLINE V gather_depth(const ViewPlanes& planes, const Pixels& at) {
  return gather(planes, planes.z, at, kBackgroundDepth);
}

/// The position at depth `z` in the centre of a pixel. Not finite on background.
HWY_INLINE V3 position_at(const ViewPlanes& planes, const Pixels& at, V z) {
  const D d;
  return along_ray(planes, hn::GatherIndex(d, planes.ray_x(), at.column),
                   hn::GatherIndex(d, planes.ray_y(), at.row), z);
}

/// Lanes of pixels that look at surfaces some whole pixels away.
struct Viewed {
  Receivers p;
  V column, row, ray_x, ray_y;
};

HWY_INLINE Viewed view_from(const ViewPlanes& planes, int x, int y) {
  const D d;
  return {load_receivers(planes, x, y), hn::Iota(d, float(x)), set(float(y)),
          hn::LoadU(d, planes.ray_x() + x), set(planes.ray_y()[y])};
}

/// From each receiver to the surface at depth `z` so many pixels away. From differences, which
/// loses less than to subtract positions. Not finite on background.
HWY_INLINE V3 way_to(const ViewPlanes& planes, const Viewed& from, V right, V down, V z) {
  const V deeper = z - from.p.position.z;
  V3 way{right * set(planes.slope_x), down * set(planes.slope_y), deeper};
  if (!planes.orthographic) {
    way.x = hn::MulAdd(way.x, z, from.ray_x * deeper);
    way.y = hn::MulAdd(way.y, z, from.ray_y * deeper);
  }
  return way;
}

/// The frame of a point kernel's half-ball: about the normal, turned to a pattern's vector.
struct TangentFrame {
  V3 tangent, bitangent, normal;

  /// What is (x, y, z) in the half-ball, from `origin`.
  HWY_INLINE V3 place(const glm::vec3& s, const V3& origin) const {
    return mul_add(tangent, set(s.x),
                   mul_add(bitangent, set(s.y), mul_add(normal, set(s.z), origin)));
  }
};

/// The vector is (noise_x, noise_y, 0); Gram-Schmidt.
HWY_INLINE TangentFrame tangent_frame(const ViewPlanes& planes, const TiledNoise& noise_x,
                                      const TiledNoise& noise_y, int x, int y, const V3& normal) {
  const D d;
  const V3 noise{hn::LoadU(d, noise_x.at(planes, x, y)), hn::LoadU(d, noise_y.at(planes, x, y)),
                 set(0)};
  const V3 tangent = unit_across(noise, normal);
  return {tangent, cross(normal, tangent), normal};
}

/// Calls work(x, y) for each vector of pixels of a tile in which there is a surface.
template <class Work>
HWY_INLINE void for_each_vector(const ViewPlanes& planes, const Tile& tile, const Work& work) {
  const D d;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += int(hn::Lanes(d))) {
      if (!hn::AllFalse(d, hn::LoadU(d, planes.z.row(y) + x) > set(kBackgroundDepth))) work(x, y);
    }
  }
}

/// Reads the lanes that lie in a tile, from pixel x of a row on; `row` needs no padding.
HWY_INLINE V load_pixels(const float* row, int x, const Tile& tile) {
  const D d;
  if (x + int(hn::Lanes(d)) <= tile.x1) return hn::LoadU(d, row + x);
  HWY_ALIGN float all[PaddedLayout::kPad] = {};
  for (int i = 0; x + i < tile.x1; ++i) all[i] = row[x + i];
  return hn::Load(d, all);
}

/// The same of vectors.
HWY_INLINE V3 load_vectors(const glm::vec3* row, int x, const Tile& tile) {
  const D d;
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  HWY_ALIGN float all[3 * PaddedLayout::kPad] = {};
  const float* from = all;
  if (x + int(hn::Lanes(d)) <= tile.x1) {
    from = &row[x].x;
  } else {
    for (int i = 0; x + i < tile.x1; ++i)
      for (int c = 0; c < 3; ++c) all[3 * i + c] = row[x + i][c];
  }
  V3 values;
  hn::LoadInterleaved3(d, from, values.x, values.y, values.z);
  return values;
}

/// Writes the lanes that lie in a tile, from pixel x of a row on; `row` needs no padding.
HWY_INLINE void store_pixels(V values, int x, const Tile& tile, float* row) {
  const D d;
  const int lanes = int(hn::Lanes(d));
  if (x + lanes <= tile.x1) return hn::StoreU(values, d, row + x);
  HWY_ALIGN float all[PaddedLayout::kPad];
  hn::Store(values, d, all);
  for (int i = 0; x + i < tile.x1; ++i) row[x + i] = all[i];
}

/// The same of vectors.
HWY_INLINE void store_vectors(const V3& values, int x, const Tile& tile, glm::vec3* row) {
  const D d;
  const int lanes = int(hn::Lanes(d));
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  if (x + lanes <= tile.x1)
    return hn::StoreInterleaved3(values.x, values.y, values.z, d, &row[x].x);
  HWY_ALIGN float all[3 * PaddedLayout::kPad];
  hn::StoreInterleaved3(values.x, values.y, values.z, d, all);
  for (int i = 0; x + i < tile.x1; ++i) row[x + i] = {all[3 * i], all[3 * i + 1], all[3 * i + 2]};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
