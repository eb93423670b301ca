// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/job.h"

namespace ssdo {

/// The plan for the light that a shadow is made of.
Plan plan_of_shadow(Plan plan);

/// Gives the scene without the objects of --shadow-of what it shares with that of the frame: light
/// and colours.
void light_alike(Scene& without, const Scene& scene);

/// Fills Products::lit and lit_without of what relight() has made. `without` is the scene without
/// the objects of --shadow-of; its light and colours are taken from `relit`, and what it takes adds
/// to the times of that.
void find_shadow(Scene& without, Relit& relit);

}  // namespace ssdo
