// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// The share of light, 0..1, that arrives along rays that leave the frame: `past` if no surface
/// continued beyond the border blocks the ray, `through` if one does.
struct PassBeyond {
  float past = 1, through = 0;
  /// Whether surfaces that look up go on without end, whatever their extent in the frame
  /// (rays/border_extents.h), and others the less the steeper they are: what is mirrored from below
  /// the horizon is ground.
  bool ground = false;
};

}  // namespace ssdo
