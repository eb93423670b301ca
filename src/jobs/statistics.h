// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "jobs/jobs.h"
#include "jobs/machine/resources.h"
#include "relight/frame.h"
#include "relight/job.h"

namespace ssdo {

/// The entry of the --stats file for one finished frame; see man ssdo, STATISTICS.
nlohmann::json statistics_of(const Frame& frame, const Job& job, const Resources& resources,
                             const Relit& relit);

/// The policy for the file of --stats: as a log it replaces an existing file, which an image does
/// not.
OutputPolicy policy_of_statistics(OutputPolicy of_images);

/// Writes the array of the entries of all frames. Errors: ExitCode::output.
void write_statistics(const std::string& path, const OutputPolicy& policy,
                      const nlohmann::json& frames);

}  // namespace ssdo
