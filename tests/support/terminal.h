// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "support/run_tool.h"

namespace ssdo::test {

/// Runs the real binary on a terminal of its own, as a person does. What it prints, on either
/// stream, comes back in `out`.
Finished run_on_terminal(const std::vector<std::string>& arguments);

}  // namespace ssdo::test
