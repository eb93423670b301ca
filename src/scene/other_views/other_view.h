// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "math/half_color.h"
#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/geometry.h"
#include "scene/surfaces.h"

namespace ssdo {

/// What a pixel of another picture belongs to: the selection of --no-cast, that of --shadow-of, a
/// sky dome.
inline constexpr unsigned char kNoCast = 1, kShadowOf = 2, kBackdrop = 4;

/// What another camera shows of the scene, or a panorama, in its own camera space: the same for
/// every frame.
struct OtherPicture {
  std::string file;
  Camera camera;            ///< from world space to its own
  Window window;            ///< of the planes, in the pixels of its display window
  bool closed = false;      ///< a panorama whose last column lies beside its first
  Surfaces surfaces;        ///< normals are on the side of its own camera
  Plane<float> depth;       ///< Camera::depth_of; infinite where there is no surface
  Plane<HalfColor> albedo;  ///< empty where the file has none
  /// The bits above, by pixel; empty: none anywhere.
  Plane<unsigned char> object_flags;
  /// What blocks the light of linked lamps, by the text of the selection: 1 in pixels that show a
  /// blocker. Selections that the picture does not know are missing.
  std::map<std::string, Plane<unsigned char>> casts;
  /// What linked lamps light, 0..1, likewise.
  std::map<std::string, Plane<float>> receives;
  std::vector<std::string> warnings;   ///< of reading it
  std::vector<std::string> not_taken;  ///< warnings of selections that it does not know
  std::vector<std::string> losses;     ///< see ExrReader::losses()
};

/// Another picture, placed in the camera space of a frame.
struct OtherView {
  using Picture = std::shared_ptr<const OtherPicture>;

  Picture picture;
  Camera camera;              ///< from the frame's camera space to its own
  bool is_other_eye = false;  ///< of the frame's stereo pair

  /// Its surfels in the camera space of the frame.
  Surfaces surfels_in_frame() const;

  /// Width of what a pixel at this depth shows, in scene units.
  float footprint(float at_depth) const {
    return (camera.orthographic ? 1.0f : at_depth) / float(std::min(camera.fx, camera.fy));
  }
};

/// The camera that maps points from the camera space of `frame` to that of `view`. Both cameras are
/// given in one world.
Camera seen_from(const Camera& view, const Camera& frame);

/// Places a picture in the camera space of a frame whose world is known.
OtherView place(OtherView::Picture picture, const Geometry& frame);

}  // namespace ssdo
