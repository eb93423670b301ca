// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "math/bf16x2.h"
#include "scene/geometry.h"
#include "scene/solids/solids.h"
#include "scene/surfaces.h"
#include "simd/interleaved.h"

namespace ssdo {

/// What stands for an infinite thickness in the units of MarchLayer: seen from the receiver, its
/// back is within 1e-4 of the direction of the view ray.
constexpr float kInfiniteThicknessRatio = 1e4f, kInfiniteThickness = 1e15f;

/// Least cosine between a normal and the direction to the viewer, so that it can be divided by; a
/// plane tilted by 89.9 degrees has 0.0017. Smooth normals that lean away farther are bent to this.
constexpr float kLeastFacing = 1e-3f;

/// Where values of the pixels at the frame's border are stored: the first and the last row in the
/// order of an InterleavedPlane, then the first and the last column from top to bottom.
class BorderLayout {
 public:
  explicit BorderLayout(const Interleaving& layout)
      : frame_(layout), row_(layout.stride() * Interleaving::kPeriod) {}

  std::ptrdiff_t in_row(bool last, int column_phase, int column) const {
    return (last ? row_ : 0) + frame_.index(0, column_phase, column);
  }
  std::ptrdiff_t in_row(bool last, int x) const { return (last ? row_ : 0) + frame_.index(x, 0); }
  std::ptrdiff_t in_column(bool last, int y) const {
    return 2 * row_ + (last ? frame_.height() : 0) + y;
  }
  std::size_t size() const { return std::size_t(2 * (row_ + frame_.height())); }

  /// `value(x, y)` of all pixels at the border.
  template <class Value>
  std::vector<float> gather(const Value& value) const {
    const int w = frame_.width(), h = frame_.height();
    std::vector<float> values(size());
    for (const bool last : {false, true}) {
      for (int x = 0; x < w; ++x) values[std::size_t(in_row(last, x))] = value(x, last ? h - 1 : 0);
      for (int y = 0; y < h; ++y)
        values[std::size_t(in_column(last, y))] = value(last ? w - 1 : 0, y);
    }
    return values;
  }

 private:
  Interleaving frame_;
  std::ptrdiff_t row_;
};

using BorderValues = std::vector<float>;

/// Whether a depth of MarchLayer is that of a solid. Where there is none, it is not-a-number: no
/// comparison with that holds, so that a march passes by without a mask.
inline bool holds_solid(float depth) { return !std::isnan(depth); }

/// One layer of solids. Both planes are not-a-number where there is none. Thicknesses are a share
/// of the depth in front, or a length in scene units where the camera is orthographic.
struct MarchLayer {
  InterleavedPlane depth;      ///< of the front, along the axis, positive
  InterleavedPlane thickness;  ///< from the front to the back
};

/// What a march meets, pixel by pixel. Tangent planes belong to layer 0; the fronts of the layers
/// behind it face the viewer. All of these are not-a-number where there is nothing.
struct MarchPlanes {
  std::vector<MarchLayer> layers;  ///< near to far; layer 0 is what pixels show
  /// The tangent plane of layer 0: how much nearer it comes from a pixel to the next, to the right
  /// and to the bottom. Nearness is 1 / depth here, in units of that of the pixel, or -depth where
  /// the camera is orthographic: it changes linearly. Marches read pack_bf16x2(); with
  /// pack_bf16x2_rest() beside it the normal is known to the bit or two.
  InterleavedPlane tilt, tilt_rest;

  const InterleavedPlane& depth() const { return layers.front().depth; }  ///< of what pixels show
};

/// A raster of pixels as a march reads it: all of them occlude and send light, those of `receivers`
/// gather it. A position is given by its depth: the point where the camera's ray through the middle
/// of a pixel meets the tangent plane of the surface in that pixel.
struct MarchScene : MarchPlanes {
  Interleaving layout;
  Window receivers;  ///< pixels of the raster, whose first is (0, 0)
  bool orthographic;
  float fx, fy;                   ///< pixels per unit of slope, or per scene unit
  float axis_x, axis_y;           ///< pixel of the display window that the camera's axis meets
  int first_x, first_y;           ///< pixel (0, 0) in the display window
  int frame_width, frame_height;  ///< of the frame that the raster is all of, or some rows of
  int frame_y;                    ///< rows of that frame above the raster
  /// What only receivers need: the normal that shading sees, by which light is weighed, and the
  /// rounding.
  const Surfaces& surfaces;
  const Surfaces& casting;  ///< what the raster holds
  BorderLayout border;
  BorderValues border_depth, border_normal[3];
  BorderValues border_thickness;  ///< in scene units
  BorderValues border_beyond;     ///< how far surfaces may go on beyond the frame; empty: no limit
  /// The depth and tilt of receivers where what they show does not cast; else empty.
  InterleavedPlane own_depth, own_tilt, own_tilt_rest;

  bool shows_surface(std::ptrdiff_t i) const { return holds_solid(depth()[i]); }

  bool receives(std::ptrdiff_t i) const { return holds_solid(receiver_depth()[i]); }

  /// The depth and tilt of what receives.
  const InterleavedPlane& receiver_depth() const { return own_depth.data() ? own_depth : depth(); }
  const InterleavedPlane& receiver_tilt() const { return own_depth.data() ? own_tilt : tilt; }
  const InterleavedPlane& receiver_tilt_rest() const {
    return own_depth.data() ? own_tilt_rest : tilt_rest;
  }
  /// Whether a pixel shows the background. A broken pixel shows neither background nor surface.
  bool shows_background(int x, int y) const {
    const Surfel& s = casting(x, y);
    return !s.is_surface() && !s.is_broken();
  }
  Window raster() const { return {0, 0, layout.width(), layout.height()}; }
};

/// Slope of the ray through the middle of a pixel, or its place where the camera is orthographic.
glm::vec2 ray_slope(const MarchScene& scene, int x, int y);

/// The unit normal of the tangent plane of what a pixel shows.
glm::vec3 tangent_normal(const MarchScene& scene, int x, int y);

/// The largest distance in the picture, in pixels, of anything within the radius of a point in
/// camera space: as reach_px() of lanes-inl.h. Infinite where the camera is within the radius. `f`
/// pixels per unit of slope, or per scene unit of an orthographic camera.
float reach_px(float f, bool orthographic, const glm::vec3& point, float radius);

/// The same of any surface.
float reach_px(const Geometry& geometry, float radius);

/// `receivers` as Request has them: in the coordinates of the geometry's window, and within it;
/// area 0: all of it. `receiving`: what receives where that is not `geometry`, whose solids are
/// given. Solids are as deep as solid_within() has them, for marches within `radius`.
MarchScene make_march_scene(const Geometry& geometry, const Solids& solids,
                            const Window& receivers = {}, const Geometry* receiving = nullptr,
                            float radius = std::numeric_limits<float>::infinity());

}  // namespace ssdo
