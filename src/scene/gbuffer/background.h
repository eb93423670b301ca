// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "scene/gbuffer.h"

namespace ssdo {

/// Depths and coordinates from here on show nothing: Blender writes 1e10 where a ray meets nothing.
inline constexpr float kEmptyDepth = 1e9f;

/// Relative rounding of half floats, which keep 11 bits.
inline constexpr float kStepHalf = 1.0f / 2048;

/// Fills `valid` and `broken`, and counts background and broken pixels. A pixel is background where
/// anything says so: alpha is 0; P is 0, not finite, or kEmptyDepth or more, or what half cannot
/// hold where it is stored in half; N is 0; or the depth is `background_depth` or more, not finite,
/// 0 or less. P or N of 0 does not count where the depth agrees with P there, and N of 0 does not
/// count in a layer that is 0 everywhere. So are all pixels outside `lead_window`.
///
/// Encodings `known` from all of a frame hold for a part of it; else they are found here.
///
/// An alpha of 0 everywhere is left out, and its plane emptied, where other layers show surfaces.
///
/// Where there is P, a depth that contradicts it (depth_model.h) is left out with a warning, and
/// the plane is emptied. A P that is not finite counts as broken where a depth shows a surface.
void find_background(GBuffer& g, std::optional<float> background_depth,
                     const std::optional<Encodings>& known = {});

}  // namespace ssdo
