// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "plan/outputs.h"
#include "plan/plan.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// Decides which products are made, and in which files they go: fills make, write, show,
/// request.products and reasons of a plan whose method, error and composition are known. `file` is
/// the input's name, for messages. Errors: those of make_plan.
void choose_products(Plan& plan, const OutputOptions& output, const Scene& scene,
                     const GBuffer& gbuffer, const std::string& file);

}  // namespace ssdo
