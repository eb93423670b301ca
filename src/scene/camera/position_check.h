// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"

namespace ssdo {

/// What a P looks like that no camera has seen, and what to do: clipped, encoded with a gamma,
/// scaled to its bounding box, in 8 bits, normals or colours; the predicate of a sentence about it.
/// Empty where P is accepted: rounding, averages over edges and lenses with distortion are.
/// `camera` is what was found for P, in the pixels of the G-buffer; null where P leaves it open,
/// which is no finding by itself.
std::string find_fault_of_positions(const GBuffer& g, const Camera* camera);

}  // namespace ssdo
