// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "math/pixel_grid.h"
#include "math/plane.h"

namespace ssdo {

/// A camera without distortion. Camera space is right-handed: x right, y up, the view along -z.
/// Pixels are those of the display window, x right and y down, the centre of pixel (i, j) at
/// (i + 0.5, j + 0.5).
///
///   perspective   px = cx + fx x / -z    py = cy - fy y / -z
///   orthographic  px = cx + fx x         py = cy - fy y
///   panorama      px = cx + fx atan2(x, -z)   py = cy - fy asin(y / |p|)
///
/// The depth of a panorama's pixel is its distance from the camera; of others, it is -z.
struct Camera {
  bool orthographic = false;
  bool panorama = false;  ///< lat-long: all directions; never both
  double fx = 1, fy = 1, cx = 0, cy = 0;

  /// camera = rotation * (p - origin), for p in the space of the input's P. Orthogonal; its
  /// determinant is -1 where that space is left-handed.
  glm::dmat3 rotation{1.0};
  glm::dvec3 origin{0.0};

  glm::dvec3 to_camera(const glm::dvec3& p) const { return rotation * (p - origin); }

  /// Camera space to pixels.
  glm::dvec2 project(const glm::dvec3& p) const {
    if (panorama) {
      return {cx + fx * std::atan2(p.x, -p.z), cy - fy * std::atan2(p.y, std::hypot(p.x, p.z))};
    }
    const double w = orthographic ? 1.0 : 1.0 / -p.z;
    return {cx + fx * p.x * w, cy - fy * p.y * w};
  }

  /// Where in camera space the view ray of a place in the picture begins, and where it leads.
  struct Ray {
    glm::dvec3 origin, direction;
  };
  Ray ray(const glm::dvec2& pixel) const {
    const double x = (pixel.x - cx) / fx, y = (cy - pixel.y) / fy;
    if (orthographic) return {{x, y, 0}, {0, 0, -1}};
    if (!panorama) return {glm::dvec3(0), {x, y, -1}};
    return {glm::dvec3(0), {std::sin(x) * std::cos(y), std::sin(y), -std::cos(x) * std::cos(y)}};
  }

  /// Depth of a camera-space point: negative behind the camera, never for a panorama.
  double depth_of(const glm::dvec3& p) const { return panorama ? glm::length(p) : -p.z; }

  /// The camera-space point at planar depth `depth` (along -z) behind a place in the picture; not
  /// for panoramas.
  glm::dvec3 unproject(const glm::dvec2& pixel, double depth) const {
    const double w = orthographic ? 1.0 : depth;
    return {(pixel.x - cx) / fx * w, (cy - pixel.y) / fy * w, -depth};
  }

  /// Horizontal field of view over `width` pixels, in degrees; 0 for an orthographic camera.
  double hfov_degrees(int width) const;

  /// Whether P was given in camera space, apart from the directions of the axes, for a scene whose
  /// surfaces are about `distance` away.
  bool is_camera_space(double distance) const;
};

/// Converts a camera from the pixels of a file to the pixels that `grid` takes of it, and back.
Camera to_grid(Camera camera, const PixelGrid& grid);
Camera from_grid(Camera camera, const PixelGrid& grid);

/// How far projected positions land from the centres of their own pixels.
struct Residual {
  double median_px = 0, p99_px = 0, max_px = 0;
};

/// Where a camera came from.
struct CameraEstimate {
  Camera camera;
  Residual residual;
  std::string source;  ///< "fitted from P", "--camera shot.json", "--fov 45"
};

/// A camera with its principal point in the middle of the display window, at the origin.
Camera camera_from_fov(double hfov_degrees, const Window& display, double pixel_aspect);
Camera camera_from_ortho_width(double width, const Window& display, double pixel_aspect);

/// Reads a camera from JSON: `type` "persp" or "ortho", `fx fy cx cy` in pixels (or `hfov_deg`
/// or `ortho_width`), and `world_to_camera`, four rows of four for column vectors, identity where
/// it is missing. Errors: ExitCode::input.
Camera read_camera(const std::filesystem::path& path, const Window& display, double pixel_aspect);

}  // namespace ssdo
