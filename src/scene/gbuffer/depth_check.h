// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"

namespace ssdo {

/// Says what the depth layer holds instead of a depth ("the y of P", for a message). Empty if it is
/// right: if in most pixels it is the distance of P from `camera`, along the axis or along the ray,
/// to 5 % and the rounding of P. A depth with next to no surface where P has some is wrong. For an
/// orthographic camera, depths may begin anywhere. `camera` is the one that fits P; P and depth are
/// as read.
std::string what_depth_is_instead(const GBuffer& g, const Camera& camera);

}  // namespace ssdo
