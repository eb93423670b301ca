// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <optional>

#include "color/color.h"
#include "plan/outputs.h"
#include "plan/plan.h"
#include "relight/lighting.h"
#include "scene/camera/world_up.h"
#include "scene/view.h"

namespace ssdo {

/// All that the user says about the result.
struct FrameOptions {
  InputOptions input;
  CameraOptions camera;
  LightOptions light;
  ModelOptions model;
  OutputOptions output;
  ColorOptions color;
  /// Which axis is up by other frames of the sequence too, asked where nothing but P tells it; for
  /// a frame alone it is empty.
  std::function<std::optional<UpEvidence>()> up_of_shot = {};
  /// Backdrop::clearance by other frames of the sequence too, asked if this frame shows a
  /// backdrop's shape. Empty: by this frame alone.
  std::function<std::optional<double>()> backdrop_of_shot = {};
  std::size_t memory = std::numeric_limits<std::size_t>::max();  ///< bytes that a frame may take
};

}  // namespace ssdo
