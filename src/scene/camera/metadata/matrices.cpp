// SPDX-License-Identifier: Apache-2.0
//
// With row vectors, the picture of p by worldToNDC M is (x / w, y / w), where x, y and w are the
// scalar products of (p, 1) with the first, second and last column of M. In pixels,
//
//   w = r3 (p - o),  x = fx r1 (p - o) + cx w,  y = fy r2 (p - o) + cy w
//
// up to a common factor, r1, r2, r3 the camera's right, down and forward and o its place. r3 is of
// length 1 and normal to r1 and r2, which gives the factor, cx and cy, then fx and fy: the
// decomposition of camera matrices (Hartley and Zisserman, Multiple View Geometry, 6.2.4), whose
// remaining freedom, the shear r1 r2, has to be 0.
#include "scene/camera/metadata/matrices.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

namespace ssdo {
namespace {

/// A matrix with these rows.
glm::dmat3 rows(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  return glm::transpose(glm::dmat3(x, y, z));
}

struct AxesRow {
  CameraAxes axes;
  std::string_view name;
  glm::dvec3 right, up, back;  ///< of the camera, in these axes
};
constexpr std::array<AxesRow, 6> kAxes = {{
    {CameraAxes::along_z, "looking along z", {1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
    {CameraAxes::along_minus_z, "looking along -z", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {CameraAxes::along_z_x_left, "looking along z, x left", {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
    {CameraAxes::along_z_y_down, "looking along z, y down", {1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
    {CameraAxes::along_minus_y_z_down, "looking along -y", {1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {CameraAxes::along_y_z_up, "looking along y", {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
}};

/// How far the entries of a rotation in floats may be off, with the rounding of what made it.
constexpr double kRotationError = 1e-3;

bool is_orthogonal(const glm::dmat3& m) {
  const glm::dmat3 product = m * glm::transpose(m);
  for (int i = 0; i < 9; ++i) {
    if (!(std::abs(product[i / 3][i % 3] - (i % 4 == 0 ? 1.0 : 0.0)) < kRotationError))
      return false;
  }
  return true;
}

/// For column vectors.
glm::dmat4 matrix_of(const StoredMatrix& stored, bool transposed) {
  const glm::dmat4 as_columns = glm::make_mat4(stored.data());
  return transposed ? glm::transpose(as_columns) : as_columns;
}

bool is_affine(const glm::dmat4& m) {
  const glm::dvec4 last(m[0][3], m[1][3], m[2][3], m[3][3]);
  return glm::distance(last, glm::dvec4(0, 0, 0, 1)) < 1e-6;
}

std::string listed(const std::vector<std::string_view>& words) {
  std::string list;
  for (const std::string_view word : words) {
    if (word.empty()) continue;
    if (!list.empty()) list += ", ";
    list += word;
  }
  return list;
}

PoseReading pose_of(const glm::dmat4& m, PoseDirection direction, const AxesRow& axes) {
  const glm::dmat3 to_ours = rows(axes.right, axes.up, axes.back), turn(m);
  const glm::dvec3 shift(m[3]);
  if (direction == PoseDirection::to_camera)
    return {to_ours * turn, -(glm::transpose(turn) * shift), false, ""};
  return {to_ours * glm::transpose(turn), shift, false, ""};
}

/// A row of axes first, then the others.
std::vector<AxesRow> starting_with(CameraAxes first) {
  std::vector<AxesRow> all(kAxes.begin(), kAxes.end());
  std::stable_partition(all.begin(), all.end(),
                        [&](const AxesRow& row) { return row.axes == first; });
  return all;
}

/// x, y and w of a picture in pixels.
struct PixelRows {
  glm::dvec4 x, y, w;
};

PixelRows pixel_rows(const StoredMatrix& stored, bool transposed, NdcWindow ndc,
                     const PictureWindows& windows) {
  const glm::dmat4 m = glm::transpose(matrix_of(stored, transposed));
  const glm::dvec4 x = m[0], y = m[1], w = m[3];
  const Window& on = ndc == NdcWindow::data_y_down ? windows.data : windows.display;
  const double width = on.width(), height = on.height(), left = on.x0, top = on.y0;
  if (ndc == NdcWindow::y_down || ndc == NdcWindow::data_y_down)
    return {width * x + left * w, height * y + top * w, w};
  if (ndc == NdcWindow::y_up) return {width * x + left * w, height * (w - y) + top * w, w};
  const double shorter = std::min(width, height);
  return {shorter * (x - 0.5 * w) + (left + 0.5 * width) * w,
          (top + 0.5 * height) * w - shorter * (y - 0.5 * w), w};
}

/// Whether the projection is parallel: w is the same everywhere, to the rounding of floats.
bool is_parallel(const PixelRows& picture) {
  return glm::length(glm::dvec3(picture.w)) <= 1e-9 * glm::length(glm::dvec3(picture.x));
}

}  // namespace

std::vector<PoseReading> read_pose(const StoredMatrix& stored, const PoseConvention& convention) {
  const PoseDirection inverse = convention.direction == PoseDirection::to_camera
                                    ? PoseDirection::to_world
                                    : PoseDirection::to_camera;
  std::vector<PoseReading> readings;
  for (const AxesRow& axes : starting_with(convention.axes)) {
    for (const PoseDirection direction : {convention.direction, inverse}) {
      for (const bool transposed : {false, true}) {
        const glm::dmat4 m = matrix_of(stored, transposed);
        if (!is_affine(m) || !is_orthogonal(glm::dmat3(m))) continue;
        PoseReading reading = pose_of(m, direction, axes);
        reading.transposed = transposed;
        reading.how = listed({transposed ? "transposed" : "", direction == inverse ? "inverse" : "",
                              axes.axes == convention.axes ? "" : axes.name});
        readings.push_back(reading);
      }
    }
  }
  return readings;
}

std::string_view name_of(NdcWindow window) {
  switch (window) {
    case NdcWindow::y_down:
      return "";
    case NdcWindow::y_up:
      return "NDC with y up";
    case NdcWindow::y_up_on_shorter:
      return "NDC of the shorter side with y up";
    case NdcWindow::data_y_down:
      return "NDC of the data window";
  }
  return "";
}

std::optional<Camera> read_perspective(const StoredMatrix& stored, bool transposed, NdcWindow ndc,
                                       const PictureWindows& windows) {
  PixelRows picture = pixel_rows(stored, transposed, ndc, windows);
  if (is_parallel(picture)) return std::nullopt;
  const double scale = glm::length(glm::dvec3(picture.w));
  const glm::dvec4 x = picture.x / scale, y = picture.y / scale, w = picture.w / scale;
  const glm::dvec3 forward(w);
  Camera camera;
  camera.cx = glm::dot(glm::dvec3(x), forward), camera.cy = glm::dot(glm::dvec3(y), forward);
  const glm::dvec4 right = x - camera.cx * w, down = y - camera.cy * w;
  camera.fx = glm::length(glm::dvec3(right)), camera.fy = glm::length(glm::dvec3(down));
  if (!(camera.fx > 0) || !(camera.fy > 0)) return std::nullopt;
  const glm::dvec3 r1 = glm::dvec3(right) / camera.fx, r2 = glm::dvec3(down) / camera.fy;
  camera.rotation = rows(r1, -r2, -forward);
  if (!is_orthogonal(camera.rotation)) return std::nullopt;
  camera.origin = -(right.w / camera.fx * r1 + down.w / camera.fy * r2 + w.w * forward);
  return camera;
}

Camera turned_to_picture(Camera camera, const StoredMatrix& stored, bool transposed) {
  // z = a w + b, b known to the rounding of floats.
  const glm::dmat4 m = glm::transpose(matrix_of(stored, transposed));
  const glm::dvec4 z = m[2], w = m[3];
  const glm::dvec3 along(w);
  const double a = glm::dot(glm::dvec3(z), along) / glm::dot(along, along), b = z.w - a * w.w;
  if (!(std::abs(b) > 1e-6 * (std::abs(z.w) + std::abs(a * w.w)))) return camera;
  const double w_of_plane = a > 0.5 ? -b / a : b / (1 - a);
  if (w_of_plane < 0) camera.rotation = -camera.rotation;
  return camera;
}

std::optional<Camera> read_orthographic(const StoredMatrix& stored, const PoseReading& pose,
                                        NdcWindow ndc, const PictureWindows& windows) {
  const PixelRows picture = pixel_rows(stored, pose.transposed, ndc, windows);
  if (!is_parallel(picture) || !(std::abs(picture.w.w) > 0)) return std::nullopt;
  const glm::dvec4 x = picture.x / picture.w.w, y = picture.y / picture.w.w;
  Camera camera;
  camera.orthographic = true;
  camera.rotation = pose.rotation, camera.origin = pose.origin;
  camera.fx = glm::length(glm::dvec3(x)), camera.fy = glm::length(glm::dvec3(y));
  if (!(camera.fx > 0) || !(camera.fy > 0)) return std::nullopt;
  camera.cx = glm::dot(x, glm::dvec4(pose.origin, 1));
  camera.cy = glm::dot(y, glm::dvec4(pose.origin, 1));
  const glm::dvec3 right = pose.rotation * glm::dvec3(x) / camera.fx,
                   down = pose.rotation * glm::dvec3(y) / camera.fy;
  const bool along_axes = glm::distance(right, {1, 0, 0}) < kRotationError &&
                          glm::distance(down, {0, -1, 0}) < kRotationError;
  return along_axes ? std::optional(camera) : std::nullopt;
}

bool same_pose(const Camera& camera, const PoseReading& pose) {
  for (int i = 0; i < 3; ++i) {
    if (!(glm::distance(camera.rotation[i], pose.rotation[i]) < kRotationError)) return false;
  }
  const double size = glm::length(camera.origin) + glm::length(pose.origin);
  return glm::distance(camera.origin, pose.origin) < kRotationError * size + 1e-6;
}

}  // namespace ssdo
