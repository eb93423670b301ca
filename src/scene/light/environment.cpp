// SPDX-License-Identifier: Apache-2.0
#include "scene/light/environment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <numeric>
#include <vector>

#include "math/pi.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Odd, so that nodes lie on the folds of the octahedral map: without nodes there, x = 0 and y = 0
/// were 1 degree off. Nodes are 3 degrees apart, the lobes 10 or wider.
constexpr int kBlurredSize = 65;
constexpr int kBlurSourceWidth = 128;  ///< patches of 2.8 degrees

/// The mean over the texels of the absolute sum of the channels; at least the smallest normal
/// float, so that it has a reciprocal.
float mean_brightness(const Plane<glm::vec3>& map) {
  std::vector<double> of_row(std::size_t(map.height));
  for_each_row(map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x) {
      const glm::vec3& c = map(x, y);
      of_row[std::size_t(y)] += std::abs(c.x + c.y + c.z);
    }
  });
  const double sum = std::accumulate(of_row.begin(), of_row.end(), 0.0);
  return std::max(std::numeric_limits<float>::min(), float(sum / double(map.size())));
}

}  // namespace

Environment Environment::constant(const glm::vec3& radiance, UpAxis up) {
  Environment environment;
  environment.constant_ = radiance;
  environment.frame_.up = up;
  return environment;
}

Environment::Environment(std::shared_ptr<const Plane<glm::vec3>> lat_long,
                         const EnvironmentFrame& frame)
    : map_(std::move(lat_long)), frame_(frame), gain_(std::exp2(frame.exposure_stops)) {}

glm::vec3 Environment::direction_at(float polar, float azimuth) const {
  const float across = std::sin(polar);
  if (frame_.up == UpAxis::z) {
    return {across * std::cos(azimuth), across * std::sin(azimuth), std::cos(polar)};
  }
  return {across * std::sin(azimuth), std::cos(polar), across * std::cos(azimuth)};
}

float Environment::azimuth_at(float column) const {
  // The map turned by +rotate shows at azimuth a what the unturned map shows at a - rotate.
  return 2 * kPif * (0.5f - column / float(map_->width)) + glm::radians(frame_.rotate_degrees);
}

glm::mat3 Environment::axes() const {
  if (frame_.up == UpAxis::z) return glm::mat3(1);
  return {glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
}

glm::vec3 Environment::texel_direction(int x, int y) const {
  return direction_at(kPif * (float(y) + 0.5f) / float(map_->height), azimuth_at(float(x) + 0.5f));
}

glm::vec2 Environment::texel_at(const glm::vec3& d) const {
  const bool z_up = frame_.up == UpAxis::z;
  // Angles are found in double and rounded: releases of the C library differ in the last bit of
  // those that they find in float.
  const glm::dvec3 to(d);
  const float azimuth = float(z_up ? std::atan2(to.y, to.x) : std::atan2(to.x, to.z)) -
                        glm::radians(frame_.rotate_degrees);
  const float polar = float(std::acos(glm::clamp(z_up ? to.z : to.y, -1.0, 1.0)));
  const float u = 0.5f - azimuth / (2 * kPif), v = polar / kPif;
  return {(u - std::floor(u)) * float(map_->width), v * float(map_->height)};
}

float Environment::texel_solid_angle(int y) const {
  const float top = std::cos(kPif * float(y) / float(map_->height));
  const float bottom = std::cos(kPif * float(y + 1) / float(map_->height));
  return (top - bottom) * 2 * kPif / float(map_->width);
}

glm::vec3 Environment::radiance(const glm::vec3& d) const {
  if (is_constant()) return constant_;
  const Plane<glm::vec3>& map = *map_;
  const glm::vec2 at = texel_at(d) - 0.5f;
  const float x = at.x, y = glm::clamp(at.y, 0.0f, float(map.height - 1));
  const int x0 = int(std::floor(x)), y0 = int(y);
  const auto column = [&](int c) { return (c + map.width) % map.width; };
  const int y1 = std::min(y0 + 1, map.height - 1);
  const float fx = x - float(x0), fy = y - float(y0);
  return gain_ * glm::mix(glm::mix(map(column(x0), y0), map(column(x0 + 1), y0), fx),
                          glm::mix(map(column(x0), y1), map(column(x0 + 1), y1), fx), fy);
}

glm::vec3 Environment::mean() const {
  if (is_constant()) return constant_;
  glm::dvec3 sum(0);
  for (int y = 0; y < map_->height; ++y) {
    glm::dvec3 row(0);
    for (int x = 0; x < map_->width; ++x) row += glm::dvec3((*map_)(x, y));
    sum += row * double(texel_solid_angle(y));
  }
  return gain_ * glm::vec3(sum / (4 * glm::pi<double>()));
}

std::vector<Environment::Patch> Environment::patches(const glm::mat3& world_to_camera,
                                                     int columns) const {
  const Plane<glm::vec3>& map = *map_;
  const int rows = std::min(map.height, std::max(1, columns / 2));
  columns = std::min(map.width, columns);
  std::vector<Patch> sky(std::size_t(columns) * std::size_t(rows));
  // Black texels count a little, in proportion to the others: brighter light has the same patches.
  constexpr float kLeastWeight = 1e-6f;
  const float per_brightness = 1 / mean_brightness(map);
  // Unit vectors around the horizon, so that the loop over texels has no trigonometry.
  std::vector<glm::vec3> horizon(std::size_t(map.width));
  for (int x = 0; x < map.width; ++x)
    horizon[x] = direction_at(kPif / 2, azimuth_at(float(x) + 0.5f));
  const auto first_texel = [](int patch, int patches, int texels) {
    return int(std::int64_t(patch) * texels / patches);
  };
  for_each_row(rows, [&](int row) {
    Patch* const in_row = &sky[std::size_t(row) * std::size_t(columns)];
    const int end_y = first_texel(row + 1, rows, map.height);
    for (int y = first_texel(row, rows, map.height); y < end_y; ++y) {
      const float polar = kPif * (float(y) + 0.5f) / float(map.height);
      const glm::vec3 pole = direction_at(0, 0) * std::cos(polar);
      const float across = std::sin(polar), omega = texel_solid_angle(y);
      for (int column = 0; column < columns; ++column) {
        const int x0 = first_texel(column, columns, map.width);
        const int x1 = first_texel(column + 1, columns, map.width);
        glm::vec3 light(0), around(0);
        float weights = 0;
        for (int x = x0; x < x1; ++x) {
          const glm::vec3& c = map(x, y);
          const float weight = std::abs(c.x + c.y + c.z) * per_brightness + kLeastWeight;
          light += gain_ * c;
          around += weight * horizon[x];
          weights += weight;
        }
        Patch& patch = in_row[column];
        patch.direction += omega * (across * around + weights * pole);
        patch.power += omega * light;
        patch.solid_angle += omega * float(x1 - x0);
      }
    }
    for (int column = 0; column < columns; ++column) {
      in_row[column].direction = world_to_camera * glm::normalize(in_row[column].direction);
    }
  });
  return sky;
}

OctahedralMap Environment::blurred(float solid_angle, const glm::mat3& world_to_camera) const {
  const std::vector<Patch> sky = patches(world_to_camera, kBlurSourceWidth);
  OctahedralMap out(kBlurredSize);
  // The lobe max(0, cos - c) / (1 - c) integrates to pi (1 - c).
  const float edge = std::max(-1.0f, 1 - solid_angle / kPif);
  for_each_row(out.size(), [&](int y) {
    for (int x = 0; x < out.size(); ++x) {
      const glm::vec3 d = out.direction_of(x, y);
      glm::vec3 sum(0);
      float weights = 0;
      for (const Patch& patch : sky) {
        const float w = std::max(0.0f, glm::dot(d, patch.direction) - edge);
        sum += w * patch.power;
        weights += w * patch.solid_angle;
      }
      out(x, y) = weights > 0 ? sum / weights : radiance(glm::transpose(world_to_camera) * d);
    }
  });
  return out;
}

}  // namespace ssdo
