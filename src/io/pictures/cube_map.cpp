// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/cube_map.h"

#include <ImfEnvmap.h>
#include <ImfEnvmapAttribute.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr int kLeastColumns = 256, kMostColumns = 2048;
constexpr int kSamples = 3;  ///< at least, across and down a texel of the lat-long map

/// Bilinear radiance from a direction.
glm::vec3 look_up(const Plane<glm::vec3>& cube, const Imath::V3f& direction) {
  const Imath::Box2i window({0, 0}, {cube.width - 1, cube.height - 1});
  Imf::CubeMapFace face = Imf::CUBEFACE_POS_X;
  Imath::V2f in_face;
  Imf::CubeMap::faceAndPixelPosition(direction, window, face, in_face);
  const Imath::V2f at = Imf::CubeMap::pixelPosition(face, window, in_face);
  const int last = cube.width - 1, top = int(face) * cube.width;
  const int x = std::clamp(int(at.x), 0, last), y = std::clamp(int(at.y), top, top + last);
  const int right = std::min(x + 1, last), below = std::min(y + 1, top + last);
  const float across = at.x - float(x), down = at.y - float(y);
  return glm::mix(glm::mix(cube(x, y), cube(right, y), across),
                  glm::mix(cube(x, below), cube(right, below), across), down);
}

}  // namespace

bool is_cube_map(const Imf::Header& header) {
  const auto* found = header.findTypedAttribute<Imf::EnvmapAttribute>("envmap");
  return found && found->value() == Imf::ENVMAP_CUBE;
}

Plane<glm::vec3> lat_long_of_cube(const Plane<glm::vec3>& cube) {
  // As many texels on the horizon as the four faces that it crosses.
  const int columns = std::clamp(4 * cube.width, kLeastColumns, kMostColumns), rows = columns / 2;
  const int samples = kSamples * std::max(1, 4 * cube.width / columns);
  Plane<glm::vec3> out(columns, rows);
  std::vector<glm::vec2> horizon(std::size_t(columns) * std::size_t(samples));  // x and z
  for (std::size_t i = 0; i < horizon.size(); ++i) {
    const float longitude =
        2 * glm::pi<float>() * (0.5f - (float(i) + 0.5f) / float(horizon.size()));
    horizon[i] = {std::sin(longitude), std::cos(longitude)};
  }
  for_each_row(rows, [&](int y) {
    float weights = 0;
    for (int down = 0; down < samples; ++down) {
      const float polar =
          glm::pi<float>() * (float(samples * y + down) + 0.5f) / float(samples * rows);
      const float across = std::sin(polar), height = std::cos(polar);
      for (std::size_t i = 0; i < horizon.size(); ++i) {
        out(int(i) / samples, y) +=
            across * look_up(cube, {across * horizon[i].x, height, across * horizon[i].y});
      }
      weights += float(samples) * across;  // which is in proportion to the solid angle
    }
    for (int x = 0; x < columns; ++x) out(x, y) /= weights;
  });
  return out;
}

}  // namespace ssdo
