// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ssdo::test {

/// Leaves what a test measured in the build folder, where tests/run.sh prints it at the end.
void write_report(const std::string& name, const std::string& text);

}  // namespace ssdo::test
