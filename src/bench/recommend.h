// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "bench/options.h"
#include "bench/report.h"

namespace ssdo {

/// Finds the cheapest row that meets all wanted errors, or else the row that comes nearest: the one
/// with the smallest maximum over the products of error divided by wanted error.
void recommend(BenchReport& report, const std::vector<WantedError>& wants);

}  // namespace ssdo
