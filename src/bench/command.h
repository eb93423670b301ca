// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/ladder.h"
#include "bench/options.h"
#include "plan.h"

namespace ssdo {

/// A word as a shell reads it: in quotes where it holds more than letters, digits and _./:=,+@%-,
/// and in the $'...' of bash where a terminal should not get it raw.
std::string shell_word(const std::string& word);

/// The command line of the main job that does what was measured: the setting, the options of the
/// bench that reach it, the products, and an output in the current folder.
std::string command_of(const BenchJob& job, const Setting& setting, const Plan& plan);

}  // namespace ssdo
