// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "color/composition.h"
#include "estimators/products.h"
#include "plan/outputs.h"
#include "plan/plan.h"
#include "scene/gbuffer.h"
#include "scene/layers/layers.h"
#include "scene/scene.h"

namespace ssdo {

/// Which composite a frame gets: the one that is asked for, else occlude where an ambient layer or
/// that of a lamp is given, else relight.
Compose choose_compose(const OutputOptions& output, bool has_part_to_occlude);
Compose choose_compose(const OutputOptions& output, const std::vector<LayerRequest>& aovs);

/// How that composite is made in the light of `scene` by a method with these parameters.
Composition choose_composition(const OutputOptions& output, const Scene& scene,
                               const GBuffer& gbuffer, const ParameterValues& parameters);

/// The composite's row in the table of products, as it is in this frame.
Product composite_row(const Composition& composition, const GBuffer& gbuffer);

/// Throws ExitCode::layer where the rendered layers that the composite is made of are missing.
void check_rendered_layers(Compose compose, const GBuffer& gbuffer, const std::string& file);

/// Throws ExitCode::usage where --aov light:NAME names no lamp.
void check_lights(const Light& light, const GBuffer& gbuffer, const std::string& file);

/// Whether the composite needs the arriving share of each light, not just of all light.
bool needs_lights(const Composition& composition, const Scene& scene, const GBuffer& gbuffer);

/// Adds what the composite is, and why, to the reasons of a plan that makes it.
void explain_composite(Plan& plan, const OutputOptions& output, const Scene& scene,
                       const GBuffer& gbuffer);

/// Adds how alpha is in the albedo, where it matters, to the reasons of a plan that uses it.
void explain_albedo(Plan& plan, const GBuffer& gbuffer);

}  // namespace ssdo
