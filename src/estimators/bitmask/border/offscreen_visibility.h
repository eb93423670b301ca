// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// The share of light, 0..1, that arrives along rays that leave the frame: `past` if no surface
/// continued beyond the border blocks the ray, `through` if one does.
struct OffscreenVisibility {
  float unblocked = 1, blocked = 0;
};

}  // namespace ssdo
