// SPDX-License-Identifier: Apache-2.0
#include "estimators/ladder.h"

#include <fmt/format.h>

namespace ssdo {

std::vector<Rung> rungs_of(std::string_view parameter, std::initializer_list<int> values) {
  std::vector<Rung> rungs;
  for (const int value : values) rungs.push_back({{{parameter, value}}});
  return rungs;
}

Rung slices_and_steps(int slices, int steps) {
  return {{{"slices", slices}, {"steps", steps}}, fmt::format("{} x {}", slices, steps)};
}

}  // namespace ssdo
