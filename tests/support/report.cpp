// SPDX-License-Identifier: Apache-2.0
#include "support/report.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

namespace ssdo::test {

void write_report(const std::string& name, const std::string& text) {
  const std::filesystem::path folder = SSDO_REPORT_DIR;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << text;
  fmt::print("{}", text);
}

}  // namespace ssdo::test
