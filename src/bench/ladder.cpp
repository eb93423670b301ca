// SPDX-License-Identifier: Apache-2.0
//
// Each method has the settings that its users would choose among: its default, a few below and a
// few above. Its limit is far beyond the last of them, and the mean over several seeds, since a
// single pattern leaves an error that more samples do not remove; half the difference between the
// means of two halves of the seeds measures its noise. A method without noise (msvo) has one run
// and no such figure.
#include "bench/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "estimators/registry.h"

namespace ssdo {
namespace {

/// The default of a parameter, or of the slices or steps of a method that marches.
double default_of(const Method& method, std::string_view name) {
  if (!method.supports.march) return find_parameter(method, name)->value;
  return name == "slices" ? slices_of(Quality::standard) : steps_of(Quality::standard, false);
}

bool is_default(const Method& method, const Rung& rung) {
  return std::all_of(rung.values.begin(), rung.values.end(), [&](const auto& value) {
    return value.second == default_of(method, value.first);
  });
}

std::string label_of(const Method& method, const Rung& rung) {
  std::string label = rung.label;
  for (const auto& [name, value] : rung.values) {
    if (!rung.label.empty()) break;
    const std::string_view unit = find_parameter(method, name)->unit;
    label += fmt::format("{}{} {}", label.empty() ? "" : ", ", value, unit.empty() ? name : unit);
  }
  if (!method.supports.march) return label;
  for (const QualityLevel& level : kQualities) {
    if (rung.values == slices_and_steps(level.slices, level.steps).values)
      label += fmt::format(" ({})", level.name);
  }
  return label;
}

Setting setting_of(const Method& method, Rung rung) {
  rung.label = label_of(method, rung);
  const bool standard = is_default(method, rung);
  return {&method, std::move(rung), standard};
}

}  // namespace

std::string Setting::name() const { return fmt::format("{} {}", method->name, rung.label); }

ModelOptions Setting::applied_to(const ModelOptions& model) const {
  ModelOptions out = model;
  out.method = method->name;
  const SupportedOptions& supports = method->supports;
  if (!supports.thickness) out.thickness.reset();
  if (!supports.radius || (!supports.infinite_radius && out.radius && std::isinf(*out.radius)))
    out.radius.reset();
  for (const auto& [name, value] : rung.values) {
    if (supports.march)
      (name == "slices" ? out.slices : out.steps) = value;
    else
      out.set.push_back(fmt::format("{}={}", name, value));
  }
  return out;
}

std::vector<std::string> Setting::arguments() const {
  std::vector<std::string> words = {"--method", std::string(method->name)};
  if (method->supports.prior) words.insert(words.end(), {"--prior", "rules"});
  for (const auto& [name, value] : rung.values) {
    if (method->supports.march)
      words.insert(words.end(), {fmt::format("--{}", name), std::to_string(value)});
    else
      words.insert(words.end(), {"--set", fmt::format("{}={}", name, value)});
  }
  return words;
}

Settings settings_of(const Method& method, int rays) {
  Settings settings;
  for (const Rung& rung : method.ladder.rungs) settings.ladder.push_back(setting_of(method, rung));
  Rung limit = method.ladder.limit;
  if (method.is_reference) limit.values.front().second = rays;
  settings.limit = setting_of(method, std::move(limit));
  settings.seeds = method.ladder.seeds;
  return settings;
}

Setting standard_setting(const Method& method) {
  const std::vector<Setting> ladder = settings_of(method, 0).ladder;
  return *std::find_if(ladder.begin(), ladder.end(), [](const Setting& s) { return s.standard; });
}

int reference_rays(std::size_t surface_pixels) {
  constexpr double kAllRays = 3e7;
  int count = 512;
  while (count > 64 && count * double(surface_pixels) > kAllRays) count /= 2;
  return count;
}

}  // namespace ssdo
