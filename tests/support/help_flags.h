// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

namespace ssdo::test {

/// The long flags that the help declares which the tool prints for these arguments: those that
/// begin a line, not those that a text mentions.
std::set<std::string> flags_of_help(const std::vector<std::string>& arguments);

}  // namespace ssdo::test
