// SPDX-License-Identifier: Apache-2.0
#include "io/images/orientation.h"

#include <fstream>
#include <sstream>
#include <string>

namespace ssdo {

Orientation orientation_of_tiff(int number) {
  if (number < 1 || number > 8) return {};
  return {number >= 5, number == 3 || number == 4 || number == 6 || number == 7,
          number == 2 || number == 3 || number == 7 || number == 8};
}

std::optional<Orientation> orientation_of_radiance(const std::filesystem::path& file) {
  constexpr int kMostLines = 1000;  // of a header
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || !line.starts_with("#?")) return std::nullopt;
  for (int i = 0; i < kMostLines && std::getline(in, line); ++i) {
    if (!line.empty()) continue;
    std::string rows, columns;
    int ignored = 0;
    std::getline(in, line);
    std::istringstream(line) >> rows >> ignored >> columns;
    if (rows.size() != 2 || columns.size() != 2) return std::nullopt;
    // -Y begins at the top, +X at the left.
    const auto is_reversed = [](const std::string& axis) { return axis == "+Y" || axis == "-X"; };
    return Orientation{rows[1] == 'X', is_reversed(rows), is_reversed(columns)};
  }
  return std::nullopt;
}

}  // namespace ssdo
