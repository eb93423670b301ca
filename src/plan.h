// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "filters/registry.h"
#include "options.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"
#include "scene/light_model.h"

namespace ssdo {

/// What will be computed for a frame, and why.
struct Plan {
  const Method* method = nullptr;
  ParameterValues parameters;
  ProductSet products;  ///< what the method is asked for
  float radius = 0;     ///< scene units; 0 of a method without one
  int bounces = 0;
  int slices = 0, steps = 0;  ///< of methods that march
  bool extend_offscreen = true;
  std::optional<double> error;       ///< to stay below
  std::string isa;                   ///< instruction set of the inner loops
  const Filter* filter = nullptr;    ///< after the estimate
  bool temporal = false;             ///< then the mean with the frames before
  unsigned seed = 0;                 ///< of the sampling pattern
  std::vector<std::string> make;     ///< products for any of the outputs
  std::vector<std::string> write;    ///< those that every EXR of -o holds, in their order there
  std::string show;                  ///< the one that every picture of -o holds
  std::vector<std::string> reasons;  ///< one line per decision

  int samples_per_pixel() const;
};

/// Decides from what was asked for and what the frame shows: work that cannot change a product
/// that is written is left out.
/// Errors: ExitCode::usage for a product that the method does not make, or several for one
/// picture; ExitCode::layer for one whose layer is missing.
/// `light` is that of the environment; null where it is constant.
Plan make_plan(const ModelOptions& model, const OutputOptions& output, const GBuffer& gbuffer,
               const Geometry& geometry, const LightModel* light, const std::string& file);

nlohmann::json to_json(const Plan& plan);

}  // namespace ssdo
