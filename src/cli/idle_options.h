// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "cli/options.h"

namespace ssdo {

/// One line for each option of `given` that changes nothing beside the others, whatever the frame
/// holds. It is a warning, not an error: one script serves frames and outputs of many kinds.
/// `given` are the names of what stands on the command line; a config file speaks for many jobs.
std::vector<std::string> idle_options(const std::set<std::string>& given, const Options& options);

}  // namespace ssdo
