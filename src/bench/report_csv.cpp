// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/report.h"

namespace ssdo {
namespace {

/// RFC 4180: in quotes where a reader would split, with inner quotes twice.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// Empty where nothing was measured.
std::string field(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

std::string to_csv(const BenchReport& report) {
  std::string text =
      "method,setting,samples_per_pixel,filter,runs,estimate_cpu_ms,estimate_wall_ms,"
      "filter_cpu_ms,filter_wall_ms,cpu_ms_per_megapixel,wall_ms_per_megapixel,product,noise,"
      "approximation,model,pareto,command\n";
  for (const std::string& product : report.products) {
    const auto front = report.front(product);
    for (std::size_t i = 0; i < report.rows.size(); ++i) {
      const BenchRow& row = report.rows[i];
      const auto errors = row.errors.find(product);
      if (errors == row.errors.end()) continue;
      const bool on_front = std::find(front.begin(), front.end(), i) != front.end();
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                          row.setting.method->name, field(row.setting.rung.label),
                          row.samples_per_pixel, report.filter, row.runs, row.estimate.cpu_ms,
                          row.estimate.wall_ms, row.filter.cpu_ms, row.filter.wall_ms,
                          report.cpu_ms_per_megapixel(row), report.wall_ms_per_megapixel(row),
                          product, field(errors->second.noise), field(errors->second.approximation),
                          field(errors->second.model), on_front ? 1 : 0, field(row.command));
    }
  }
  return text;
}

}  // namespace ssdo
