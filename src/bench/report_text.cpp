// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/report.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

std::string number_or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.4f}", value) : "-";
}

/// The columns of a row or a limit; a star marks what is on the front of a product.
std::string error_columns(const BenchReport& report, const Errors& errors,
                          const std::vector<std::string>& starred) {
  std::string text;
  for (const std::string& product : report.products) {
    const auto found = errors.find(product);
    const ErrorSplit split = found == errors.end() ? ErrorSplit() : found->second;
    const bool truth = report.truths.contains(product);
    const bool star = std::find(starred.begin(), starred.end(), product) != starred.end();
    text += fmt::format("  {:>7} {:>7}", number_or_dash(split.noise),
                        number_or_dash(split.approximation));
    if (truth) text += fmt::format(" {:>7}", number_or_dash(split.model));
    text += star ? '*' : ' ';
  }
  return text;
}

std::string heading(const BenchReport& report) {
  std::string top = fmt::format("{:<31} {:>9} {:>9}", "", "CPU ms", "wall ms");
  std::string bottom = fmt::format("{:<31} {:>9} {:>9}", "method and setting", "/ MP", "/ MP");
  for (const std::string& product : report.products) {
    const bool truth = report.truths.contains(product);
    const std::string figure =
        product + (has_absolute_error(product) ? ", RMSE" : ", relative RMSE");
    top += fmt::format("  {:<{}}", figure, truth ? 24 : 16);
    bottom += fmt::format("  {:>7} {:>7}", "noise", "trace");
    if (truth) bottom += fmt::format(" {:>7}", "truth");
    bottom += ' ';
  }
  return top + "\n" + bottom + "\n";
}

std::string recommendation(const BenchReport& report) {
  if (report.wanted.empty()) return "";
  if (report.recommended) {
    const BenchRow& row = report.rows[*report.recommended];
    return fmt::format("\nThe cheapest with an error of {} at most: {}, {:.0f} ms CPU / MP\n  {}\n",
                       report.wanted, row.setting.name(), report.cpu_ms_per_megapixel(row),
                       row.command);
  }
  if (!report.best)
    return fmt::format("\nNo setting makes all that is wanted: {}\n", report.wanted);
  const BenchRow& row = report.rows[*report.best];
  std::string reached;
  for (const auto& [product, split] : row.errors)
    reached += fmt::format("{}{} {:.4g}", reached.empty() ? "" : ", ", product, split.total());
  return fmt::format("\nNo setting has an error of {}. The best is {}: {}\n  {}\n", report.wanted,
                     row.setting.name(), reached, row.command);
}

}  // namespace

std::string to_table(const BenchReport& report) {
  std::string text = fmt::format(
      "{}: {} x {}, {} of {} pixels show surfaces; {} thread(s), {} ({}); filter {}; {:.0f} s\n",
      printable(report.input), report.width, report.height, report.surface_pixels, report.pixels,
      report.threads, report.processor, report.isa, report.filter, report.seconds);
  for (const auto& [product, layer] : report.truths)
    text += fmt::format("truth of {}: {}\n", product, printable(layer));
  text += heading(report);
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const BenchRow& row = report.rows[i];
    std::vector<std::string> starred;
    for (const std::string& product : report.products) {
      const auto front = report.front(product);
      if (std::find(front.begin(), front.end(), i) != front.end()) starred.push_back(product);
    }
    text += fmt::format("{:<31} {:>9.1f} {:>9.1f}{}\n", row.setting.name(),
                        report.cpu_ms_per_megapixel(row), report.wall_ms_per_megapixel(row),
                        error_columns(report, row.errors, starred));
    const bool last =
        i + 1 == report.rows.size() || report.rows[i + 1].setting.method != row.setting.method;
    if (!last) continue;
    for (const BenchLimit& limit : report.limits) {
      if (limit.setting.method != row.setting.method) continue;
      text += fmt::format("{:<51}{}\n", fmt::format("{} limit", row.setting.method->name),
                          error_columns(report, limit.errors, {}));
    }
  }
  text += fmt::format(
      "noise: from the method's own limit; trace: from rays against the same geometry{}; * on the "
      "front of\ncost and error: nothing is both cheaper and better. Beside a limit, noise is what "
      "is left of its own.\n",
      report.truths.empty() ? "" : "; truth: from --truth");
  return text + recommendation(report);
}

}  // namespace ssdo
