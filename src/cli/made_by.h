// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace ssdo {

/// Who runs which command where, in one line: "user@host: ssdo shot.exr -o 'relit 2.exr'". Words
/// are quoted for a shell. A user or host without a name is "unknown".
std::string made_by(std::span<const char* const> command_line);

}  // namespace ssdo
