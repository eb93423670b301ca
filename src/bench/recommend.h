// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/options.h"
#include "bench/report.h"

namespace ssdo {

/// Finds the cheapest row that has all errors that are wanted, or else the one that comes nearest:
/// whose largest error, in parts of what is wanted of its product, is least.
void recommend(BenchReport& report, const std::vector<WantedError>& wants);

}  // namespace ssdo
