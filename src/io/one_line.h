// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace ssdo {

/// A library's message fit for an ssdo::Error: line breaks become spaces, and the full stop and
/// line break that often end it are gone.
std::string one_line(std::string message);

/// Text that may hold a name from a file or a path, fit for one line of a terminal or a log: every
/// byte of a control character, of a character that ends a line or reorders text, and of what is
/// not UTF-8 becomes \xHH. All text from files that ssdo prints goes through this.
std::string printable(std::string_view text);

}  // namespace ssdo
