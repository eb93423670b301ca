// SPDX-License-Identifier: Apache-2.0
#include "plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "error.h"
#include "estimators/registry.h"

namespace ssdo {
namespace {

constexpr std::array<std::string_view, 4> kProducts = {"ao", "direct", "bounce", "composite"};

/// Share of the frame's height at the median depth. Of 0.1 to 2, the one with the least error of
/// direct light against a path tracer on five of seven frames, and close to it on the others.
constexpr float kAutoRadius = 0.3f;

bool has_albedo(const GBuffer& gbuffer) {
  return std::any_of(gbuffer.albedo.pixels.begin(), gbuffer.albedo.pixels.end(),
                     [](const glm::vec3& c) { return c != glm::vec3(0); });
}

/// The products that the user names, or all that the frame allows.
std::vector<std::string> wanted_products(const OutputOptions& output, bool albedo,
                                         const std::string& file, Plan& plan) {
  std::vector<std::string> wanted = output.products;
  for (const SaveRequest& save : output.saves) wanted.push_back(save.product);
  for (const std::string& name : wanted) {
    if (std::find(kProducts.begin(), kProducts.end(), name) == kProducts.end()) {
      throw Error(ExitCode::usage,
                  fmt::format("product '{}': method {} makes ao, direct, bounce and "
                              "composite",
                              name, plan.method->name));
    }
    if (!albedo && (name == "composite" || name == "bounce")) {
      throw Error(ExitCode::layer,
                  fmt::format("{}: {} needs a layer for albedo and none was found by "
                              "name; name one with --aov albedo=LAYER",
                              file, name));
    }
  }
  if (output.products.empty()) {
    for (const std::string_view name : kProducts) {
      const bool possible = albedo || name == "ao" || name == "direct";
      if (possible) wanted.emplace_back(name);
    }
    if (!albedo) plan.reasons.push_back("no bounce and no composite: there is no albedo");
  }
  std::vector<std::string> ordered;
  for (const std::string_view name : kProducts) {
    if (std::find(wanted.begin(), wanted.end(), name) != wanted.end()) ordered.emplace_back(name);
  }
  return ordered;
}

}  // namespace

bool Plan::writes(std::string_view product) const {
  return std::find(write.begin(), write.end(), product) != write.end();
}

Plan make_plan(const ModelOptions& model, const OutputOptions& output, const GBuffer& gbuffer,
               const Geometry& geometry, const Environment& environment, const std::string& file) {
  Plan plan;
  plan.method = &find_method(model.method);
  plan.parameters = resolve_parameters(*plan.method, model.set);
  plan.filter = model.filter;
  plan.write = wanted_products(output, !gbuffer.albedo.empty(), file, plan);
  plan.composite = plan.writes("composite");
  plan.products.ao = plan.writes("ao");
  plan.products.direct = plan.writes("direct") || plan.composite;
  plan.products.bounce = plan.writes("bounce") || plan.composite;

  plan.bounces = plan.products.bounce ? model.bounces : 0;
  if (plan.bounces > 0 && gbuffer.radiance.empty() && !has_albedo(gbuffer)) {
    plan.bounces = 0;
    plan.reasons.push_back("no bounce: the albedo is black everywhere");
  }
  if (plan.products.direct && environment.is_constant()) {
    plan.reasons.push_back("direct is ao times the environment's one colour: no lookups");
  }
  if (model.radius) {
    plan.radius = float(*model.radius);
    plan.reasons.push_back(fmt::format("radius {:.4g}: as given", plan.radius));
  } else {
    plan.radius = kAutoRadius * geometry.frame_height_at(geometry.median_depth);
    plan.reasons.push_back(
        fmt::format("radius {:.4g}: {:g} of the frame's height at the median depth {:.4g}",
                    plan.radius, kAutoRadius, geometry.median_depth));
  }
  return plan;
}

nlohmann::json to_json(const Plan& plan) {
  nlohmann::json j = {{"method", plan.method->name}, {"parameters", plan.parameters},
                      {"products", plan.write},      {"radius", plan.radius},
                      {"bounces", plan.bounces},     {"filter", plan.filter ? "geometry" : "none"},
                      {"reasons", plan.reasons}};
  return j;
}

}  // namespace ssdo
