// SPDX-License-Identifier: Apache-2.0
#include "metrics/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ssdo {

std::vector<std::size_t> pareto_front(const std::vector<CostAndError>& all) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (std::isfinite(all[i].error)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t k) {
    return all[i].cost != all[k].cost ? all[i].cost < all[k].cost : all[i].error < all[k].error;
  });
  std::vector<std::size_t> front;
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    if (all[i].error >= least) continue;
    least = all[i].error;
    front.push_back(i);
  }
  return front;
}

std::optional<std::size_t> cheapest_within(const std::vector<CostAndError>& all, double wanted) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].error <= wanted && (!best || all[i].cost < all[*best].cost)) best = i;
  }
  return best;
}

std::optional<std::size_t> least_error(const std::vector<CostAndError>& all) {
  const auto front = pareto_front(all);
  return front.empty() ? std::nullopt : std::optional(front.back());
}

}  // namespace ssdo
