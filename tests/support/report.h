// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace ssdo::test {

/// Leaves what a test measured in the build folder, where tests/run.sh prints it at the end.
inline void write_report(const std::string& name, const std::string& text) {
  const std::filesystem::path folder = SSDO_REPORT_DIR;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << text;
  fmt::print("{}", text);
}

}  // namespace ssdo::test
