// SPDX-License-Identifier: Apache-2.0
#include "metrics/compare_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/one_line.h"
#include "nearest_name.h"

namespace ssdo {

nlohmann::json json_number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json layer_json(const Compared& c) {
  const Difference& d = c.difference.figures;
  const LeftOut& left_out = c.difference.left_out;
  return {{"a", shown_name(c.pair.a)},
          {"b", shown_name(c.pair.b)},
          {"pixels", c.difference.pixels},
          {"left_out", left_out.all()},
          {"not_finite_in_both", left_out.in_both},
          {"not_finite_in_one", left_out.in_one},
          {"outside_one", left_out.outside},
          {"channels", c.difference.a_minus_b.size()},
          {"rmse", json_number(d.rmse)},
          {"relative_rmse", json_number(d.relative_rmse())},
          {"bias", json_number(d.bias)},
          {"max", json_number(d.largest)},
          {"p99", json_number(d.p99)},
          {"psnr", json_number(d.psnr())}};
}

nlohmann::json to_json(const CompareOptions& options, const Comparison& all) {
  nlohmann::json layers = nlohmann::json::array();
  for (const Compared& c : all.layers) layers.push_back(layer_json(c));
  return {{"a", options.a},
          {"b", options.b},
          {"layers", layers},
          {"only_in_a", all.only_in_a},
          {"only_in_b", all.only_in_b},
          {"lacks_layers", all.lacks_layers}};
}

std::string list_channels(std::string_view where, const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  if (names.empty()) return "";
  return printable(fmt::format("only in {}: {}", where, some_of(names, kMost))) + "\n";
}

std::string note_of_left_out(const Compared& c) {
  const LeftOut& left_out = c.difference.left_out;
  if (left_out.without_counterpart() == 0) return "";
  return fmt::format(
      "{}: {} pixels have no counterpart ({} are not finite in one picture, {} outside the window "
      "of one)\n",
      printable(c.pair.name()), left_out.without_counterpart(), left_out.in_one, left_out.outside);
}

std::string to_table(const Comparison& all) {
  std::string text =
      fmt::format("{:<32} {:>9} {:>9} {:>11} {:>10} {:>11} {:>11} {:>11} {:>8}\n", "layer",
                  "pixels", "left out", "RMSE", "relative", "bias", "max", "99 %", "PSNR");
  std::string notes;
  for (const Compared& c : all.layers) {
    const Difference& d = c.difference.figures;
    text += fmt::format(
        "{:<32} {:>9} {:>9} {:>11.6g} {:>10.4g} {:>+11.4g} {:>11.6g} {:>11.6g} {:>8.2f}\n",
        printable(c.pair.name()), c.difference.pixels, c.difference.left_out.all(), d.rmse,
        d.relative_rmse(), d.bias, d.largest, d.p99, d.psnr());
    notes += note_of_left_out(c);
  }
  if (all.lacks_layers)
    notes += "fails: a layer is in one file only; name the layers to compare, FILE:LAYER\n";
  return text + notes + list_channels("A", all.only_in_a) + list_channels("B", all.only_in_b);
}

}  // namespace ssdo
