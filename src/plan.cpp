// SPDX-License-Identifier: Apache-2.0
#include "plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "error.h"
#include "estimators/registry.h"
#include "io/image_file.h"

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

using Names = std::vector<std::string>;

bool contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void check_product(const std::string& name, bool albedo, const std::string& file) {
  if (std::find(kProducts.begin(), kProducts.end(), name) == kProducts.end()) {
    throw Error(ExitCode::usage,
                fmt::format("product '{}': there are ao, direct, bounce and composite", name));
  }
  if (!albedo && (name == "composite" || name == "bounce")) {
    throw Error(ExitCode::layer,
                fmt::format("{}: {} needs a layer for albedo and none was found by name; name one "
                            "with --aov albedo=LAYER, or another product with --save PRODUCT=FILE",
                            file, name));
  }
}

/// What an EXR holds: the products that the user names, or all that the frame allows.
Names exr_products(const OutputOptions& output, bool albedo) {
  Names names;
  for (const std::string_view name : kProducts) {
    const bool possible = albedo || name == "ao" || name == "direct";
    if (output.products.empty() ? possible : contains(output.products, name))
      names.emplace_back(name);
  }
  return names;
}

/// What a picture shows: the composite, or the only product that the user names.
std::string shown_product(const OutputOptions& output) {
  if (output.products.empty() || contains(output.products, "composite")) return "composite";
  if (output.products.size() == 1) return output.products[0];
  throw Error(ExitCode::usage,
              "a picture shows one product, and --products names several without "
              "the composite; give each a file with --save PRODUCT=FILE");
}

void choose_products(Plan& plan, const OutputOptions& output, bool albedo,
                     const std::string& file) {
  const auto is_picture = [](const std::string& path) { return is_display_image(path); };
  const auto pictures = std::count_if(output.files.begin(), output.files.end(), is_picture);
  const bool only_saves = output.files.empty() && !output.saves.empty();
  if (std::size_t(pictures) < output.files.size() || (output.files.empty() && !only_saves)) {
    plan.write = exr_products(output, albedo);
    if (output.products.empty() && !albedo) {
      plan.reasons.push_back("no bounce and no composite: there is no albedo");
    }
  }
  Names wanted = output.products;
  wanted.insert(wanted.end(), plan.write.begin(), plan.write.end());
  for (const SaveRequest& save : output.saves) wanted.push_back(save.product);
  if (pictures > 0) wanted.push_back(plan.show = shown_product(output));
  for (const std::string& name : wanted) check_product(name, albedo, file);
  for (const std::string_view name : kProducts) {
    if (contains(wanted, name)) plan.make.emplace_back(name);
  }
  const bool composite = contains(wanted, "composite");
  plan.products.ao = contains(wanted, "ao");
  plan.products.direct = contains(wanted, "direct") || composite;
  plan.products.bounce = contains(wanted, "bounce") || composite;
}

}  // namespace

Plan make_plan(const ModelOptions& model, const OutputOptions& output, const GBuffer& gbuffer,
               const Geometry& geometry, const Environment& environment, const std::string& file) {
  Plan plan;
  plan.method = &find_method(model.method);
  plan.parameters = resolve_parameters(*plan.method, model.set);
  plan.filter = model.filter;
  choose_products(plan, output, !gbuffer.albedo.empty(), file);

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
                      {"products", plan.make},       {"radius", plan.radius},
                      {"bounces", plan.bounces},     {"filter", plan.filter ? "geometry" : "none"},
                      {"reasons", plan.reasons}};
  return j;
}

}  // namespace ssdo
