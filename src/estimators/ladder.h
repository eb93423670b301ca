// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ssdo {

/// One quality of a method: values of its parameters, or slices and steps where it marches.
struct Rung {
  std::vector<std::pair<std::string_view, int>> values;
  std::string label = "";  ///< if empty: the values with their units or names
};

/// The qualities that users of a method would choose among, which `ssdo bench` measures.
struct Ladder {
  std::vector<Rung> rungs;  ///< from cheap to dear; one of them is the method's default
  Rung limit;               ///< so many samples that its own noise does not count
  int seeds = 1;            ///< of the limit, whose mean is taken: even; 1 where none has noise
};

/// One rung for each value of a parameter.
std::vector<Rung> rungs_of(std::string_view parameter, std::initializer_list<int> values);

/// Labelled "2 x 16".
Rung slices_and_steps(int slices, int steps);

}  // namespace ssdo
