// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "bench/options.h"
#include "bench/report.h"
#include "bench/subject.h"

namespace ssdo {

/// Called with the share of the bench that is done, 0..1, and the setting that is measured now.
using BenchProgress = std::function<void(double done, const std::string& setting)>;

/// Measures the settings of the methods on one frame and recommends one where an error is wanted.
/// `subject` is that of the job. The caller fills in the report's description of the frame, its
/// threads and its instruction set. Errors: those of make_plan; ExitCode::usage for a method of the
/// job that does not exist or makes none of the products.
BenchReport bench(const BenchJob& job, const Subject& subject, const BenchProgress& progress);

}  // namespace ssdo
