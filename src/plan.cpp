// SPDX-License-Identifier: Apache-2.0
#include "plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>

#include "error.h"
#include "estimators/registry.h"
#include "io/image_file.h"
#include "math/luminance.h"

namespace ssdo {
namespace {

constexpr std::array<std::string_view, 7> kProducts = {"ao",     "bent",  "reflection", "direct",
                                                       "bounce", "error", "composite"};

/// What an EXR holds where --products is not given, as far as frame and method allow.
constexpr std::array<std::string_view, 4> kUsualProducts = {"ao", "direct", "bounce", "composite"};

/// --products all: whatever frame and method allow.
constexpr std::string_view kAll = "all";

/// Share of the frame's height at the median depth, of methods that need a limit. Of 0.1 to 2, the
/// one with the least error of direct light against a path tracer on five of seven frames.
constexpr float kAutoRadius = 0.3f;

/// A bounce from surfaces that are darker than this everywhere is below 1 % of the light.
constexpr float kDarkAlbedo = 0.01f;

using Names = std::vector<std::string>;

bool contains(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool makes(const Method& method, std::string_view product, bool ambient) {
  const ProductSet& can = method.products;
  if (product == "composite" && ambient) return can.ao;
  return product == "ao"           ? can.ao
         : product == "bent"       ? can.bent
         : product == "reflection" ? can.reflection
         : product == "bounce"     ? can.bounce
         : product == "error"      ? can.error
                                   : can.direct;
}

std::string methods_that_make(std::string_view product, bool ambient) {
  std::string names;
  for (const Method& method : methods()) {
    if (makes(method, product, ambient))
      names += (names.empty() ? "" : ", ") + std::string(method.name);
  }
  return names;
}

/// Decides what is made, and in which files it goes.
class ProductChoice {
 public:
  ProductChoice(const Method& method, const OutputOptions& output, const Scene& scene,
                const GBuffer& gbuffer, const std::string& file)
      : method_(method),
        output_(output),
        albedo_(!scene.senders.albedo.empty()),
        ambient_(!gbuffer.ambient.empty()),
        roughness_(!scene.roughness.empty()),
        file_(file) {}

  void choose(Plan& plan) const {
    const auto is_picture = [](const std::string& path) { return is_display_image(path); };
    const auto pictures = std::count_if(output_.files.begin(), output_.files.end(), is_picture);
    const bool only_saves = output_.files.empty() && !output_.saves.empty();
    if (std::size_t(pictures) < output_.files.size() || (output_.files.empty() && !only_saves)) {
      plan.write = of_exr();
      if (output_.products.empty() && !albedo_)
        plan.reasons.push_back(ambient_ ? "no bounce: there is no albedo"
                                        : "no bounce and no composite: there is no albedo");
    }
    Names wanted = output_.products;
    std::erase(wanted, kAll);
    wanted.insert(wanted.end(), plan.write.begin(), plan.write.end());
    for (const SaveRequest& save : output_.saves) wanted.push_back(save.product);
    if (pictures > 0) wanted.push_back(plan.show = of_picture());
    for (const std::string& name : wanted) check(name);
    for (const std::string_view name : kProducts) {
      if (contains(wanted, name)) plan.make.emplace_back(name);
    }
    const bool lit = contains(wanted, "composite") && !ambient_;
    const bool error = contains(wanted, "error") || plan.error;
    plan.request.products.ao =
        contains(wanted, "ao") || (contains(wanted, "composite") && ambient_);
    plan.request.products.bent = contains(wanted, "bent");
    plan.request.products.reflection = contains(wanted, "reflection");
    plan.request.products.error = error;
    plan.request.products.direct = contains(wanted, "direct") || lit || error;
    plan.request.products.bounce = contains(wanted, "bounce") || lit || (error && albedo_);
  }

 private:
  bool needs_albedo(std::string_view product) const {
    return product == "bounce" || (product == "composite" && !ambient_);
  }

  Names of_exr() const {
    Names names;
    for (const std::string_view name : kProducts) {
      // Without a layer reflections have a roughness that only who asks for them can know.
      const bool possible = makes(method_, name, ambient_) && (albedo_ || !needs_albedo(name)) &&
                            (roughness_ || name != "reflection");
      const bool usual =
          std::find(kUsualProducts.begin(), kUsualProducts.end(), name) != kUsualProducts.end();
      const bool if_possible = output_.products.empty() ? usual : contains(output_.products, kAll);
      if (contains(output_.products, name) || (if_possible && possible)) names.emplace_back(name);
    }
    return names;
  }

  /// What a picture shows: the composite, or the only product that the user names.
  std::string of_picture() const {
    if (output_.products.empty() || contains(output_.products, "composite") ||
        contains(output_.products, kAll)) {
      return "composite";
    }
    if (output_.products.size() == 1) return output_.products[0];
    throw Error(ExitCode::usage,
                "a picture shows one product, and --products names several without "
                "the composite; give each a file with --save PRODUCT=FILE");
  }

  void check(const std::string& name) const {
    if (std::find(kProducts.begin(), kProducts.end(), name) == kProducts.end()) {
      throw Error(
          ExitCode::usage,
          fmt::format("product '{}': there are ao, bent, reflection, direct, bounce, error, "
                      "composite, and all",
                      name));
    }
    if (!makes(method_, name, ambient_)) {
      throw Error(ExitCode::usage, fmt::format("method {} makes no {}; these do: {}", method_.name,
                                               name, methods_that_make(name, ambient_)));
    }
    if (!albedo_ && needs_albedo(name)) {
      throw Error(
          ExitCode::layer,
          fmt::format("{}: {} needs a layer for albedo and none was found by name; name one "
                      "with --aov albedo=LAYER, or another product with --save PRODUCT=FILE",
                      file_, name));
    }
  }

  const Method& method_;
  const OutputOptions& output_;
  bool albedo_, ambient_, roughness_;  ///< layers that the frame has
  const std::string& file_;
};

void explain_composite(Plan& plan, const GBuffer& gbuffer) {
  if (gbuffer.ambient.empty() || !contains(plan.make, "composite")) return;
  plan.reasons.push_back(gbuffer.beauty.empty()
                             ? "composite is the ambient layer times ao: there is no beauty"
                             : "composite is the beauty with its ambient part times ao; all other "
                               "light stays as rendered");
}

void explain_reflection(Plan& plan, const Scene& scene) {
  if (!plan.request.products.reflection || !scene.roughness.empty()) return;
  plan.reasons.push_back(
      fmt::format("reflection: roughness {:g} everywhere, there is no layer of it",
                  plan.request.parameters.at("roughness")));
}

/// Bounces by a fit belong to the light of a method, not to a product that could be left out.
void check_multi_bounce(const Plan& plan, const Scene& scene, const std::string& file) {
  const auto wanted = plan.request.parameters.find("multi-bounce");
  if (wanted == plan.request.parameters.end() || wanted->second == 0) return;
  if (!plan.request.products.direct || !scene.senders.albedo.empty()) return;
  throw Error(ExitCode::layer,
              fmt::format("{}: --set multi-bounce=1 needs a layer for albedo and none was found by "
                          "name; name one with --aov albedo=LAYER, or leave it out",
                          file));
}

void choose_bounces(Plan& plan, int wanted, const Scene& scene) {
  plan.request.bounces = plan.request.products.bounce ? wanted : 0;
  if (plan.request.bounces == 0 || !scene.senders.radiance.empty()) return;
  float brightest = 0;
  for (const glm::vec3& c : scene.senders.albedo.pixels)
    brightest = std::max({brightest, c.x, c.y, c.z});
  if (brightest >= kDarkAlbedo) return;
  plan.request.bounces = 0;
  plan.reasons.push_back(fmt::format("no bounce: the albedo is {:.2g} at most", double(brightest)));
}

void explain_light(Plan& plan, const Light& light) {
  if (!plan.request.products.direct) return;
  if (light.is_constant()) {
    plan.reasons.push_back("direct is ao times the environment's one colour: no directions");
    return;
  }
  for (const Sun& sun : light.suns) {
    plan.reasons.push_back(fmt::format("a sun {:.2g} degrees wide, {:.3g} of light, by itself",
                                       2 * glm::degrees(sun.angular_radius),
                                       luminance(sun.irradiance)));
  }
  std::string energy;
  for (const double share : light.band_energy) energy += fmt::format(" {:.1f}", 100 * share);
  plan.reasons.push_back(
      fmt::format("light in spherical harmonics to order {}: bands hold{} % of its energy, and "
                  "those left out {:.1f} % of what a lobe sees",
                  light.order, energy, 100 * light.residual()));
}

void choose_radius(Plan& plan, const ModelOptions& model, const Geometry& geometry) {
  if (!plan.method->has_radius) {
    if (model.radius) {
      throw Error(ExitCode::usage,
                  fmt::format("method {} takes no --radius; see --list-methods for its parameters",
                              plan.method->name));
    }
    return;
  }
  if (model.radius) {
    plan.request.radius = float(*model.radius);
    if (std::isinf(plan.request.radius) && !plan.method->takes_solids()) {
      throw Error(ExitCode::usage,
                  fmt::format("--radius inf: method {} needs a limit", plan.method->name));
    }
    plan.reasons.push_back(fmt::format("radius {:.4g}: as given", plan.request.radius));
  } else if (plan.method->takes_solids()) {
    plan.request.radius = INFINITY;
    plan.reasons.push_back("radius inf: light is stopped by whatever the frame shows or suggests");
  } else {
    plan.request.radius = kAutoRadius * geometry.frame_height_at(geometry.median_depth);
    plan.reasons.push_back(
        fmt::format("radius {:.4g}: {:g} of the frame's height at the median depth {:.4g}",
                    plan.request.radius, kAutoRadius, geometry.median_depth));
  }
}

void explain_thickness(Plan& plan, const ModelOptions& model) {
  plan.reasons.push_back(model.thickness
                             ? fmt::format("thickness {:.4g}: as given", *model.thickness)
                             : std::string("thickness: as wide as it looks, and what is covered "
                                           "goes on behind"));
}

void choose_march(Plan& plan, const ModelOptions& model) {
  if (!plan.method->marches) {
    const bool solids = plan.method->has_solids;
    const bool asked = model.slices || model.steps || (model.thickness && !solids) || model.error;
    if (asked) {
      throw Error(ExitCode::usage, fmt::format("method {} takes no --slices, --steps{} or --error; "
                                               "see --list-methods for its parameters",
                                               plan.method->name, solids ? "" : ", --thickness"));
    }
    if (solids) explain_thickness(plan, model);
    return;
  }
  plan.request.slices = model.slices.value_or(slices_of(model.quality));
  plan.request.steps = model.steps.value_or(steps_of(model.quality));
  plan.request.extend_offscreen = model.extend_offscreen;
  if ((plan.request.products.error || plan.error) && plan.request.slices < 2) {
    plan.request.slices = 2;
    plan.reasons.push_back("2 slices: the noise is the difference of two halves");
  }
  if (plan.request.products.error)
    plan.reasons.push_back("error: a second run with half of the steps shows what few steps miss");
  explain_thickness(plan, model);
  if (!plan.request.extend_offscreen)
    plan.reasons.push_back("surfaces end with the frame: as asked");
}

}  // namespace

int Plan::samples_per_pixel() const {
  return method->marches ? 2 * request.slices * request.steps
                         : method->samples_per_pixel(request.parameters);
}

Plan make_plan(const ModelOptions& model, const OutputOptions& output, const Scene& scene,
               const GBuffer& gbuffer, const std::string& file) {
  Plan plan;
  plan.method = &find_method(model.method);
  plan.request.parameters = resolve_parameters(*plan.method, model.set);
  plan.filter = &find_filter(model.filter);
  plan.temporal = model.temporal;
  plan.request.seed = model.seed;
  plan.error = model.error;
  ProductChoice(*plan.method, output, scene, gbuffer, file).choose(plan);
  explain_composite(plan, gbuffer);
  explain_reflection(plan, scene);
  check_multi_bounce(plan, scene, file);
  choose_bounces(plan, model.bounces, scene);
  explain_light(plan, scene.light);
  choose_radius(plan, model, scene.geometry);
  choose_march(plan, model);
  return plan;
}

nlohmann::json to_json(const Plan& plan) {
  nlohmann::json j = {{"method", plan.method->name},
                      {"parameters", plan.request.parameters},
                      {"products", plan.make},
                      {"bounces", plan.request.bounces},
                      {"samples_per_pixel", plan.samples_per_pixel()},
                      {"filter", plan.filter->name},
                      {"temporal", plan.temporal},
                      {"reasons", plan.reasons}};
  // JSON knows no infinity.
  if (plan.method->has_radius)
    j["radius"] = std::isinf(plan.request.radius) ? nlohmann::json("inf")
                                                  : nlohmann::json(plan.request.radius);
  if (plan.method->marches) {
    j["slices"] = plan.request.slices;
    j["steps"] = plan.request.steps;
    j["offscreen"] = plan.request.extend_offscreen ? "extend" : "open";
  }
  return j;
}

}  // namespace ssdo
