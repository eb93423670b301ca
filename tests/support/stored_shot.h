// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/layers/roles.h"
#include "support/frame_file.h"

namespace ssdo::test {

// One scene, whose right result is known, as any tool would store it: a ball and a box on a round
// ground, seen from above, with background all around. It is right-handed, in metres, z up.

/// Horizontal field of view in degrees; nearest and farthest planar depth around the scene.
inline constexpr double kShotFov = 40;
inline constexpr float kShotNear = 2, kShotFar = 10;

/// What a pixel shows.
struct ShotPixel {
  bool surface = false;
  glm::vec3 position{0}, normal{0};                      ///< in the world
  glm::vec3 position_in_camera{0}, normal_in_camera{0};  ///< x right, y up, z to the viewer
};

/// The values of a layer's channels at a pixel.
using Content = std::function<glm::vec4(const ShotPixel&)>;

/// Axes of other worlds.
inline const glm::mat3 kYUp{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
inline const glm::mat3 kLeftHandedCentimetres{{100, 0, 0}, {0, -100, 0}, {0, 0, 100}};

/// Positions in the world times `world`, or in camera space times `signs`; `empty` elsewhere.
Content world_position(const glm::mat3& world = glm::mat3(1), float empty = 0);
Content camera_position(const glm::vec3& signs = glm::vec3(1), float empty = 0);

/// Normals of the same spaces; 0 elsewhere.
Content world_normal(const glm::mat3& world = glm::mat3(1));
Content camera_normal(const glm::vec3& signs = glm::vec3(1));

/// n/2 + 1/2 of normals.
Content as_color(const Content& normal);

/// Distances along the axis or the ray, in metres times `unit`; `empty` elsewhere.
Content planar_depth(float empty = 0, float unit = 1);
Content ray_depth(float empty = 0, float unit = 1);

/// Planar depth mapped so that `zero` becomes 0 and `one` becomes 1, which is also that of the
/// farther one elsewhere.
Content remapped_depth(float zero = kShotNear, float one = kShotFar);

/// 1 over the planar depth; 0 elsewhere.
Content inverse_depth();

/// Grey with alpha 1 on surfaces; transparent black elsewhere.
Content grey();

/// Channels as a tool stores them: `content` gives the value of the first four.
struct StoredLayer {
  std::optional<Role> role;  ///< that the tool is to find, or be told, for it
  std::vector<std::string> channels;
  Content content;
  Imf::PixelType type = Imf::FLOAT;
  std::string part = {};  ///< name; layers of one name share a part
};

/// "P.X", "P.Y" and "P.Z" of "P" and "XYZ".
std::vector<std::string> channels(const std::string& layer, const std::string& components);

/// A file of the shot.
struct StoredShot {
  std::vector<StoredLayer> layers;
  std::map<std::string, std::string> attributes = {};  ///< text, in the header of every part
  bool cropped = false;  ///< data window without the background around
  bool tiled = false;
  bool apart = false;  ///< a file for each part, beside that of the first: PART.exr
};

/// Writes the shot as EXR, with as many parts, or files, as its layers name.
void write_shot(const std::filesystem::path& path, const StoredShot& shot);

/// The shot in the form that others are compared with: float, world space.
StoredShot plain_shot();

}  // namespace ssdo::test
