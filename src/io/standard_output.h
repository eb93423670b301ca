// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace ssdo {

/// Writes to standard output, at once. A reader that has gone, as `head` goes after a few lines,
/// has read what it wanted: the rest is dropped in silence.
/// Errors: ExitCode::output where the text is lost for another reason.
void print_out(std::string_view text);

}  // namespace ssdo
