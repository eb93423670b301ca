// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"

namespace ssdo {

/// Says what is wrong with a P that fits no camera, and what to do: clipped, encoded with a gamma,
/// scaled to its bounding box, in 8 bits, normals or colours. The text is the predicate of a
/// sentence about P. It is empty if P is accepted, also with rounding, averages over edges or lens
/// distortion. `camera` is what was found for P, in the pixels of the G-buffer; null where P leaves
/// it open, which is no finding by itself.
std::string find_fault_of_positions(const GBuffer& g, const Camera* camera);

}  // namespace ssdo
