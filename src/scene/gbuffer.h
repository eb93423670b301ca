// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "math/downsampling.h"
#include "math/pixel_grid.h"
#include "math/plane.h"
#include "scene/depth_model.h"
#include "scene/objects/object_masks.h"

namespace ssdo {

/// A space that P and N are stored in.
enum class Space { world, camera };

/// How the layers of a frame are to be read, as all of its pixels say together.
struct Encodings {
  bool depth_is_negative = false;               ///< the z of a camera that looks along -z
  bool depth_is_wrong = false;                  ///< contradicts P, and is left out
  std::optional<DepthModel> depth_of_position;  ///< where there are both
  bool normals_tell = false;                    ///< a normal of 0 means that there is no surface
  bool normals_are_colors = false;              ///< stored as n/2 + 1/2
  float albedo_premultiplied = 1;               ///< 1 by alpha, 0 not; between: in doubt
};

/// The layers of one frame in the space and units of the file, with encodings undone. Every plane
/// covers `window`, which holds P and the rendered layers that composites are made of; only those
/// of the beauty cover the window of the outputs instead. A role that the frame does not have is an
/// empty plane.
struct GBuffer {
  PixelGrid grid = {};     ///< the pixels of the file that the planes hold
  Window window, display;  ///< in these pixels
  Window file_window;      ///< that of the frame in pixels of the file, whatever the grid
  Window file_display;     ///< of all, where the grid is coarser
  std::optional<Window> lead_window;  ///< what P, or else the depth, covers, where that is less:
                                      ///< around it is background
  std::optional<Window> part_of;      ///< the window of the frame, where this is some rows of it
  Encodings encodings;
  Downsampling downsampling = {};  ///< from these windows to those of the outputs
  float pixel_aspect = 1;
  /// What the header says in numbers, by the names of attributes; the camera may be among it.
  std::map<std::string, std::vector<double>> header = {};
  bool by_blender = false;
  Plane<glm::vec3> position, normal, albedo, radiance;
  Plane<glm::vec3> beauty;    ///< as rendered; empty where no composite uses it
  Plane<glm::vec3> ambient;   ///< the part of `beauty` that ambient light gave
  Plane<glm::vec3> specular;  ///< the part of `beauty` that mirrors the surroundings
  std::map<std::string, Plane<glm::vec3>> lights;  ///< the part that each lamp gave, by its name
  Plane<float> depth, alpha;        ///< depth: along the axis or the ray, in scene units
  Plane<float> roughness;           ///< of what mirrors, 0..1
  Plane<glm::vec3> specular_color;  ///< what is mirrored of light along the normal (F0), 0..1
  Plane<glm::vec2> motion;  ///< pixels, x right and y down, to its place in the frame before
  DepthKind depth_kind = DepthKind::planar;  ///< planar or ray: others are converted
  std::string depth_source = {};             ///< what tells its kind, "P"; empty: it is assumed
  std::string albedo_alpha = {};    ///< how alpha was in the albedo; empty: it makes no difference
  std::optional<Space> space = {};  ///< of P and N, where the user says it
  Plane<unsigned char> valid;       ///< 1 geometry, 0 background or broken
  Plane<unsigned char> broken;      ///< 1 where P is; empty: nowhere
  ObjectMasks masks;
  float position_step = 0;  ///< relative rounding step of P (or depth) as stored
  std::size_t background_pixels = 0;
  std::size_t bad_pixels = 0;  ///< pixels with a NaN or infinity in a role that is used
  std::vector<std::string> warnings;

  /// The display window in pixels of the file, whatever the grid.
  const Window& display_of_file() const { return grid.is_coarse() ? file_display : display; }
};

}  // namespace ssdo
