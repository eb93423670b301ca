// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/gbuffer.h"
#include "scene/surfaces.h"

namespace ssdo {

/// The camera of another frame of the sequence, in the pixels of its file and the space of its P.
struct NeighbourCamera {
  Camera camera;
  Window display;
  std::string file;
};

/// What other frames of a sequence tell, for a frame that leaves it open.
struct ShotHints {
  std::optional<NeighbourCamera> camera;
  std::string normal_space;  ///< as in GeometryReport; empty: not known
};

/// What the user says about the camera. Empty: fit it from P.
struct CameraOptions {
  std::string file;             ///< --camera: JSON with projection and pose
  std::optional<double> fov;    ///< --fov: horizontal, degrees
  std::optional<double> ortho;  ///< --ortho: width of the frame in scene units
  ShotHints shot = {};          ///< what stands in for P and N where they do not tell enough
};

/// The visible surfaces in camera space, in the scene's unit. Every stage after this one knows one
/// space and one kind of pixel.
struct Geometry {
  Window window, display;
  std::optional<Window> part_of;  ///< the window of the frame, where this is some rows of it
  Camera camera;
  Surfaces surfaces;
  float median_depth = 0;             ///< along the axis, over the surfaces
  bool world_known = false;           ///< false where P is in camera space and no pose is known
  glm::mat3 world_to_camera{1.0f};    ///< of directions; identity where the world is not known
  glm::mat3 normals_to_camera{1.0f};  ///< from the space of the input's normals; orthogonal

  bool is_surface(std::size_t i) const { return surfaces.is_surface(i); }

  /// Height of the display window at depth `depth`, in scene units.
  float frame_height_at(float depth) const {
    return float(display.height() / camera.fy * (camera.orthographic ? 1.0 : depth));
  }
};

/// How a frame lies in camera space, as all of its pixels say together.
struct Placement {
  /// The camera of the frame, and the transform from stored P to camera space; see FoundCamera.
  Camera camera, position_camera;
  bool world_given = false;
  std::optional<glm::mat3> normals_to_camera;  ///< nothing: normals are rebuilt from P
  bool mends_silhouettes = false;
  Residual residual;  ///< of P, in pixels of the file
  float median_depth = 0;
  bool world_known = false;
};

/// What proves the camera of a header for a frame, the strongest last.
enum class HeaderProof { nothing, consistency, lens, normals, positions };

/// What the header of a frame says of its camera, where that is used or agrees with P.
struct HeaderFinding {
  std::string source;   ///< the attributes
  std::string reading;  ///< "" as their writer means them, else "transposed", "inverse", ...
  HeaderProof proof = HeaderProof::nothing;
  std::optional<double> miss_px;  ///< of P from its pixels under it (median), where P proves it
};

/// How the geometry came about, for `info` and the log.
struct GeometryReport {
  std::string camera_source;  ///< "fitted from P", "--camera FILE", "--fov", "header ..."
  std::optional<HeaderFinding> header;
  std::optional<Residual> residual;
  std::string normal_space;     ///< "the space of P", "camera space", "rebuilt from P"
  bool normals_known = true;    ///< whether P tells the space of N, where there are both
  double normal_agreement = 0;  ///< share of the smooth pixels where N follows the gradient of P
  std::size_t normals_rebuilt = 0, normals_turned = 0;
  std::vector<std::string> warnings;
  Placement placement;
};

}  // namespace ssdo
