// SPDX-License-Identifier: Apache-2.0
#include "plan/composite_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "error.h"

namespace ssdo {
namespace {

/// Whether the direct light of the method has bounces in it, so that it is more than ao times the
/// light of a constant environment.
bool has_multi_bounce(const ParameterValues& parameters) {
  const auto found = parameters.find("multi-bounce");
  return found != parameters.end() && found->second != 0;
}

std::string describe_occlude(const Plan& plan, const GBuffer& gbuffer) {
  return fmt::format(
      "{} times {}{}",
      gbuffer.beauty.empty() ? "the ambient layer, as there is no beauty,"
                             : "the beauty with its ambient layer",
      plan.composition.share_is_ao ? "ao" : "direct / unoccluded direct, channel by channel",
      gbuffer.specular.empty() ? "" : ", and its specular layer times reflection");
}

}  // namespace

Compose choose_compose(const OutputOptions& output, bool has_ambient) {
  return output.compose.value_or(has_ambient ? Compose::occlude : Compose::relight);
}

Compose choose_compose(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  const bool has_ambient = std::any_of(
      aovs.begin(), aovs.end(), [](const LayerRequest& aov) { return aov.role == Role::ambient; });
  return choose_compose(output, has_ambient);
}

Composition choose_composition(const OutputOptions& output, const Scene& scene,
                               const GBuffer& gbuffer, const ParameterValues& parameters) {
  return {choose_compose(output, !gbuffer.ambient.empty()),
          scene.light.is_constant() && !has_multi_bounce(parameters)};
}

Product composite_row(const Composition& composition, const GBuffer& gbuffer) {
  Product row = find_product("composite");
  if (composition.compose != Compose::occlude) return row;
  row.made_of = {.ao = composition.share_is_ao,
                 .direct = !composition.share_is_ao,
                 .reflection = !gbuffer.specular.empty()};
  row.with = {};
  row.needs = "ambient";
  return row;
}

void check_rendered_layers(Compose compose, const GBuffer& gbuffer, const std::string& file) {
  if (compose == Compose::occlude && gbuffer.ambient.empty()) {
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

void explain_composite(Plan& plan, const OutputOptions& output, const GBuffer& gbuffer) {
  if (!contains(plan.make, "composite")) return;
  const Compose compose = plan.composition.compose;
  const ComposeRow& row = kComposites[std::size_t(compose)];
  plan.reasons.push_back(
      fmt::format("composite {}: {}; {}", row.name,
                  compose == Compose::occlude ? describe_occlude(plan, gbuffer) : row.meaning,
                  output.compose            ? "as asked"
                  : gbuffer.ambient.empty() ? "no ambient layer is given"
                                            : "an ambient layer is given"));
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
