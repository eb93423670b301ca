// SPDX-License-Identifier: Apache-2.0
#include "plan/plan.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace ssdo {

int Plan::samples_per_pixel() const { return method->samples_per_pixel(request); }

nlohmann::json to_json(const Plan& plan, const std::vector<std::string>& history) {
  std::vector<std::string> reasons = plan.reasons;
  reasons.insert(reasons.end(), history.begin(), history.end());
  nlohmann::json j = {{"method", plan.method->name},
                      {"parameters", plan.request.parameters},
                      {"products", plan.make},
                      {"bounces", plan.request.bounces},
                      {"samples_per_pixel", plan.samples_per_pixel()},
                      {"filter", plan.filter_name()},
                      {"temporal", plan.temporal},
                      {"shot", plan.shot},
                      {"downsample", plan.downsample},
                      {"reasons", reasons}};
  if (contains(plan.make, "composite")) j["compose"] = name_of(plan.composition.compose);
  // JSON knows no infinity.
  if (plan.method->supports.radius)
    j["radius"] = std::isinf(plan.request.radius) ? nlohmann::json("inf")
                                                  : nlohmann::json(plan.request.radius);
  if (plan.method->supports.march) {
    j["slices"] = plan.request.slices;
    j["steps"] = plan.request.steps;
    j["prior"] = plan.prior ? "learned" : "rules";
    j["offscreen"] = plan.request.extend_offscreen ? "extend" : "open";
  }
  return j;
}

}  // namespace ssdo
