// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "bench/ladder.h"
#include "bench/options.h"
#include "plan/plan.h"

namespace ssdo {

/// A word quoted for a shell: in quotes where it holds more than letters, digits and _./:=,+@%-,
/// and as $'...' of bash where it holds control characters.
std::string shell_word(const std::string& word);

/// The command line of the main job for a measured setting: its arguments, the options that were
/// given to the bench and apply, the products, and an output in the current folder.
std::string command_of(const BenchJob& job, const Setting& setting, const Plan& plan);

}  // namespace ssdo
