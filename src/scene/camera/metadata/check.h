// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "scene/camera/found_camera.h"
#include "scene/camera/metadata/candidates.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// The camera of a frame whose P determines the projection `fitted`, which stays, with what the
/// header adds. Where P is in world space, a reading of the header agrees with it, or a warning
/// says that none does. Where P is in camera space, the header gives the pose, unless its lens
/// contradicts P.
FoundCamera check_against_fit(const Camera& fitted, const GBuffer& g,
                              const std::vector<HeaderCamera>& header, GeometryReport& report);

/// The camera of the header for a frame whose P lies in a plane or in few pixels: a reading under
/// which P, in the world or in camera space, projects to its own pixels; nothing if there is none.
std::optional<FoundCamera> find_by_positions(const GBuffer& g,
                                             const std::vector<HeaderCamera>& header,
                                             GeometryReport& report);

/// The camera of the header for a frame of depth alone: its first reading with a lens that fits the
/// window and the shape of its pixels. Nothing if there is none.
std::optional<FoundCamera> find_for_depth(const GBuffer& g, const std::vector<HeaderCamera>& header,
                                          GeometryReport& report);

/// "header worldToCamera + worldToNDC (transposed)", for messages.
std::string describe(const HeaderCamera& camera);

}  // namespace ssdo
