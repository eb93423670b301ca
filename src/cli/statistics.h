// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "cli/jobs.h"
#include "cli/resources.h"
#include "frame.h"
#include "pipeline.h"

namespace ssdo {

/// What --stats says about one frame that was done; see man ssdo, STATISTICS.
nlohmann::json statistics_of(const Frame& frame, const Job& job, const Resources& resources,
                             const Relit& relit);

/// The policy for the file of --stats: a log is replaced where an image would not be.
OutputPolicy policy_of_statistics(OutputPolicy of_images);

/// Writes an array with what statistics_of() says of each frame. Errors: ExitCode::output.
void write_statistics(const std::string& path, const OutputPolicy& policy,
                      const nlohmann::json& frames);

}  // namespace ssdo
