// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ssdo::fuzz {

/// The frames of data/ and Blender's exports, cut to a few pixels in the middle, with all that
/// their headers say.
std::vector<std::string> real_frames();

/// The files of data/ or a folder below it with this ending, as they are.
std::vector<std::string> real_files(const std::string& folder, const std::string& ending);

/// Samples beside real files.
std::vector<std::string> joined(std::vector<std::string> some,
                                const std::vector<std::string>& more);

}  // namespace ssdo::fuzz
