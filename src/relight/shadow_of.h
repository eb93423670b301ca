// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/job.h"

namespace ssdo {

/// Fills Products::lit and lit_without of what relight() has made. `without` is the scene without
/// the objects of --shadow-of; its light and colours are taken from `relit`, and what it takes adds
/// to the times of that.
void find_shadow(Scene& without, Relit& relit);

}  // namespace ssdo
