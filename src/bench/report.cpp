// SPDX-License-Identifier: Apache-2.0
#include "bench/report.h"

#include "metrics/pareto.h"

namespace ssdo {

std::vector<std::size_t> BenchReport::front(const std::string& product) const {
  std::vector<CostAndError> all;
  for (const BenchRow& row : rows) {
    const auto errors = row.errors.find(product);
    all.push_back({cpu_ms_per_megapixel(row),
                   errors == row.errors.end() ? kNotMeasured : errors->second.total()});
  }
  return pareto_front(all);
}

}  // namespace ssdo
