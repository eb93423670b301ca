// SPDX-License-Identifier: Apache-2.0
#include "bench/shot/shot_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/one_line.h"

namespace ssdo {
namespace {

using nlohmann::json;

/// JSON knows no NaN: null is what was not measured.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

std::string shown(double value) {
  return std::isfinite(value) ? fmt::format("{:.4f}", value) : "-";
}
std::string field(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

/// In quotes, with inner quotes twice (RFC 4180).
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// The figures of a product as reports show them: those of light relative to its mean.
struct Told {
  double flicker, p99, border, error, error_near_moving, flicker_of_error;
};

Told told(const std::string& product, const ShotFigures& f) {
  const double scale = has_absolute_error(product) ? 1 : std::abs(f.flicker.mean);
  const bool has_truth = f.error.count > 0;
  return {f.flicker.rms / scale,
          f.flicker.p99 / scale,
          f.flicker.border_rms / scale,
          has_truth ? error_of(product, f.error) : NAN,
          f.error_near_moving.count > 0
              ? f.error_near_moving.rmse / (has_absolute_error(product) ? 1 : f.error.mean_b)
              : NAN,
          f.flicker_of_error.points > 0 ? f.flicker_of_error.rms / scale : NAN};
}

json product_json(const std::string& product, const ShotFigures& f) {
  const Told t = told(product, f);
  return {{"points", f.flicker.points},
          {"flicker", number(t.flicker)},
          {"flicker_p99", number(t.p99)},
          {"flicker_border", number(t.border)},
          {"mean", number(f.flicker.mean)},
          {"error", number(t.error)},
          {"error_near_moving", number(t.error_near_moving)},
          {"flicker_of_error", number(t.flicker_of_error)}};
}

}  // namespace

Cost ShotBenchReport::seconds_per_frame(const ShotRow& row) const {
  const double scale = 1e-3 / double(frames.size());
  return {row.cost.cpu_ms * scale, row.cost.wall_ms * scale};
}

std::string to_table(const ShotBenchReport& report) {
  std::string text = fmt::format(
      "{}: {} frames of {} x {}; {}, filter {}; {} thread(s), {} ({}); {:.0f} s\n",
      printable(report.input), report.frames.size(), report.width, report.height, report.method,
      report.filter, report.threads, report.processor, report.isa, report.seconds);
  for (const auto& [product, truth] : report.truths)
    text += fmt::format("truth of {}: {} in {} frame(s)\n", product, printable(truth.picture),
                        truth.frames.size());
  std::string top = fmt::format("{:<16} {:>9} {:>9}", "", "CPU s", "wall s"),
              bottom = fmt::format("{:<16} {:>9} {:>9}", "setting", "/ frame", "/ frame");
  for (const std::string& product : report.products) {
    const bool truth = report.truths.contains(product);
    top += fmt::format("  {:<{}}", product + (has_absolute_error(product) ? "" : ", relative"),
                       truth ? 39 : 23);
    bottom += fmt::format("  {:>7} {:>7} {:>7}", "flicker", "99 %", "border");
    if (truth) bottom += fmt::format(" {:>7} {:>7}", "error", "moving");
  }
  const auto add = [&](std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  };
  add(top), add(bottom);
  for (const ShotRow& row : report.rows) {
    const Cost seconds = report.seconds_per_frame(row);
    std::string line = fmt::format("{:<16} {:>9.3f} {:>9.3f}", row.setting.name(), seconds.cpu_ms,
                                   seconds.wall_ms);
    for (const std::string& product : report.products) {
      const Told t = told(product, row.products.at(product));
      line += fmt::format("  {:>7} {:>7} {:>7}", shown(t.flicker), shown(t.p99), shown(t.border));
      if (report.truths.contains(product))
        line += fmt::format(" {:>7} {:>7}", shown(t.error), shown(t.error_near_moving));
    }
    add(line);
  }
  return text +
         "flicker: RMS change from frame to frame at the same point of the same surface; border: "
         "of points within\n16 pixels of it; error: from --truth; moving: the same within 24 "
         "pixels "
         "of what moves. Times are those of\nwhole runs.\n";
}

std::string to_csv(const ShotBenchReport& report) {
  std::string text =
      "setting,cpu_s_per_frame,wall_s_per_frame,product,points,flicker,flicker_p99,flicker_border,"
      "error,error_near_moving,flicker_of_error,command\n";
  for (const ShotRow& row : report.rows) {
    const Cost seconds = report.seconds_per_frame(row);
    for (const std::string& product : report.products) {
      const ShotFigures& f = row.products.at(product);
      const Told t = told(product, f);
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", row.setting.name(), seconds.cpu_ms,
                      seconds.wall_ms, product, f.flicker.points, field(t.flicker), field(t.p99),
                      field(t.border), field(t.error), field(t.error_near_moving),
                      field(t.flicker_of_error), quoted(row.command));
    }
  }
  return text;
}

json to_json(const ShotBenchReport& report) {
  json rows = json::array(), truths = json::object(), metrics = json::object();
  for (const ShotRow& row : report.rows) {
    const Cost seconds = report.seconds_per_frame(row);
    json products = json::object();
    for (const auto& [product, figures] : row.products)
      products[product] = product_json(product, figures);
    rows.push_back({{"setting", row.setting.name()},
                    {"frames_around", row.setting.frames},
                    {"temporal", row.setting.temporal},
                    {"cpu_s_per_frame", seconds.cpu_ms},
                    {"wall_s_per_frame", seconds.wall_ms},
                    {"products", products},
                    {"command", row.command}});
  }
  for (const auto& [product, truth] : report.truths)
    truths[product] = {{"picture", truth.picture}, {"frames", truth.frames}};
  for (const std::string& product : report.products)
    metrics[product] = has_absolute_error(product) ? "rms" : "relative_rms";
  return {{"version", SSDO_VERSION},
          {"input", report.input},
          {"method", report.method},
          {"filter", report.filter},
          {"frames", report.frames},
          {"width", report.width},
          {"height", report.height},
          {"machine",
           {{"processor", report.processor},
            {"processors", report.processors},
            {"threads", report.threads},
            {"isa", report.isa}}},
          {"seconds", report.seconds},
          {"products", report.products},
          {"metrics", metrics},
          {"truths", truths},
          {"rows", rows}};
}

}  // namespace ssdo
