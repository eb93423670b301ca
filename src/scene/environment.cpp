// SPDX-License-Identifier: Apache-2.0
#include "scene/environment.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kPi = glm::pi<float>();
constexpr int kBlurredSize = 64;       ///< nodes are 3 degrees apart, the lobes 10 or wider
constexpr int kBlurSourceWidth = 128;  ///< texels of 2.8 degrees

/// Solid angle of a texel in row `y` of `height` rows and `width` columns.
float texel_solid_angle(int y, int width, int height) {
  const float top = std::cos(kPi * float(y) / float(height));
  const float bottom = std::cos(kPi * float(y + 1) / float(height));
  return (top - bottom) * 2 * kPi / float(width);
}

}  // namespace

Environment Environment::constant(const glm::vec3& radiance) {
  Environment environment;
  environment.constant_ = radiance;
  return environment;
}

Environment::Environment(std::shared_ptr<const Plane<glm::vec3>> lat_long,
                         const EnvironmentFrame& frame)
    : map_(std::move(lat_long)), frame_(frame), gain_(std::exp2(frame.exposure_stops)) {}

glm::vec3 Environment::direction_at(float u, float v) const {
  const float polar = kPi * v;
  // The map turned by +rotate shows at azimuth a what the unturned map shows at a - rotate.
  const float turn = glm::radians(frame_.rotate_degrees);
  const float azimuth = 2 * kPi * (0.5f - u) + turn;
  const float across = std::sin(polar);
  if (frame_.up == UpAxis::z) {
    return {across * std::cos(azimuth), across * std::sin(azimuth), std::cos(polar)};
  }
  return {across * std::sin(azimuth), std::cos(polar), across * std::cos(azimuth)};
}

glm::vec3 Environment::radiance(const glm::vec3& d) const {
  if (is_constant()) return constant_;
  const Plane<glm::vec3>& map = *map_;
  const bool z_up = frame_.up == UpAxis::z;
  const float azimuth =
      (z_up ? std::atan2(d.y, d.x) : std::atan2(d.x, d.z)) - glm::radians(frame_.rotate_degrees);
  const float height = glm::clamp(z_up ? d.z : d.y, -1.0f, 1.0f);
  const float u = 0.5f - azimuth / (2 * kPi), v = std::acos(height) / kPi;
  const float x = (u - std::floor(u)) * float(map.width) - 0.5f;
  const float y = glm::clamp(v * float(map.height) - 0.5f, 0.0f, float(map.height - 1));
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
    sum += row * double(texel_solid_angle(y, map_->width, map_->height));
  }
  return gain_ * glm::vec3(sum / (4 * glm::pi<double>()));
}

/// The sky in blocks of texels. A block's direction is the mean over its light, so that a sun of
/// one texel keeps its place and its irradiance.
std::vector<Environment::Patch> Environment::patches(const glm::mat3& world_to_camera) const {
  const Plane<glm::vec3>& map = *map_;
  const int block = std::max(1, map.width / kBlurSourceWidth);
  const int columns = (map.width + block - 1) / block, rows = (map.height + block - 1) / block;
  std::vector<Patch> sky(std::size_t(columns) * std::size_t(rows));
  for (int y = 0; y < map.height; ++y) {
    const float omega = texel_solid_angle(y, map.width, map.height);
    for (int x = 0; x < map.width; ++x) {
      Patch& patch = sky[std::size_t(y / block) * std::size_t(columns) + std::size_t(x / block)];
      const glm::vec3 power = gain_ * omega * map(x, y);
      const glm::vec3 world =
          direction_at((float(x) + 0.5f) / float(map.width), (float(y) + 0.5f) / float(map.height));
      patch.direction +=
          (std::abs(power.x + power.y + power.z) + 1e-6f * omega) * (world_to_camera * world);
      patch.power += power;
      patch.solid_angle += omega;
    }
  }
  for (Patch& patch : sky) patch.direction = glm::normalize(patch.direction);
  return sky;
}

OctahedralMap Environment::blurred(float solid_angle, const glm::mat3& world_to_camera) const {
  const std::vector<Patch> sky = patches(world_to_camera);
  OctahedralMap out(kBlurredSize);
  // The lobe max(0, cos - c) / (1 - c) integrates to pi (1 - c).
  const float edge = std::max(-1.0f, 1 - solid_angle / kPi);
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
