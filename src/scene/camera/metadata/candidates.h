// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/camera/camera.h"
#include "scene/camera/metadata/matrices.h"

namespace ssdo {

/// What attributes of a header say of the camera, by one reading of them. Nothing of it is proved.
struct HeaderCamera {
  std::string source;   ///< the attributes: "worldToCamera + worldToNDC"
  std::string reading;  ///< "" as their writer means them, else "transposed", "inverse", ...
  Camera camera;
  bool has_pose = false, has_lens = false;
  /// Whether the header confirms it: a second attribute says the same.
  bool pose_agrees = false, lens_agrees = false;
  bool is_one_matrix = false;      ///< pose and lens: where P has another lens, the pose is wrong
  std::string doubt = {};          ///< where numbers differ on the lens: how, for messages
  std::string contradiction = {};  ///< where matrices cannot be of one camera: P alone decides
};

/// The cameras that the numbers of a header may mean, those of one source after each other, the
/// reading of its writer first:
///
///   worldToCamera, worldToNDC    OpenEXR's standard: Arnold, RenderMan; pbrt-v4, transposed
///   cameraTransform, cameraFov, cameraAperture, cameraFocalLength      V-Ray
///   rs/camera/transform, rs/camera/fov                                 Redshift
///   unreal/.../curPos/x, curRot/yaw, fov, focalLength, sensorWidth     Unreal
///
/// OpenImageIO renames V-Ray's cameraTransform to worldToCamera; beside V-Ray's other attributes
/// worldToCamera is read as cameraTransform.
std::vector<HeaderCamera> header_cameras(const std::map<std::string, std::vector<double>>& header,
                                         const PictureWindows& windows);

/// The matrices of a header that hold no pose, and its fields of view that no lens has: a message
/// for each.
std::vector<std::string> unusable_poses(const std::map<std::string, std::vector<double>>& header);
std::vector<std::string> unusable_lenses(const std::map<std::string, std::vector<double>>& header);

}  // namespace ssdo
