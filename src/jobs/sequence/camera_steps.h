// SPDX-License-Identifier: Apache-2.0
//
// How far a camera goes from frame to frame, by what it shows: nine points of a frame, spread over
// its picture at the median depth of its surfaces, are projected by the next camera.
#pragma once

#include <optional>
#include <vector>

#include "math/plane.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// The camera of a frame of a sequence.
struct CameraOfFrame {
  int number = 0;  ///< of the frame
  Camera camera;   ///< in the pixels of `display`; no panorama
  Window display;
  double depth = 0;  ///< median, over the surfaces; scene units
};

/// From a frame to the next one in time.
struct CameraStep {
  int from = 0, to = 0;  ///< numbers of the frames
  /// The mean distance in the picture by which the nine points move, in widths of the picture. A
  /// point that goes behind the camera, or by more than a width, counts as one width.
  double widths = 0;
  bool jumps = false;
};

/// How far what `before` shows moves in the picture; see CameraStep::widths.
double widths_between(const CameraOfFrame& before, const CameraOfFrame& now);

/// The steps between cameras in the order of their numbers. A step jumps, as at a cut, if it is
/// more than a quarter of the picture and more than three times the median of the steps around it:
/// a quick pan does not. Frames more than four numbers apart tell nothing.
std::vector<CameraStep> camera_steps(std::vector<CameraOfFrame> cameras);

}  // namespace ssdo
