// SPDX-License-Identifier: Apache-2.0
//
// Frames whose every number follows from a seed: what they show, how their file stores it, in which
// light, and what is asked of the tool.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "relight/frame.h"
#include "support/random_view.h"

namespace ssdo::test {

/// How camera space lies in the world of a file: origin + unit * to_world * p.
struct Pose {
  glm::dmat3 to_world{1.0};  ///< orthogonal; mirrored where the world is left-handed
  glm::dvec3 origin{0};
  double unit = 1;
};

enum class StoredNormals { world, camera, colors, none };
enum class GivenCamera { file, lens, none };

/// A number that does not belong where it is.
struct BrokenValue {
  std::size_t channel, pixel;  ///< of the file, in the order of their names
  float value;
};

/// What another camera sees of the same world, in the first one's camera space.
struct FurtherLook {
  RandomLens lens;
  Plane<SeenPoint> seen;
};

struct RandomShot {
  std::uint64_t seed = 0;
  RandomLens lens;
  Plane<SeenPoint> seen;  ///< in camera space
  Pose pose;
  std::optional<FurtherLook> further;

  // How its file stores it.
  Imf::PixelType type = Imf::FLOAT;
  bool has_position = true, has_depth = false;
  DepthKind depth_kind = DepthKind::planar;
  StoredNormals normals = StoredNormals::world;
  float empty = 0;                             ///< P and depth without a surface
  std::map<std::string, Plane<float>> colors;  ///< channels of other layers
  std::vector<BrokenValue> broken;

  // What is asked.
  GivenCamera camera = GivenCamera::file;
  Plane<glm::vec3> map;  ///< empty: the colour of options.light
  FrameOptions options;  ///< without paths; lengths are in units of camera space

  /// Whether the file holds what was seen to within the rounding of floats, which is far below a
  /// pixel, with all that places it: then other poses change nothing but rounding.
  bool is_plain() const;

  /// Whether no light of the map, and none that albedo or strength makes, is out of the ordinary.
  bool has_energy_of_nature() const;

  /// One line.
  std::string describe() const;
};

/// With `finer`, the same world in so many times the rows and columns; all else is drawn anew.
RandomShot random_shot(std::uint64_t seed, int finer = 1);

/// The pixels of a shot without broken values in a smaller data window.
RandomShot cropped(RandomShot shot, const Window& data);

/// A shot on disk: its options, with paths and in the unit of its pose.
struct StoredFrame {
  FrameOptions options;
  FrameFiles files;
};

/// Writes the files of a shot into a folder.
StoredFrame store(const RandomShot& shot, const std::filesystem::path& folder);

/// The frame of a shot, read from its file. Errors: those of prepare_frame.
Frame read_frame(const RandomShot& shot);

}  // namespace ssdo::test
