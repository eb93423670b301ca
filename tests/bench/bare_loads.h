// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/jobs.h"

namespace ssdo::bench {

/// What march_visibility loads for every sample, and nothing else: the machine's limit for it.
/// Gives the sum of all that was loaded.
float bare_loads(const March& march, int y0, int y1);

}  // namespace ssdo::bench
