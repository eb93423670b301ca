// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Rays begin above the surface that a pixel shows, by so many times what storing P may have moved
/// it, and by a part of what the pixel shows, which is large against the rounding of a ray.
constexpr float kAboveRoundings = 4, kAboveFootprints = 2e-3f;

}  // namespace ssdo
