// SPDX-License-Identifier: Apache-2.0
#include "plan/composite_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "error.h"
#include "nearest_name.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Whether the direct light of the method has bounces in it, so that it is more than ao times the
/// light of a constant environment.
bool has_multi_bounce(const ParameterValues& parameters) {
  const auto found = parameters.find("multi-bounce");
  return found != parameters.end() && found->second != 0;
}

std::string names_of_lights(const GBuffer& gbuffer) {
  std::string names;
  for (const auto& [name, layer] : gbuffer.lights) names += (names.empty() ? "" : ", ") + name;
  return names;
}

std::string describe_occlude(const Plan& plan, const GBuffer& gbuffer, bool has_lamps) {
  std::vector<std::string> parts;
  if (!gbuffer.ambient.empty()) {
    parts.push_back(fmt::format("ambient layer times {}",
                                plan.composition.share_is_ao ? "ao"
                                : has_lamps ? "direct / unoccluded direct of the environment, "
                                              "channel by channel"
                                            : "direct / unoccluded direct, channel by channel"));
  }
  if (!gbuffer.lights.empty())
    parts.push_back(fmt::format("layers of {} times the shadow of each", names_of_lights(gbuffer)));
  if (!gbuffer.specular.empty()) parts.push_back("specular layer times reflection");
  if (gbuffer.beauty.empty()) {
    parts[0] = "the ambient layer, as there is no beauty," + parts[0].substr(13);
    return fmt::format("{}", fmt::join(parts, ", and its "));
  }
  return fmt::format("the beauty with its {}", fmt::join(parts, ", and its "));
}

}  // namespace

Compose choose_compose(const OutputOptions& output, bool has_part_to_occlude) {
  return output.compose.value_or(has_part_to_occlude ? Compose::occlude : Compose::relight);
}

Compose choose_compose(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  return choose_compose(output, std::ranges::any_of(aovs, [](const LayerRequest& aov) {
                          return aov.role == Role::ambient || aov.role == Role::light;
                        }));
}

Composition choose_composition(const OutputOptions& output, const Scene& scene,
                               const GBuffer& gbuffer, const ParameterValues& parameters) {
  // Lamps are no part of ambient light.
  const bool is_constant =
      scene.light.environment.is_constant() &&
      std::ranges::none_of(scene.light.sources, [](const auto& s) { return s->name.empty(); });
  const Compose compose =
      choose_compose(output, !gbuffer.ambient.empty() || !gbuffer.lights.empty());
  return {.compose = compose,
          .share_is_ao = is_constant && !has_multi_bounce(parameters),
          .adds_specular = compose != Compose::occlude && contains(output.products, "specular"),
          .keeps_beauty = !gbuffer.masks.kept.empty() && !gbuffer.beauty.empty()};
}

Product composite_row(const Composition& composition, const GBuffer& gbuffer) {
  Product row = find_product("composite");
  if (composition.compose != Compose::occlude) {
    row.made_of.specular = composition.adds_specular;
    return row;
  }
  const bool ambient = !gbuffer.ambient.empty(), lights = !gbuffer.lights.empty();
  row.made_of = {.ao = composition.share_is_ao && (ambient || !lights),
                 .direct = lights || !composition.share_is_ao,
                 .reflection = !gbuffer.specular.empty()};
  row.with = {};
  row.needs = lights ? "" : "ambient";
  return row;
}

void check_rendered_layers(Compose compose, const GBuffer& gbuffer, const std::string& file) {
  if (compose == Compose::occlude && !gbuffer.lights.empty() && gbuffer.beauty.empty()) {
    throw Error(ExitCode::layer,
                fmt::format("{}: --aov light:{} is a part of the beauty, and no layer for beauty "
                            "was found by name; name one with --aov beauty=LAYER",
                            file, gbuffer.lights.begin()->first));
  }
  if (compose == Compose::occlude && gbuffer.ambient.empty() && gbuffer.lights.empty()) {
    throw Error(
        ExitCode::layer,
        fmt::format("{}: --compose occlude needs the ambient layer of the render, which no name "
                    "tells; name it with --aov ambient=LAYER{}",
                    file,
                    gbuffer.beauty.empty()
                        ? ""
                        : ", or give --compose add for a beauty without ambient light"));
  }
  if (compose == Compose::add && gbuffer.beauty.empty()) {
    throw Error(ExitCode::layer,
                fmt::format("{}: --compose add needs a layer for beauty and none was found by "
                            "name; name one with --aov beauty=LAYER, or give --compose relight",
                            file));
  }
}

void check_lights(const Light& light, const GBuffer& gbuffer, const std::string& file) {
  std::vector<std::string> names;
  for (const auto& source : light.sources)
    if (!source->name.empty()) names.push_back(source->name);
  for (const auto& [name, layer] : gbuffer.lights) {
    if (contains(names, name)) continue;
    throw Error(ExitCode::usage,
                fmt::format("{}: --aov light:{}: there is no lamp '{}'; {}", file, name, name,
                            names.empty() ? "give it with --light or --lights"
                                          : fmt::format("{}there are {}", did_you_mean(name, names),
                                                        fmt::join(names, ", "))));
  }
}

bool needs_lights(const Composition& composition, const Scene& scene, const GBuffer& gbuffer) {
  if (composition.compose != Compose::occlude) return false;
  return !gbuffer.lights.empty() ||
         (!gbuffer.ambient.empty() && !composition.share_is_ao && has_lamps(scene.light));
}

void explain_composite(Plan& plan, const OutputOptions& output, const Scene& scene,
                       const GBuffer& gbuffer) {
  if (!contains(plan.make, "composite")) return;
  const Compose compose = plan.composition.compose;
  const ComposeRow& row = kComposites[std::size_t(compose)];
  std::string meaning(row.meaning);
  if (compose == Compose::occlude)
    meaning = describe_occlude(plan, gbuffer, has_lamps(scene.light));
  else if (plan.composition.adds_specular)
    meaning += " + specular, which --products names";
  plan.reasons.push_back(fmt::format("composite {}: {}; {}", row.name, meaning,
                                     output.compose             ? "as asked"
                                     : !gbuffer.ambient.empty() ? "an ambient layer is given"
                                     : !gbuffer.lights.empty()  ? "a layer of a light is given"
                                                                : "no ambient layer is given"));
  if (gbuffer.lead_window) {
    const Window& all = gbuffer.file_window;
    plan.reasons.push_back(
        fmt::format("the frame has {}x{} pixels, as its rendered layers have; those around the "
                    "data window of the positions are background",
                    all.width(), all.height()));
  }
}

void explain_albedo(Plan& plan, const GBuffer& gbuffer) {
  const bool is_lit =
      contains(plan.make, "composite") && plan.composition.compose != Compose::occlude;
  if (!gbuffer.albedo_alpha.empty() && (is_lit || plan.request.products.bounce))
    plan.reasons.push_back(gbuffer.albedo_alpha);
}

}  // namespace ssdo
