// SPDX-License-Identifier: Apache-2.0
#include "bench/recommend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "metrics/pareto.h"

namespace ssdo {

void recommend(BenchReport& report, const std::vector<WantedError>& wants) {
  if (wants.empty()) return;
  const auto product_of = [&](const WantedError& want) {
    return want.product.empty() ? report.products[0] : want.product;
  };
  std::vector<CostAndError> rows;
  for (const BenchRow& row : report.rows) {
    double worst = 0;
    for (const WantedError& want : wants) {
      const auto errors = row.errors.find(product_of(want));
      const double error = errors == row.errors.end() ? INFINITY : errors->second.total();
      worst = std::max(worst, error / want.error);
    }
    rows.push_back({report.cpu_ms_per_megapixel(row), worst});
  }
  for (const WantedError& want : wants) {
    report.wanted +=
        fmt::format("{}{} {:g}", report.wanted.empty() ? "" : ", ", product_of(want), want.error);
  }
  report.recommended = cheapest_within(rows, 1);
  if (!report.recommended) report.best = least_error(rows);
}

}  // namespace ssdo
