// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace ssdo {

/// Removes what runs that were killed (SIGKILL, out of memory) have left in `folder`: temporaries
/// of outputs that were made on this machine since it started, and that no process holds locked any
/// more. Those of other machines stay, since not every network file system passes locks on.
/// Returns the files that were removed; none of a folder that does not exist or cannot be read.
std::vector<std::filesystem::path> remove_stale_temporaries(const std::filesystem::path& folder);

}  // namespace ssdo
