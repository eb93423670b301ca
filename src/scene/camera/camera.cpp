// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_access.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>
#include <nlohmann/json.hpp>

#include "error.h"
#include "io/size_guard.h"

namespace ssdo {
namespace {

/// Largest JSON file of a camera, in bytes; a camera takes less than 1 KiB.
constexpr std::size_t kMostCameraBytes = 1 << 20;

using nlohmann::json;

[[noreturn]] void refuse(const std::string& file, const std::string& what) {
  throw Error(ExitCode::input, fmt::format("{}: {}", file, what));
}

/// Four rows of four, of which the last may be missing, for column vectors.
glm::dmat4 read_matrix(const json& rows, const std::string& file) {
  const auto is_row = [](const json& row) { return row.is_array() && row.size() == 4; };
  if (!rows.is_array() || (rows.size() != 4 && rows.size() != 3) ||
      !std::all_of(rows.begin(), rows.end(), is_row)) {
    refuse(file, "world_to_camera is not four rows of four numbers");
  }
  glm::dmat4 matrix(1.0);
  for (int row = 0; row < int(rows.size()); ++row) {
    for (int column = 0; column < 4; ++column)
      matrix[column][row] = rows[row][column].get<double>();
  }
  const glm::dvec4 last = glm::row(matrix, 3);
  if (last != glm::dvec4(0, 0, 0, 1)) {
    refuse(file,
           fmt::format("the last row of world_to_camera is {} {} {} {}, not 0 0 0 1; a matrix "
                       "for row vectors has to be transposed",
                       last.x, last.y, last.z, last.w));
  }
  return matrix;
}

/// Whether a camera file says that its world is left-handed, as that of some P is.
bool is_left_handed(const json& j, const std::string& file) {
  const std::string hand = j.value("world_handedness", "right");
  if (hand != "left" && hand != "right")
    refuse(file, fmt::format("world_handedness is '{}'; use 'right' or 'left'", hand));
  return hand == "left";
}

/// Splits world_to_camera into rotation and origin. Refuses scale and shear: distances measured in
/// camera space would no longer be the scene's. Refuses a mirror that the file does not declare: a
/// wrong sign in an export would turn the light around.
void set_pose(Camera& camera, const json& j, const std::string& file) {
  const glm::dmat4 matrix = read_matrix(j.at("world_to_camera"), file);
  const glm::dmat3 rotation(matrix);
  const glm::dmat3 product = rotation * glm::transpose(rotation);
  for (int i = 0; i < 9; ++i) {
    const double expected = i % 4 == 0 ? 1.0 : 0.0;
    if (!(std::abs(product[i / 3][i % 3] - expected) < 1e-3)) {
      refuse(file,
             "world_to_camera is no rotation and translation (it scales or shears); give a "
             "rigid matrix for column vectors");
    }
  }
  const bool mirrors = glm::determinant(rotation) < 0;
  if (mirrors != is_left_handed(j, file)) {
    refuse(file, mirrors ? "world_to_camera mirrors (its determinant is -1); flip an axis, or add "
                           "\"world_handedness\": \"left\" if P is in a left-handed space"
                         : "world_handedness is left, but world_to_camera does not mirror (its "
                           "determinant is 1)");
  }
  camera.rotation = rotation;
  camera.origin = -(glm::transpose(rotation) * glm::dvec3(matrix[3]));
}

double read_between(const json& j, const char* key, double low, double high,
                    const std::string& file) {
  const auto value = j.at(key).get<double>();
  if (!(value > low && value < high)) {
    refuse(file,
           fmt::format("{} is {}; it has to be above {:g} and below {:g}", key, value, low, high));
  }
  return value;
}

Camera parse_camera(const json& j, const std::string& file, const Window& display,
                    double pixel_aspect) {
  constexpr double kLargest = 1e30;
  Camera camera;
  const std::string type = j.value("type", "persp");
  if (type != "persp" && type != "ortho")
    refuse(file, fmt::format("camera type '{}'; use 'persp' or 'ortho'", type));
  if (j.contains("fx")) {
    camera.orthographic = type == "ortho";
    camera.fx = read_between(j, "fx", 0, kLargest, file);
    camera.fy = j.contains("fy") ? read_between(j, "fy", 0, kLargest, file) : camera.fx;
    camera.cx = 0.5 * (display.x0 + display.x1);
    camera.cy = 0.5 * (display.y0 + display.y1);
    if (j.contains("cx")) camera.cx = read_between(j, "cx", -kLargest, kLargest, file);
    if (j.contains("cy")) camera.cy = read_between(j, "cy", -kLargest, kLargest, file);
  } else if (type == "ortho") {
    const double width = read_between(j, "ortho_width", 0, kLargest, file);
    camera = camera_from_ortho_width(width, display, pixel_aspect);
  } else {
    camera = camera_from_fov(read_between(j, "hfov_deg", 0, 180, file), display, pixel_aspect);
  }
  if (!(std::max(camera.fx, camera.fy) < kLargest)) {
    refuse(file, fmt::format("{} is so small that a pixel shows nothing; give the {} of the frame",
                             type == "ortho" ? "ortho_width" : "hfov_deg",
                             type == "ortho" ? "width" : "field of view"));
  }
  if (j.contains("world_to_camera")) set_pose(camera, j, file);
  return camera;
}

}  // namespace

double Camera::hfov_degrees(int width) const {
  return orthographic ? 0.0 : glm::degrees(2.0 * std::atan(0.5 * width / fx));
}

bool Camera::is_camera_space(double distance) const {
  double off_axis = 0;
  for (int i = 0; i < 9; ++i) {
    if (i % 4 != 0) off_axis = std::max(off_axis, std::abs(rotation[i / 3][i % 3]));
  }
  // An orthographic camera's place along its axis cannot be observed.
  const glm::dvec3 o = rotation * origin;
  const double away = orthographic ? std::hypot(o.x, o.y) : glm::length(o);
  return off_axis < 1e-3 && away < 1e-3 * distance;
}

Camera to_grid(Camera camera, const PixelGrid& grid) {
  if (!grid.is_coarse()) return camera;
  const double s = grid.stride;
  // Middles of pixels are at x + 0.5, of the smaller picture too.
  camera.cx = (camera.cx - grid.middle_x(0) - 0.5) / s + 0.5;
  camera.cy = (camera.cy - grid.middle_y(0) - 0.5) / s + 0.5;
  camera.fx /= s, camera.fy /= s;
  return camera;
}

Camera from_grid(Camera camera, const PixelGrid& grid) {
  if (!grid.is_coarse()) return camera;
  const double s = grid.stride;
  camera.cx = (camera.cx - 0.5) * s + grid.middle_x(0) + 0.5;
  camera.cy = (camera.cy - 0.5) * s + grid.middle_y(0) + 0.5;
  camera.fx *= s, camera.fy *= s;
  return camera;
}

Camera camera_from_fov(double hfov_degrees, const Window& display, double pixel_aspect) {
  Camera camera;
  camera.fx = 0.5 * display.width() / std::tan(0.5 * glm::radians(hfov_degrees));
  camera.fy = camera.fx * pixel_aspect;
  camera.cx = 0.5 * (display.x0 + display.x1);
  camera.cy = 0.5 * (display.y0 + display.y1);
  return camera;
}

Camera camera_from_ortho_width(double width, const Window& display, double pixel_aspect) {
  Camera camera = camera_from_fov(90, display, pixel_aspect);
  camera.orthographic = true;
  camera.fx = display.width() / width;
  camera.fy = camera.fx * pixel_aspect;
  return camera;
}

Camera read_camera(const std::filesystem::path& path, const Window& display, double pixel_aspect) {
  std::ifstream in(path);
  in.peek();  // a folder can be opened, but not read
  if (in.bad() || !in.is_open()) {
    throw Error(ExitCode::input,
                fmt::format("{}: camera file cannot be read; check --camera", path.string()));
  }
  const std::string text = read_text(in, path, kMostCameraBytes, ExitCode::input);
  try {
    return parse_camera(json::parse(text), path.string(), display, pixel_aspect);
  } catch (const json::exception& e) {
    throw Error(ExitCode::input,
                fmt::format("{}: not a camera: {}; it needs fx (or hfov_deg, or type ortho with "
                            "ortho_width) and world_to_camera",
                            path.string(), e.what()));
  }
}

}  // namespace ssdo
