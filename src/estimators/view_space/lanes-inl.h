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

#include "estimators/receiver-inl.h"
#include "estimators/view_space/tiled_noise.h"
#include "estimators/view_space/view_planes.h"
#include "parallel/tiles.h"
#include "scene/surfaces-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Receivers among ViewPlanes. Lanes that are not valid hold a point in front of the viewer and a
/// normal of 0, so that arithmetic on them stays finite.
struct ViewReceiver : Receiver {
  V rounding;      ///< distance by which storing P may have moved the position
  V ray_x, ray_y;  ///< of the ray through the pixel, as ViewPlanes has them
};

/// The same of a vector of depths of ViewPlanes.
HWY_INLINE M shows_surface(V z) { return z > set(kBackgroundDepth); }

HWY_INLINE V3 along_ray(const ViewPlanes& planes, V ray_x, V ray_y, V z) {
  if (planes.orthographic) return {ray_x, ray_y, z};
  return {ray_x * z, ray_y * z, z};
}

/// The pixel (x, y) and those to its right. May reach beyond the frame by less than a vector.
HWY_INLINE ViewReceiver load_receiver(const ViewPlanes& planes, int x, int y) {
  ViewReceiver p;
  const V z = load(planes.z.row(y) + x);
  p.valid = shows_surface(z);
  p.ray_x = load(planes.ray_x() + x), p.ray_y = set(planes.ray_y()[y]);
  p.position = along_ray(planes, p.ray_x, p.ray_y, hn::IfThenElse(p.valid, z, set(-1)));
  const Surfels shown = surfels_at(planes.surfaces, x, y);
  p.normal = if_then_else_zero(p.valid, shown.normal);
  p.rounding = hn::IfThenElseZero(p.valid, shown.rounding);
  p.x = iota(float(x)), p.y = set(float(y));
  return p;
}

/// A length in pixels at depth 1 (at any depth where the camera is orthographic) turned into pixels
/// at the depth of each receiver.
HWY_INLINE V length_px(const ViewPlanes& planes, const ViewReceiver& p, float at_depth_1) {
  return planes.orthographic ? set(at_depth_1) : set(-at_depth_1) / p.position.z;
}

/// The unit direction from each surface to the viewer.
HWY_INLINE V3 direction_to_viewer(const ViewPlanes& planes, const ViewReceiver& p) {
  if (planes.orthographic) return {set(0), set(0), set(1)};
  return normalise({p.ray_x, p.ray_y, set(1)});
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

/// Where the pixels lie in planes of the frame.
HWY_INLINE VI index_of(const ViewPlanes& planes, const Pixels& at) {
  return at.row * set_int(int(planes.layout.stride)) + at.column;
}

/// The depths that pixels show. Outside the frame is background.
HWY_INLINE V gather_depth(const ViewPlanes& planes, const Pixels& at) {
  const V z = gather(planes.z.row(0), index_of(planes, at));
  return hn::IfThenElse(at.inside, z, set(kBackgroundDepth));
}

/// The normals that pixels show; those of the pixel (0, 0) outside the frame, and of any value
/// where there is no surface.
HWY_INLINE V3 gather_normal(const ViewPlanes& planes, const Pixels& at) {
  const auto& [x, y, z] = planes.surfaces.normal;
  const VI index = at.row * set_int(planes.width()) + at.column;
  return {gather(&x[0], index), gather(&y[0], index), gather(&z[0], index)};
}

/// The vector from each receiver to the surface at depth `z`, `right` and `down` pixels away. It is
/// computed from differences, which loses less precision than subtracting positions. Not finite on
/// background.
HWY_INLINE V3 way_to(const ViewPlanes& planes, const ViewReceiver& from, V right, V down, V z) {
  const V deeper = z - from.position.z;
  V3 way{right * set(planes.slope_x), down * set(planes.slope_y), deeper};
  if (!planes.orthographic) {
    way.x = hn::MulAdd(way.x, z, from.ray_x * deeper);
    way.y = hn::MulAdd(way.y, z, from.ray_y * deeper);
  }
  return way;
}

/// A right-handed orthonormal frame about a normal.
struct TangentFrame {
  V3 tangent, bitangent, normal;

  /// What is (s.x, s.y, s.z) in the frame, from `origin`.
  HWY_INLINE V3 place(const V3& s, const V3& origin) const {
    return mul_add(tangent, s.x, mul_add(bitangent, s.y, mul_add(normal, s.z, origin)));
  }
};

/// Any frame about each unit normal: frame_about() of math/frame.h.
HWY_INLINE TangentFrame frame_about(const V3& n) {
  const V sign = hn::CopySign(set(1), n.z), a = set(-1) / (sign + n.z), b = n.x * n.y * a;
  return {{hn::MulAdd(sign * n.x * n.x, a, set(1)), sign * b, hn::Neg(sign * n.x)},
          {b, hn::MulAdd(n.y * n.y, a, sign), hn::Neg(n.y)},
          n};
}

/// The frame of a point kernel, turned to the vector (noise_x, noise_y, 0) by Gram-Schmidt.
HWY_INLINE TangentFrame tangent_frame(const ViewPlanes& planes, const TiledNoise& noise_x,
                                      const TiledNoise& noise_y, int x, int y, const V3& normal) {
  const V3 noise{load(noise_x.at(planes, x, y)), load(noise_y.at(planes, x, y)), set(0)};
  const V3 tangent = unit_across(noise, normal);
  return {tangent, cross(normal, tangent), normal};
}

/// Calls work(x, y) for each vector of pixels of a tile in which there is a surface.
template <class Work>
HWY_INLINE void for_each_vector(const ViewPlanes& planes, const Tile& tile, const Work& work) {
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; x += kLanes) {
      if (any(shows_surface(load(planes.z.row(y) + x)))) work(x, y);
    }
  }
}

/// Sets the surfaces of a tile to what `openness(receiver, x, y)` says of them, within 0..1.
/// Background stays as it is, but for 1 beside surfaces.
template <class Openness>
HWY_INLINE void set_openness(const ViewPlanes& planes, const Tile& tile, Plane<float>& out,
                             const Openness& openness) {
  for_each_vector(planes, tile, [&](int x, int y) HWY_ATTR {
    const ViewReceiver p = load_receiver(planes, x, y);
    const V open = saturate(openness(p, x, y));
    store_first(tile.x1 - x, hn::IfThenElse(p.valid, open, set(1)), &out(x, y));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
