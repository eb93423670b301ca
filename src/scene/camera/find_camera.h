// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "error.h"
#include "scene/camera/found_camera.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// P leaves the camera open: its pixels lie in one plane, or are too few. The camera of another
/// frame of the sequence would settle it.
struct UndeterminedCamera : Error {
  using Error::Error;
};

/// Decides by projection. The camera of the options is used if P projects to its own pixels under
/// it, or if no camera fits better; else the camera fitted from P, with a warning. Without options,
/// the camera is that fitted from P, or the header's if P or the lens of P agrees with it, or if P
/// leaves the camera open. If neither tells it, the camera of another frame is moved to fit P.
/// Errors: ExitCode::layer where neither P nor the options nor the header determine the camera;
/// UndeterminedCamera where there is a P.
FoundCamera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report);

}  // namespace ssdo
