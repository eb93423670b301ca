// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace ssdo {

/// Removes what runs that were killed (SIGKILL, out of memory) have left in `folder`: temporaries
/// of outputs whose process ran on this machine, since its start and in the same container, and is
/// gone. Locks would tell of other machines too, but not on every network file system. Returns the
/// files that were removed; none of a folder that does not exist or cannot be read.
std::vector<std::filesystem::path> remove_stale_temporaries(const std::filesystem::path& folder);

}  // namespace ssdo
