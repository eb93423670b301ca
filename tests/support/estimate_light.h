// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "relight/estimate.h"

namespace ssdo::test {

/// What the plan makes of a frame alone.
inline Estimate estimate_light(Scene scene, const Plan& plan) {
  Estimate found = estimate(std::move(scene), plan, [](double) {});
  light_products(found, plan);
  return found;
}

}  // namespace ssdo::test
