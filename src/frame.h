// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "color.h"
#include "io/exr_reader.h"
#include "light.h"
#include "options.h"
#include "plan.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"
#include "scene/layers.h"

namespace ssdo {

/// Milliseconds of wall time per stage.
struct StageTimes {
  double read = 0, prepare = 0, estimate = 0, filter = 0, compose = 0, write = 0;
};

/// A frame that has been read and understood: all that stands before the first estimate.
struct Frame {
  std::string input;
  std::deque<ExrReader> files;  ///< the frame, then the files that --aov names
  LayerTable layers;
  GBuffer gbuffer;
  Geometry geometry;
  GeometryReport report;
  Environment environment = Environment::constant(glm::vec3(1));
  std::optional<LightModel> light_model;  ///< of an environment that is no constant
  HiddenGeometry hidden;                  ///< for methods that march
  std::string light;  ///< one line
  Plan plan;
  StageTimes times;

  /// The layer that the products are made from: position, or depth where there is none.
  const Layer& lead() const;
  const ExrPart& part() const;
  std::vector<std::string> warnings() const;
};

/// Reads the layers of `input` and decides what to do with them: read, layers, gbuffer, camera,
/// geometry, plan. `aovs` are the requests for layers, with files of this very frame.
/// Errors: those of the stages.
Frame prepare_frame(const Options& options, const Light& light, const std::string& input,
                    const std::vector<LayerRequest>& aovs);

/// What the header of the frame's part says about colour.
ColorTags color_tags(const Frame& frame);

/// What was found and decided, for people and for programs.
std::string describe(const Frame& frame);
nlohmann::json to_json(const Frame& frame);

}  // namespace ssdo
