// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/plane.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// A matrix of a header: 16 numbers, row by row as stored.
using StoredMatrix = std::array<double, 16>;

enum class PoseDirection { to_camera, to_world };

/// The axes that a renderer gives camera space.
enum class CameraAxes {
  along_z,               ///< x right, y up, z the view, as OpenEXR defines worldToCamera
  along_minus_z,         ///< x right, y up, -z the view, as Camera has them
  along_z_x_left,        ///< x left, y up, z the view: Redshift's
  along_z_y_down,        ///< x right, y down, z the view: those of computer vision
  along_minus_y_z_down,  ///< x right, z down, -y the view: V-Ray's
  along_y_z_up           ///< x right, z up, y the view
};

/// What a renderer says a matrix is.
struct PoseConvention {
  PoseDirection direction;
  CameraAxes axes;
};

/// A pose, and how the matrix has to be read for it.
struct PoseReading {
  glm::dmat3 rotation;  ///< as of Camera
  glm::dvec3 origin;
  bool transposed = false;  ///< stored for column vectors
  std::string how;          ///< "" as the convention says; else "transposed, inverse"
};

/// All readings of a matrix as the pose of a camera: that of the convention, then the inverse, with
/// all the axes that renderers use. Imath's matrices are for row vectors, their translation in the
/// last row; where that is 0 0 0 1, the matrix is transposed, and may be either if its last column
/// is too. Nothing for a matrix that is no rotation and translation.
std::vector<PoseReading> read_pose(const StoredMatrix& stored, const PoseConvention& convention);

/// The parts of the picture that worldToNDC may map to 0..1.
enum class NdcWindow {
  y_down,  ///< OpenEXR: from the upper left corner of the display window to the lower right
  y_up,    ///< from the lower left to the upper right
  y_up_on_shorter,  ///< pbrt-v4: the shorter side of the window is 0..1, about its middle
  data_y_down       ///< OpenEXR's, of a display window that became the data window, for overscan
};

inline constexpr std::array kNdcWindows = {NdcWindow::y_down, NdcWindow::y_up,
                                           NdcWindow::y_up_on_shorter, NdcWindow::data_y_down};

/// The windows of a file, in its pixels, and their shape.
struct PictureWindows {
  Window display, data;
  double pixel_aspect = 1;
};

/// The name of an NDC window in messages: "" for OpenEXR's.
std::string_view name_of(NdcWindow window);

/// The camera whose worldToNDC this is: projection and pose of a perspective one. Nothing for a
/// matrix that shears.
std::optional<Camera> read_perspective(const StoredMatrix& stored, bool transposed, NdcWindow ndc,
                                       const PictureWindows& windows);

/// The camera of a worldToNDC that may be stored with the opposite sign, which gives the same
/// projection. The camera is turned round if the plane of its near or far end, z = 0 or z = w, lies
/// behind it, and left as it is if z does not tell.
Camera turned_to_picture(Camera camera, const StoredMatrix& stored, bool transposed);

/// The orthographic camera at `pose` whose worldToNDC this is. Nothing where they differ.
std::optional<Camera> read_orthographic(const StoredMatrix& stored, const PoseReading& pose,
                                        NdcWindow ndc, const PictureWindows& windows);

/// Whether two poses are the same, to the precision of matrices of floats.
bool same_pose(const Camera& camera, const PoseReading& pose);

}  // namespace ssdo
