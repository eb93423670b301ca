// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace ssdo {

/// As many symbolic links as Linux itself follows before it reports a loop.
inline constexpr int kMostLinks = 40;

/// The file that a path stands for once symbolic links are followed, also when that file does not
/// exist yet: an output given as a link is written through it, and the link stays.
/// Unlike std::filesystem::canonical, the folder is left as the user wrote it.
std::filesystem::path follow_links(std::filesystem::path path);

/// A name for a temporary beside `target`: hidden, unlike any other, with the target's extension
/// (libraries choose the format by it), and short enough for the file system.
std::filesystem::path temporary_beside(const std::filesystem::path& target);

/// The part that names of temporaries share if, and only if, their process ids can be compared:
/// ".ssdo-" and 16 digits of the id that Linux draws at each start and of the processes' namespace.
/// Empty where the system does not tell them.
std::string mark_of_machine();

}  // namespace ssdo
