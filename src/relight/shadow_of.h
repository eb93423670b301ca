// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/job.h"

namespace ssdo {

/// The plan for the light that a shadow is made of.
Plan plan_of_shadow(Plan plan);

/// Gives `without`, the scene without the objects of --shadow-of, the light and the colours of
/// `scene`.
void light_alike(Scene& without, const Scene& scene);

/// Fills Products::lit and lit_without of what relight() has made. `without` is the scene without
/// the objects of --shadow-of; it gets the light and colours of `relit`, to whose times its own are
/// added.
void find_shadow(Scene& without, Relit& relit);

}  // namespace ssdo
