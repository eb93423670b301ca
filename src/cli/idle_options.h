// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "cli/options.h"

namespace ssdo {

/// A warning for each option of `given` that has no effect in combination with the others, whatever
/// the frame holds. It is no error, since one script may serve frames and outputs of many kinds.
/// `given` holds the names of options on the command line only: a config file is for many jobs.
std::vector<std::string> idle_options(const std::set<std::string>& given, const Options& options);

}  // namespace ssdo
