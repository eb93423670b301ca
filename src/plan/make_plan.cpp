// SPDX-License-Identifier: Apache-2.0
#include "plan/make_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <utility>

#include "error.h"
#include "estimators/registry.h"
#include "math/luminance.h"
#include "plan/composite_choice.h"
#include "plan/product_choice.h"
#include "prior/prior.h"
#include "scene/light/distant_source.h"
#include "scene/light/light_group.h"
#include "scene/solids/width_of_run.h"

namespace ssdo {
namespace {

/// The radius of methods that need a limit, relative to the frame's height at the median depth.
/// Among 0.1 to 2 this value has the least error of direct light against a path tracer on five of
/// seven frames.
constexpr float kAutoRadius = 0.3f;

/// A bounce from surfaces that are darker than this everywhere is below 1 % of the light.
constexpr float kDarkAlbedo = 0.01f;

/// Messages call a distant source a sun up to this width, in degrees.
constexpr float kWidestSun = 4;

struct OptionOfModel {
  std::string_view name;
  bool given, taken;
};

/// A method has --slices and --steps where it marches, or as parameters of these names.
void refuse_options(const Method& method, const ModelOptions& model) {
  const SupportedOptions& supports = method.supports;
  const OptionOfModel options[] = {
      {"--radius", model.radius.has_value(), supports.radius},
      {"--thickness", model.thickness.has_value(), supports.thickness},
      {"--slices", model.slices.has_value(), supports.march || find_parameter(method, "slices")},
      {"--steps", model.steps.has_value(), supports.march || find_parameter(method, "steps")},
      {"--error", model.error.has_value(), supports.march},
      {"--prior learned, which corrects what method bitmask finds", model.prior == Prior::learned,
       supports.prior}};
  for (const OptionOfModel& option : options) {
    if (option.given && !option.taken) {
      throw Error(ExitCode::usage,
                  fmt::format("method {} takes no {}; see --list-methods for its parameters",
                              method.name, option.name));
    }
  }
}

void refuse_lamps(const Plan& plan, const Scene& scene) {
  const ProductSet& products = plan.request.products;
  if (takes_lamps(*plan.method) || !(products.direct || products.bounce)) return;
  for (const auto& source : scene.light.sources) {
    if (source->name.empty()) continue;
    throw Error(ExitCode::usage,
                fmt::format("light {}: method {} knows no shadows of lamps; take bitmask or trace",
                            source->name, plan.method->name));
  }
}

/// A parameter that has an option of its own: slices or steps of a method that does not march.
void set_by_option(Plan& plan, const std::string& name, std::optional<int> value,
                   const ModelOptions& model) {
  const Parameter* parameter = find_parameter(*plan.method, name);
  if (!value || !parameter) return;
  for (const std::string& setting : model.set) {
    if (setting.starts_with(name + "=")) {
      throw Error(ExitCode::usage,
                  fmt::format("--{} {} and --set {} set the same; give one of them", name, *value,
                              setting));
    }
  }
  check_value(*parameter, *value, fmt::format("--{} {}", name, *value));
  plan.request.parameters[name] = *value;
}

void choose_filter(Plan& plan, const std::string& name) {
  plan.filter = &find_filter(name, *plan.method);
  if (name != kPublishedFilter) return;
  const PublishedFilter& of_source = plan.method->published_filter;
  const bool half =
      of_source.at_half_resolution && of_source.at_half_resolution(plan.request.parameters);
  plan.reasons.push_back(fmt::format("filter {}: that of the method's source{}", plan.filter->name,
                                     half ? ", on the map at half resolution" : ""));
  if (!half) return;
  plan.half_filter = std::exchange(plan.filter, &find_filter("none"));
  plan.request.filter_half = [filter = plan.half_filter, of_half = plan.method->pattern_size / 2](
                                 Plane<float> ao, const Surfaces& guide) {
    return apply_filter(*filter, std::move(ao), find_product("ao").filtering, guide, of_half);
  };
}

void explain_reflection(Plan& plan, const Scene& scene) {
  const ProductSet& products = plan.request.products;
  const ParameterValues& parameters = plan.request.parameters;
  if ((products.reflection || products.specular) && scene.roughness.empty()) {
    plan.reasons.push_back(fmt::format("{}: roughness {:g} everywhere, there is no layer of it",
                                       products.reflection ? "reflection" : "specular",
                                       parameters.at("roughness")));
  }
  if (products.specular && scene.specular_color.empty()) {
    plan.reasons.push_back(
        fmt::format("specular: index of refraction {:g} everywhere, no layer is specular-color",
                    parameters.at("ior")));
  }
}

/// Refuses multi-bounce without an albedo: its bounces are part of direct, not a product of their
/// own that could be left out.
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
  for (const glm::vec3 c : scene.senders.albedo.pixels) {
    brightest = std::max({brightest, c.x, c.y, c.z});
    if (brightest >= kDarkAlbedo) return;
  }
  plan.request.bounces = 0;
  plan.reasons.push_back(fmt::format("no bounce: the albedo is {:.2g} at most", double(brightest)));
}

/// A sun or a larger source, and how large it is.
std::string shape_of(const DistantSource& sun) {
  const float longer = glm::degrees(sun.extent.x), shorter = glm::degrees(sun.extent.y);
  // The rectangle with the moments of a disc has sides of sqrt(3) radii.
  const float radius = longer / std::sqrt(3.0f);
  const bool is_round =
      longer < 1.2f * shorter && glm::degrees(sun.angular_radius) < 1.12f * radius;
  const float wide = is_round ? 2 * radius : longer;
  const std::string_view what = wide < kWidestSun ? "a sun" : "a source";
  if (is_round || wide < kWidestSun) return fmt::format("{} {:.2g} degrees wide", what, wide);
  return fmt::format("{} {:.2g} x {:.2g} degrees", what, longer, shorter);
}

void explain_light(Plan& plan, const Light& light) {
  if (!plan.request.products.direct) return;
  if (light.is_constant()) {
    plan.reasons.push_back("direct is ao times the environment's one colour: no directions");
    return;
  }
  for (const auto& source : light.sources) {
    const DistantSource* const sun = source->distant();
    if (!sun) continue;
    plan.reasons.push_back(fmt::format(
        "{} gives {:.0f} % of the light that a surface facing it gets ({:.3g} of "
        "irradiance over pi), treated separately: spherical harmonics would hold {:.0f} "
        "% of it",
        shape_of(*sun), 100 * sun->share, luminance(sun->irradiance), 100 * sun->sh_fraction));
  }
  if (has_lamps(light))
    plan.reasons.emplace_back(
        "lamps: the light of each at each surface, times how much of it rays find open");
  if (light.environment.is_constant()) return;
  std::string energy;
  for (const double share : light.band_energy) energy += fmt::format(" {:.1f}", 100 * share);
  plan.reasons.push_back(
      fmt::format("light in spherical harmonics to order {}: bands hold{} % of its energy, and "
                  "the bands left out {:.1f} % of the light in a lobe",
                  light.order, energy, 100 * light.residual()));
}

void choose_radius(Plan& plan, const ModelOptions& model, const Geometry& geometry) {
  const SupportedOptions& supports = plan.method->supports;
  if (!supports.radius) return;
  if (model.radius) {
    plan.request.radius = float(*model.radius);
    if (std::isinf(plan.request.radius) && !supports.infinite_radius) {
      throw Error(ExitCode::usage,
                  fmt::format("--radius inf: method {} needs a limit", plan.method->name));
    }
    plan.reasons.push_back(fmt::format("radius {:.4g}: as given", plan.request.radius));
  } else if (supports.infinite_radius) {
    plan.request.radius = INFINITY;
    plan.reasons.push_back("radius inf: occluders at any distance count");
  } else {
    plan.radius_alone = radius_by_frame(geometry);
    plan.request.radius = model.radius_of_shot.value_or(*plan.radius_alone);
    plan.reasons.push_back(
        model.radius_of_shot
            ? fmt::format("radius {:.4g}: the median of frames of the sequence, by {:g} of the "
                          "height of each at its median depth; {:.4g} by this frame alone",
                          plan.request.radius, kAutoRadius, *plan.radius_alone)
            : fmt::format("radius {:.4g}: {:g} of the frame's height at the median depth {:.4g}",
                          plan.request.radius, kAutoRadius, geometry.median_depth));
  }
}

/// Adds to the reasons how many surfaces have measured solids behind them.
void explain_measured(Plan& plan, const Scene& scene) {
  const Solids& solids = scene.solids;
  const auto is_measured = [](const SolidLayer& layer) {
    const auto& known = layer.provenance.pixels;
    return std::find(known.begin(), known.end(), Provenance::measured) != known.end();
  };
  if (std::none_of(solids.behind.begin(), solids.behind.end(), is_measured)) return;
  std::size_t surfaces = 0, pixels = 0;
  int most = 0;
  for (std::size_t i = 0; i < scene.geometry.surfaces.size(); ++i) {
    int measured = 0;
    for (int k = 1; k < solids.layers(); ++k)
      measured += solids.at(k, i).exists() && solids.provenance(k, i) == Provenance::measured;
    surfaces += scene.geometry.is_surface(i);
    pixels += measured > 0;
    most = std::max(most, measured);
  }
  if (pixels == 0) return;
  plan.reasons.push_back(fmt::format(
      "measured solids behind {} of {} surfaces, up to {} in a pixel", pixels, surfaces, most));
}

void explain_thickness(Plan& plan, const ModelOptions& model) {
  if (!plan.method->supports.thickness) return;
  plan.reasons.push_back(
      model.thickness
          ? fmt::format("thickness {:.4g}: as given", *model.thickness)
          : fmt::format("thickness: solids are {:g} times as thick as they appear wide, or less "
                        "where the sides that they show say so, and surfaces continue behind them",
                        kDepthOfWidth));
}

void choose_march(Plan& plan, const ModelOptions& model) {
  if (!plan.method->supports.march) return;
  plan.request.slices = model.slices.value_or(slices_of(model.quality));
  plan.request.steps =
      model.steps.value_or(steps_of(model.quality, std::isfinite(plan.request.radius)));
  plan.request.extend_offscreen = model.extend_offscreen;
  if ((plan.request.products.error || plan.error) && plan.request.slices < 2) {
    plan.request.slices = 2;
    plan.reasons.push_back("2 slices: the noise is the difference of two halves");
  }
  if (plan.request.products.error)
    plan.reasons.push_back(
        "error: a second run with half of the steps measures the bias of few steps");
  if (!plan.request.extend_offscreen)
    plan.reasons.push_back("surfaces end at the border of the frame: as asked");
}

/// With --crop, limits the receivers to the pixels that outputs hold or filters read. Not where the
/// error of all pixels counts, or where other frames use what the rest has found.
void choose_receivers(Plan& plan, const OutputOptions& output, const Geometry& geometry,
                      const GBuffer& gbuffer, const std::string& file, int reach_of_prior) {
  // The windows of an overview are not those of the outputs.
  if (!output.crop || gbuffer.grid.is_coarse()) return;
  const Window &data = geometry.window, shown = intersection(data, geometry.display);
  if (shown.area() == 0) {
    throw Error(ExitCode::usage,
                fmt::format("{}: --crop would leave nothing: the data window lies outside of the "
                            "display window; leave out --crop",
                            file));
  }
  if (shown == data) return;
  plan.reasons.push_back(
      fmt::format("writes {}x{} pixels of {}x{}: what lies beyond the display window blocks and "
                  "sends light, but is not written",
                  shown.width(), shown.height(), data.width(), data.height()));
  if (!plan.method->supports.receivers || plan.temporal || plan.shot || plan.request.products.error)
    return;
  const int reach = plan.filter->reach + gbuffer.downsampling.reach() + reach_of_prior;
  plan.request.receivers =
      intersection(data, {shown.x0 - reach, shown.y0 - reach, shown.x1 + reach, shown.y1 + reach});
}

void explain_downsampling(Plan& plan, const GBuffer& gbuffer) {
  const Downsampling& downsampling = gbuffer.downsampling;
  plan.downsample = downsampling.factor;
  if (downsampling.is_identity()) return;
  const Window large = gbuffer.display, small = downsampling.small(large);
  plan.reasons.push_back(fmt::format(
      "downsample {}: the frame's {}x{} pixels become {}x{}, by a Blackman-Harris filter that "
      "reaches {:g} of them to each side",
      downsampling.factor, large.width(), large.height(), small.width(), small.height(),
      Downsampling::kFilterWidth / 2.0));
}

}  // namespace

Prior prior_of(const ModelOptions& model) {
  if (model.prior) return *model.prior;
  const bool is_told = !model.extend_offscreen || model.thickness;
  return find_method(model.method).supports.prior && !is_told ? Prior::learned : Prior::rules;
}

bool finds_radius(const ModelOptions& model) {
  const SupportedOptions& supports = find_method(model.method).supports;
  return supports.radius && !supports.infinite_radius && !model.radius;
}

float radius_by_frame(const Geometry& geometry) {
  return kAutoRadius * geometry.frame_height_at(geometry.median_depth);
}

Plan make_plan(const ModelOptions& model, const OutputOptions& output, const Scene& scene,
               const GBuffer& gbuffer, const std::string& file) {
  Plan plan;
  plan.method = &find_method(model.method);
  refuse_options(*plan.method, model);
  plan.request.parameters = resolve_parameters(*plan.method, model.set);
  set_by_option(plan, "slices", model.slices, model);
  set_by_option(plan, "steps", model.steps, model);
  choose_filter(plan, model.filter);
  plan.temporal = model.temporal;
  plan.shot = model.shot.count > 0;
  plan.request.seed = model.seed;
  plan.error = model.error;
  plan.composition = choose_composition(output, scene, gbuffer, plan.request.parameters);
  choose_products(plan, output, scene, gbuffer, file);
  refuse_lamps(plan, scene);
  explain_composite(plan, output, scene, gbuffer);
  explain_reflection(plan, scene);
  check_multi_bounce(plan, scene, file);
  choose_bounces(plan, model.bounces, scene);
  explain_albedo(plan, gbuffer);
  explain_light(plan, scene.light);
  choose_radius(plan, model, scene.geometry);
  explain_thickness(plan, model);
  explain_measured(plan, scene);
  choose_march(plan, model);
  choose_receivers(plan, output, scene.geometry, gbuffer, file,
                   prior_of(model) == Prior::learned ? kPriorReach : 0);
  explain_downsampling(plan, gbuffer);
  return plan;
}

}  // namespace ssdo
