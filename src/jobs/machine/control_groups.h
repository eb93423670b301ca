// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ssdo {

/// What the control groups of this process say in `file`, such as cpu.max: the first line of its
/// own group's, then of each group's above it, since a limit holds for all groups below. Groups
/// without the file are left out. With a `controller`, such as memory, the groups of version 1 that
/// it has; else those of version 2. `root` is where /proc and /sys are.
std::vector<std::string> lines_of_control_groups(const std::string& controller,
                                                 const std::string& file,
                                                 const std::filesystem::path& root = "/");

}  // namespace ssdo
