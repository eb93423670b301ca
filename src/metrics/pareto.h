// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace ssdo {

/// What something costs and how wrong it is. Without a finite error it is never chosen.
struct CostAndError {
  double cost = 0, error = 0;
};

/// The Pareto front, cheapest first: those of which no other is both as cheap and as good. Of equal
/// ones, the first.
std::vector<std::size_t> pareto_front(const std::vector<CostAndError>& all);

/// The cheapest whose error is `wanted` at most; nothing where there is none.
std::optional<std::size_t> cheapest_within(const std::vector<CostAndError>& all, double wanted);

/// The one with the least error, of equal ones the cheapest; nothing where none has an error.
std::optional<std::size_t> least_error(const std::vector<CostAndError>& all);

}  // namespace ssdo
