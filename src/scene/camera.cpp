// SPDX-License-Identifier: Apache-2.0
#include "scene/camera.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>
#include <nlohmann/json.hpp>

#include "error.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// Splits world_to_camera into rotation and origin. Refuses scale and shear: distances measured in
/// camera space would no longer be the scene's.
void set_pose(Camera& camera, const json& rows, const std::string& file) {
  glm::dmat3 rotation;
  glm::dvec3 translation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      rotation[column][row] = rows.at(row).at(column).get<double>();
    }
    translation[row] = rows.at(row).at(3).get<double>();
  }
  const glm::dmat3 product = rotation * glm::transpose(rotation);
  for (int i = 0; i < 9; ++i) {
    const double expected = i % 4 == 0 ? 1.0 : 0.0;
    if (!(std::abs(product[i / 3][i % 3] - expected) < 1e-3)) {
      throw Error(ExitCode::input,
                  fmt::format("{}: world_to_camera is no rotation and translation (it scales or "
                              "shears); give a rigid matrix for column vectors",
                              file));
    }
  }
  camera.rotation = rotation;
  camera.origin = -(glm::transpose(rotation) * translation);
}

Camera parse_camera(const json& j, const std::string& file, const Window& display,
                    double pixel_aspect) {
  Camera camera;
  const std::string type = j.value("type", "persp");
  if (type != "persp" && type != "ortho") {
    throw Error(ExitCode::input,
                fmt::format("{}: camera type '{}'; use 'persp' or 'ortho'", file, type));
  }
  if (j.contains("fx")) {
    camera.orthographic = type == "ortho";
    camera.fx = j.at("fx").get<double>();
    camera.fy = j.value("fy", camera.fx);
    camera.cx = j.value("cx", 0.5 * (display.x0 + display.x1));
    camera.cy = j.value("cy", 0.5 * (display.y0 + display.y1));
  } else if (type == "ortho") {
    camera = camera_from_ortho_width(j.at("ortho_width").get<double>(), display, pixel_aspect);
  } else {
    camera = camera_from_fov(j.at("hfov_deg").get<double>(), display, pixel_aspect);
  }
  if (!(camera.fx > 0) || !(camera.fy > 0) ||
      !std::isfinite(camera.fx + camera.fy + camera.cx + camera.cy)) {
    throw Error(ExitCode::input, fmt::format("{}: fx and fy are {} and {} pixels; both must be "
                                             "positive",
                                             file, camera.fx, camera.fy));
  }
  if (j.contains("world_to_camera")) set_pose(camera, j.at("world_to_camera"), file);
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
  if (!in) {
    throw Error(ExitCode::input,
                fmt::format("{}: camera file cannot be read; check --camera", path.string()));
  }
  try {
    return parse_camera(json::parse(in), path.string(), display, pixel_aspect);
  } catch (const json::exception& e) {
    throw Error(ExitCode::input,
                fmt::format("{}: not a camera: {}; it needs fx (or hfov_deg, or type ortho with "
                            "ortho_width) and world_to_camera",
                            path.string(), e.what()));
  }
}

}  // namespace ssdo
