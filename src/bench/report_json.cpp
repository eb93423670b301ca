// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/report.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// JSON knows no NaN: null is what was not measured.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json to_json(const Errors& errors) {
  json j = json::object();
  for (const auto& [product, split] : errors) {
    j[product] = {{"noise", number(split.noise)},
                  {"approximation", number(split.approximation)},
                  {"model", number(split.model)}};
  }
  return j;
}

json to_json(const Cost& cost) { return {{"cpu_ms", cost.cpu_ms}, {"wall_ms", cost.wall_ms}}; }

json row_json(const BenchReport& report, const BenchRow& row) {
  return {{"method", row.setting.method->name},
          {"setting", row.setting.rung.label},
          {"standard", row.setting.standard},
          {"samples_per_pixel", row.samples_per_pixel},
          {"runs", row.runs},
          {"estimate", to_json(row.estimate)},
          {"filter", to_json(row.filter)},
          {"cpu_ms_per_megapixel", report.cpu_ms_per_megapixel(row)},
          {"wall_ms_per_megapixel", report.wall_ms_per_megapixel(row)},
          {"errors", to_json(row.errors)},
          {"command", row.command}};
}

json limit_json(const BenchLimit& limit) {
  return {{"method", limit.setting.method->name},
          {"setting", limit.setting.rung.label},
          {"seeds", limit.seeds},
          {"errors", to_json(limit.errors)}};
}

json recommendation_json(const BenchReport& report) {
  if (report.wanted.empty()) return nullptr;
  const auto row = report.recommended ? report.recommended : report.best;
  return {{"wanted", report.wanted},
          {"reached", report.recommended.has_value()},
          {"row", row ? json(*row) : json(nullptr)},
          {"command", row ? json(report.rows[*row].command) : json(nullptr)}};
}

}  // namespace

json to_json(const BenchReport& report) {
  json fronts = json::object(), metrics = json::object();
  for (const std::string& product : report.products) {
    fronts[product] = report.front(product);
    metrics[product] = has_absolute_error(product) ? "rmse" : "relative_rmse";
  }
  json rows = json::array(), limits = json::array();
  for (const BenchRow& row : report.rows) rows.push_back(row_json(report, row));
  for (const BenchLimit& limit : report.limits) limits.push_back(limit_json(limit));
  return {{"version", SSDO_VERSION},
          {"input", report.input},
          {"frame", json::parse(report.frame)},
          {"pixels", report.pixels},
          {"surface_pixels", report.surface_pixels},
          {"machine",
           {{"processor", report.processor},
            {"processors", report.processors},
            {"threads", report.threads},
            {"isa", report.isa}}},
          {"filter", report.filter},
          {"seconds", report.seconds},
          {"stages_ms",
           {{"read", report.stages.read},
            {"known", report.stages.known},
            {"prepare", report.stages.prepare},
            {"write", report.stages.write}}},
          {"products", report.products},
          {"metrics", metrics},
          {"truths", report.truths},
          {"rows", rows},
          {"limits", limits},
          {"fronts", fronts},
          {"recommendation", recommendation_json(report)}};
}

}  // namespace ssdo
