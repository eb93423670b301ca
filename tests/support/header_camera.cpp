// SPDX-License-Identifier: Apache-2.0
#include "support/header_camera.h"

#include <ImfFloatAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>

namespace ssdo::test {
namespace {

/// The matrix for row vectors of a linear map of (p, 1): its rows are the images of the axes and of
/// the origin.
template <class Map>
std::vector<double> matrix_of(const Map& map) {
  std::vector<double> stored;
  for (int row = 0; row < 4; ++row) {
    glm::dvec3 p(0);
    if (row < 3) p[row] = 1;
    const glm::dvec4 image = row < 3 ? map(p) - map(glm::dvec3(0)) : map(p);
    for (int i = 0; i < 4; ++i) stored.push_back(image[i]);
  }
  return stored;
}

/// The place of p in pixels times w, and w.
glm::dvec3 picture_of(const Camera& camera, const glm::dvec3& p) {
  const glm::dvec3 c = camera.to_camera(p);
  const double w = camera.orthographic ? 1 : -c.z;
  return {camera.fx * c.x + camera.cx * w, -camera.fy * c.y + camera.cy * w, w};
}

double fov_of(const Camera& camera, const Window& display) {
  return glm::degrees(2 * std::atan(0.5 * display.width() / camera.fx));
}

}  // namespace

std::vector<double> transposed(const std::vector<double>& matrix) {
  std::vector<double> out(16);
  for (std::size_t i = 0; i < 16; ++i) out[i] = matrix[i % 4 * 4 + i / 4];
  return out;
}

std::vector<double> inverse(const std::vector<double>& matrix) {
  glm::dmat3 turn;
  for (int i = 0; i < 9; ++i) turn[i / 3][i % 3] = matrix[std::size_t(i / 3 * 4 + i % 3)];
  const glm::dvec3 shift(matrix[12], matrix[13], matrix[14]);
  return matrix_of(
      [&](const glm::dvec3& p) { return glm::dvec4(glm::transpose(turn) * (p - shift), 1); });
}

HeaderNumbers standard_header(const Camera& camera, const Window& display) {
  const auto to_camera = [&](const glm::dvec3& p) {
    const glm::dvec3 c = camera.to_camera(p);
    return glm::dvec4(c.x, c.y, -c.z, 1);
  };
  const auto to_ndc = [&](const glm::dvec3& p) {
    const glm::dvec3 at = picture_of(camera, p);
    const double near = 0.1, z = -camera.to_camera(p).z;
    return glm::dvec4((at.x - display.x0 * at.z) / display.width(),
                      (at.y - display.y0 * at.z) / display.height(), z - near, at.z);
  };
  return {{"worldToCamera", matrix_of(to_camera)}, {"worldToNDC", matrix_of(to_ndc)}};
}

HeaderNumbers pbrt_header(const Camera& camera, const Window& display) {
  const double shorter = std::min(display.width(), display.height()),
               x = 0.5 * (display.x0 + display.x1), y = 0.5 * (display.y0 + display.y1);
  const auto to_ndc = [&](const glm::dvec3& p) {
    const glm::dvec3 at = picture_of(camera, p);
    return glm::dvec4(0.5 * at.z + (at.x - x * at.z) / shorter,
                      0.5 * at.z - (at.y - y * at.z) / shorter, 1.01 * at.z - 0.01, at.z);
  };
  const HeaderNumbers standard = standard_header(camera, display);
  return {{"worldToCamera", transposed(standard.at("worldToCamera"))},
          {"worldToNDC", transposed(matrix_of(to_ndc))}};
}

HeaderNumbers vray_header(const Camera& camera, const Window& display) {
  const auto to_world = [&](const glm::dvec3& local) {
    const glm::dvec3 ours(local.x, -local.z, local.y);
    return glm::dvec4(camera.origin + glm::transpose(camera.rotation) * ours, 1);
  };
  return {{"cameraTransform", matrix_of(to_world)},
          {"cameraFov", {fov_of(camera, display)}},
          {"cameraAperture", {36}},
          {"cameraFocalLength", {36 * camera.fx / display.width()}},
          {"cameraProjection", {0}}};
}

HeaderNumbers redshift_header(const Camera& camera, const Window& display) {
  const auto to_world = [&](const glm::dvec3& local) {
    const glm::dvec3 ours(-local.x, local.y, -local.z);
    return glm::dvec4(camera.origin + glm::transpose(camera.rotation) * ours, 1);
  };
  return {{"rs/camera/transform", matrix_of(to_world)},
          {"rs/camera/fov", {fov_of(camera, display)}}};
}

Camera unreal_camera(const UnrealPose& pose, Camera lens) {
  // Turns the first axis towards the second.
  const auto turn = [](glm::dvec3 v, int first, int second, double degrees) {
    const double c = std::cos(glm::radians(degrees)), s = std::sin(glm::radians(degrees));
    const double a = v[first], b = v[second];
    v[first] = c * a - s * b, v[second] = s * a + c * b;
    return v;
  };
  const auto turned = [&](const glm::dvec3& v) {
    return turn(turn(turn(v, 2, 1, pose.roll), 0, 2, pose.pitch), 0, 1, pose.yaw);
  };
  const glm::dvec3 view = turned({1, 0, 0}), right = turned({0, 1, 0}), up = turned({0, 0, 1});
  lens.rotation = glm::transpose(glm::dmat3(right, up, -view));
  lens.origin = pose.place;
  return lens;
}

HeaderNumbers unreal_header(const UnrealPose& pose, const Camera& lens, const Window& display) {
  const std::string at = "unreal/camera/";
  return {{at + "curPos/x", {pose.place.x}},
          {at + "curPos/y", {pose.place.y}},
          {at + "curPos/z", {pose.place.z}},
          {at + "curRot/pitch", {pose.pitch}},
          {at + "curRot/yaw", {pose.yaw}},
          {at + "curRot/roll", {pose.roll}},
          {at + "prevPos/x", {pose.place.x - 1}},
          {at + "FinalImage/fov", {fov_of(lens, display)}},
          {at + "FinalImage/sensorWidth", {24}},
          {at + "FinalImage/focalLength", {24 * lens.fx / display.width()}}};
}

void add_attributes(Imf::Header& header, const HeaderNumbers& numbers, const std::string& prefix,
                    bool as_text) {
  for (const auto& [key, values] : numbers) {
    const std::string name = prefix + key;
    if (as_text) {
      header.insert(name, Imf::StringAttribute(fmt::format("{:.9g}", values[0])));
    } else if (values.size() == 16) {
      Imath::M44f matrix;
      for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = float(values[std::size_t(i)]);
      header.insert(name, Imf::M44fAttribute(matrix));
    } else {
      header.insert(name, Imf::FloatAttribute(float(values[0])));
    }
  }
}

}  // namespace ssdo::test
