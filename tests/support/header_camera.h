// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scene/camera/camera.h"

namespace ssdo::test {

using HeaderNumbers = std::map<std::string, std::vector<double>>;

/// What each renderer writes of a camera, from what its documentation says.
HeaderNumbers standard_header(const Camera& camera, const Window& display);  ///< Arnold, RenderMan
HeaderNumbers pbrt_header(const Camera& camera, const Window& display);
HeaderNumbers vray_header(const Camera& camera, const Window& display);
HeaderNumbers redshift_header(const Camera& camera, const Window& display);

/// An FRotator and a place, and the camera in the left-handed world of Unreal that they make, by
/// rotations one after the other.
struct UnrealPose {
  double pitch, yaw, roll;
  glm::dvec3 place;
};
Camera unreal_camera(const UnrealPose& pose, Camera lens);
HeaderNumbers unreal_header(const UnrealPose& pose, const Camera& lens, const Window& display);

/// A matrix for row vectors as for column vectors.
std::vector<double> transposed(const std::vector<double>& matrix);

/// The inverse of a rotation and translation for row vectors.
std::vector<double> inverse(const std::vector<double>& matrix);

/// The numbers as attributes: 16 as a matrix, one as a float, under `prefix`; with `as_text`, as
/// Unreal writes them.
void add_attributes(Imf::Header& header, const HeaderNumbers& numbers,
                    const std::string& prefix = "", bool as_text = false);

}  // namespace ssdo::test
