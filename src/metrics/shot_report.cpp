// SPDX-License-Identifier: Apache-2.0
#include "metrics/shot_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/one_line.h"
#include "metrics/compare_report.h"

namespace ssdo {
namespace {

using nlohmann::json;

json flicker_json(const LayerFlickerFigures& flicker) {
  json j = flicker_json(flicker.a);
  if (flicker.a_minus_b) j["a_minus_b"] = flicker_json(*flicker.a_minus_b);
  return j;
}

/// The figures of a layer in a frame.
json layer_of_frame(const ShotFrame& frame, const std::string& name) {
  json j = json::object();
  for (const Compared& c : frame.compared.layers)
    if (c.pair.name() == name) j = layer_json(c);
  const auto flicker = frame.flicker.find(name);
  if (flicker != frame.flicker.end()) j["flicker"] = flicker_json(flicker->second);
  j["layer"] = name;
  return j;
}

json frame_json(const ShotComparison& shot, const ShotFrame& frame) {
  json layers = json::array();
  for (const std::string& name : frame.layers) layers.push_back(layer_of_frame(frame, name));
  json j = {{"frame", frame.number}, {"layers", layers}, {"notes", frame.notes}};
  if (shot.has_b) {
    j["only_in_a"] = frame.compared.only_in_a;
    j["only_in_b"] = frame.compared.only_in_b;
    j["lacks_layers"] = frame.compared.lacks_layers;
  }
  if (frame.error)
    j["error"] = {{"code", int(frame.error->code)}, {"message", frame.error->what()}};
  return j;
}

/// The figures over all frames, in the form of those of one frame.
LayerFlickerFigures figures_of(const LayerFlicker& flicker) {
  LayerFlickerFigures figures{flicker.a.figures(), {}};
  if (flicker.a_minus_b.points > 0) figures.a_minus_b = flicker.a_minus_b.figures();
  return figures;
}

json total_json(const ShotComparison& shot, const std::string& name) {
  json j = {{"layer", name}};
  const auto error = shot.errors.find(name);
  if (error != shot.errors.end()) {
    const auto& [figures, worst, worst_frame] = error->second;
    j.update({{"rmse", json_number(figures.rmse)},
              {"relative_rmse", json_number(figures.relative_rmse())},
              {"bias", json_number(figures.bias)},
              {"max", json_number(figures.largest)},
              {"psnr", json_number(figures.psnr())},
              {"worst", {{"frame", worst_frame}, {"rmse", json_number(worst)}}}});
  }
  const auto flicker = shot.flicker.find(name);
  if (flicker != shot.flicker.end()) j["flicker"] = flicker_json(figures_of(flicker->second));
  return j;
}

/// The columns of an error; blank without one.
std::string error_columns(const Difference* d, double p99) {
  if (!d) return fmt::format(" {:>10} {:>9} {:>10} {:>10} {:>10}", "", "", "", "", "");
  return fmt::format(" {:>10.5g} {:>9.4g} {:>+10.4g} {:>10.5g} {:>10}", d->rmse, d->relative_rmse(),
                     d->bias, d->largest, std::isfinite(p99) ? fmt::format("{:.5g}", p99) : "");
}

std::string flicker_columns(const ShotComparison& shot, const LayerFlickerFigures* f) {
  const auto number = [](double v) { return std::isfinite(v) ? fmt::format("{:.5f}", v) : "-"; };
  if (!f) return "";
  std::string text = fmt::format(" {:>9} {:>9} {:>9} {:>9}", f->a.points, number(f->a.rms),
                                 number(f->a.p99), number(f->a.border_rms));
  if (shot.has_b)
    text += fmt::format(" {:>9} {:>9}", f->a_minus_b ? number(f->a_minus_b->rms) : "-",
                        f->a_minus_b ? number(f->a_minus_b->border_rms) : "-");
  return text;
}

std::string heading(const ShotComparison& shot, int width) {
  std::string text = fmt::format("{:>8} {:<{}}", "frame", "layer", width);
  if (shot.has_b)
    text += fmt::format(" {:>9} {:>9} {:>10} {:>9} {:>10} {:>10} {:>10}", "pixels", "left out",
                        "RMSE", "relative", "bias", "max", "99 %");
  if (shot.has_points)
    text += fmt::format(" {:>9} {:>9} {:>9} {:>9}", "points", "flicker", "99 %", "border");
  if (shot.has_points && shot.has_b) text += fmt::format(" {:>9} {:>9}", "of A-B", "border");
  return text + "\n";
}

std::string without_blanks(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string frame_lines(const ShotComparison& shot, const ShotFrame& frame, int width) {
  std::string text;
  for (const std::string& name : frame.layers) {
    std::string line = fmt::format("{:>8} {:<{}}", frame.number, printable(name), width);
    for (const Compared& c : frame.compared.layers) {
      if (c.pair.name() != name) continue;
      line += fmt::format(" {:>9} {:>9}", c.difference.pixels, c.difference.left_out.all()) +
              error_columns(&c.difference.figures, c.difference.figures.p99);
    }
    const auto flicker = frame.flicker.find(name);
    line += flicker_columns(shot, flicker == frame.flicker.end() ? nullptr : &flicker->second);
    text += without_blanks(line);
  }
  for (const Compared& c : frame.compared.layers)
    if (const std::string note = note_of_left_out(c); !note.empty())
      text += fmt::format("{:>8} {}", frame.number, note);
  if (frame.compared.lacks_layers)
    text += fmt::format(
        "{:>8} fails: a layer is in one file only; name the layers to compare, FILE:LAYER\n",
        frame.number);
  for (const std::string& note : frame.notes)
    text += fmt::format("{:>8} {}\n", frame.number, printable(note));
  if (frame.error) text += fmt::format("{:>8} {}\n", frame.number, printable(frame.error->what()));
  return text;
}

std::string total_line(const ShotComparison& shot, const std::string& name, int width) {
  std::string line = fmt::format("{:>8} {:<{}}", "all", printable(name), width);
  const auto error = shot.errors.find(name);
  const bool has_error = error != shot.errors.end();
  if (shot.has_b)
    line += fmt::format(" {:>9} {:>9}", "", "") +
            error_columns(has_error ? &error->second.figures : nullptr, NAN);
  const auto flicker = shot.flicker.find(name);
  if (flicker != shot.flicker.end()) {
    const LayerFlickerFigures figures = figures_of(flicker->second);
    line += flicker_columns(shot, &figures);
  }
  line = without_blanks(line);
  if (has_error)
    line += fmt::format("{:>8} {:<{}} RMSE {:.5g} in frame {}\n", "worst", printable(name), width,
                        error->second.worst, error->second.worst_frame);
  return line;
}

}  // namespace

json flicker_json(const FlickerFigures& f) {
  return {{"points", f.points},
          {"rms", json_number(f.rms)},
          {"p99", json_number(f.p99)},
          {"border_rms", json_number(f.border_rms)},
          {"mean", json_number(f.mean)}};
}

json to_json(const CompareOptions& options, const ShotComparison& shot) {
  json frames = json::array(), layers = json::array();
  for (const ShotFrame& frame : shot.frames) frames.push_back(frame_json(shot, frame));
  for (const std::string& name : shot.layers) layers.push_back(total_json(shot, name));
  const auto text = [](const std::string& name) {
    return name.empty() ? json(nullptr) : json(name);
  };
  return {{"a", options.a},
          {"b", text(options.b)},
          {"points", text(options.points)},
          {"frames", frames},
          {"layers", layers}};
}

std::string to_table(const ShotComparison& shot) {
  std::size_t width = 8;
  for (const std::string& name : shot.layers) width = std::max(width, printable(name).size());
  std::string text = heading(shot, int(width));
  for (const ShotFrame& frame : shot.frames) text += frame_lines(shot, frame, int(width));
  for (const std::string& name : shot.layers) text += total_line(shot, name, int(width));
  return text;
}

}  // namespace ssdo
