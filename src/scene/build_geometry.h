// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// Finds the camera and brings the frame into camera space, computing in double and rounding once.
/// P comes from depth where there is none; N from P where it is missing or not usable; normals
/// that are the back of what P shows are turned to the viewer. With `known`, the placement of the
/// frame that the G-buffer is some rows of, nothing is found anew.
/// Errors: ExitCode::layer where neither P nor the options nor the header determine the camera.
Geometry build_geometry(const GBuffer& gbuffer, const CameraOptions& options,
                        const std::string& file, GeometryReport& report,
                        const Placement* known = nullptr);

}  // namespace ssdo
