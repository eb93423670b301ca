// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "estimators/estimator.h"
#include "filters/temporal.h"
#include "plan/plan.h"
#include "prior/prior.h"
#include "scene/scene.h"

namespace ssdo {

/// Root mean square of the product `error` over the surfaces, and of the two parts whose squares
/// add up to it.
struct ErrorFound {
  double all = 0;
  double noise = 0;  ///< of so many slices: another seed changes the light by this much
  double steps = 0;  ///< of so many steps: no seed changes it
};

/// What was found of a frame.
struct Estimate {
  Products products;  ///< after the filter; up to light_products() with shares in place of light
  Scene scene;        ///< what is left of it: without solids, views and surfaces of other views
  Request request;    ///< of the plan, with the slices and steps that were needed
  std::optional<ErrorFound> error;  ///< where the plan asks for it
  std::optional<PriorField> prior;  ///< where there is one
  History history;                  ///< of a temporal plan, for the next frame; without a geometry
  double estimate_ms = 0, filter_ms = 0;  ///< by the clock
  std::vector<std::string> notes, warnings;
  /// The lamps whose light is nearly all blocked by surfaces: names, and the share that arrives.
  std::vector<std::pair<std::string, double>> unlit;
};

/// For a temporal plan: the frame before, if any, and the motion of the present one.
struct TemporalInput {
  std::optional<History> history;
  Plane<glm::vec2> motion;  ///< pixels to where it was there; may be empty
};

/// Estimates and filters the shares of the light that arrive, with more and more slices and steps
/// until the error is what the plan asks for, if it does. `on_progress` is called with the share
/// that is done, 0..1. What only methods look at is freed before the last filter.
Estimate estimate(Scene scene, const Plan& plan, const std::function<void(double)>& on_progress);

/// Makes the light of what estimate() has found, and takes the mean with the frames before, where
/// the plan is temporal.
void light_products(Estimate& found, const Plan& plan, const TemporalInput& temporal = {});

}  // namespace ssdo
