// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "filters/temporal.h"
#include "frame.h"

namespace ssdo {

/// Root mean square of the product `error` over the surfaces, and of the two parts whose squares
/// add up to it.
struct ErrorFound {
  double all = 0;
  double noise = 0;  ///< of so many slices: another seed changes the light by this much
  double steps = 0;  ///< of so many steps: no seed changes it
};

/// The products of a frame after the filter.
struct Estimate {
  Products products;
  std::optional<ErrorFound> error;  ///< where the plan asks for it
  History history;                  ///< of a temporal plan, for the next frame; without a geometry
  std::vector<std::string> notes, warnings;
};

/// What the method of `plan` makes of a frame, before any filter.
Products run_method(const Frame& frame, const Plan& plan, const TileProgress& progress);

/// Estimates and filters, with more and more slices and steps until the error is what the plan asks
/// for, if it does; those that were taken stand in the plan then. `told` hears how far it is, 0..1.
/// `before` is what a temporal plan takes from the frame before, if there is one.
Estimate estimate(Frame& frame, const std::function<void(double)>& told,
                  const std::optional<History>& before);

}  // namespace ssdo
