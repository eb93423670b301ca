// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"

namespace ssdo {

/// What the depth of a frame is if most of its pixels have not the distance of P from `camera`,
/// along its axis or along the rays, to 5 % and the rounding of P: "the y of P", for a message.
/// Empty where the depth is right. A depth that has next to no surface where P has some is wrong.
/// An orthographic camera leaves open where depths begin. `camera` is the one that P was found to
/// have; P and depth are as read.
std::string what_depth_is_instead(const GBuffer& g, const Camera& camera);

}  // namespace ssdo
