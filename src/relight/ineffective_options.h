// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "plan/plan.h"
#include "relight/frame_options.h"

namespace ssdo {

/// What frames are prepared for.
enum class Purpose { relight, bench, other };

/// A warning for each option of `given` that has no effect in combination with the others, whatever
/// the frame holds. It is no error, since one script may serve frames and outputs of many kinds.
/// `given` holds the names of options on the command line only: a config file is for many jobs.
std::vector<std::string> ineffective_options(const std::set<std::string>& given,
                                             const FrameOptions& options, Purpose purpose);

/// What a frame holds for options that other frames have no use for.
struct FrameFacts {
  const Plan& plan;
  /// Layers; depth may be that of deep pixels.
  bool depth, position, normal, ambient, specular, lights, specular_color;
  bool constant_light;  ///< the environment is the same from everywhere
  bool lamps;
  bool overscan;  ///< a layer that outputs take has pixels beyond the display window
};

/// A warning for each option that has no effect on this frame.
std::vector<std::string> ineffective_options(const FrameOptions& options, const FrameFacts& frame);

}  // namespace ssdo
