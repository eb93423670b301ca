// SPDX-License-Identifier: Apache-2.0
//
// Each method has the settings that its users would choose among: its own default, a few below and
// a few above. The limit is far beyond the last of them. Where the pattern follows --seed, it is
// the mean over several seeds, for a pattern that repeats is the same for all surfaces alike;
// the difference of two halves of the seeds is also what tells its noise. Methods without a seed
// (gtao, sao, msvo) have one run and no such figure.
#include "bench/ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "error.h"

namespace ssdo {
namespace {

Setting march(int slices, int steps) {
  Setting s;
  s.slices = slices;
  s.steps = steps;
  s.label = fmt::format("{} x {}", slices, steps);
  for (const QualityLevel& level : kQualities) {
    if (slices == level.slices && steps == level.steps) s.label += fmt::format(" ({})", level.name);
  }
  return s;
}

Setting with(std::string label, std::vector<std::string> set) {
  Setting s;
  s.label = std::move(label);
  s.set = std::move(set);
  return s;
}

Setting samples(int count, const char* noun = "samples") {
  return with(fmt::format("{} {}", count, noun), {fmt::format("samples={}", count)});
}

std::vector<Setting> each(std::initializer_list<int> counts, Setting (*make)(int)) {
  std::vector<Setting> all;
  for (const int count : counts) all.push_back(make(count));
  return all;
}

/// Taps on a spiral cover the disc evenly where its turns are near their number times the golden
/// ratio, as McGuire's 7 turns of 11 are, and share no factor with it.
Setting spiral(int count) {
  int turns = int(0.618 * count + 0.5);
  while (std::gcd(turns, count) != 1) ++turns;
  return with(fmt::format("{} samples, {} turns", count, turns),
              {fmt::format("samples={}", count), fmt::format("turns={}", turns)});
}

Setting horizons(int slices, int steps) {
  return with(fmt::format("{} x {}", slices, steps),
              {fmt::format("slices={}", slices), fmt::format("steps={}", steps)});
}

Setting taps(int steps) {
  return with(fmt::format("4 x {} taps", steps), {fmt::format("steps={}", steps)});
}

Setting resolution(int upsampling) {
  static constexpr std::array kNames = {"every pixel", "half, bilinear", "half, along surfaces"};
  return with(kNames[std::size_t(upsampling)], {fmt::format("upsampling={}", upsampling)});
}

Setting points(int count) { return samples(count); }
Setting rays(int count) { return samples(count, "rays"); }

Ladder plain_ladder_of(std::string_view method, int reference) {
  if (method == "bitmask") {
    return {{march(1, 6), march(2, 8), march(2, 16), march(2, 24), march(4, 32), march(6, 48),
             march(12, 64)},
            march(32, 96),
            2};
  }
  if (method == "trace") return {each({4, 16, 64}, rays), rays(reference), 2};
  if (method == "ssdo") return {each({8, 16, 32, 64, 128}, points), points(512), 4};
  if (method == "ssao" || method == "ssao-range")
    return {each({16, 32, 64, 128}, points), points(512), 8};
  if (method == "ssao-fade") return {each({1, 2, 0}, resolution), resolution(0), 128};
  if (method == "hbao") return {each({2, 3, 6, 12, 24}, taps), taps(32), 64};
  if (method == "gtao") {
    return {{horizons(1, 2), horizons(2, 2), horizons(3, 4), horizons(6, 8)}, horizons(32, 32), 1};
  }
  if (method == "sao") return {each({7, 11, 23, 47}, spiral), spiral(1013), 1};
  return {{with("four scales", {})}, with("four scales", {}), 1};
}

/// Whether a setting is what the method does when nothing is asked for.
bool is_default(const Method& method, const Setting& s) {
  if (method.marches)
    return s.slices == slices_of(Quality::standard) && s.steps == steps_of(Quality::standard);
  return std::all_of(s.set.begin(), s.set.end(), [&](const std::string& text) {
    return std::any_of(method.parameters.begin(), method.parameters.end(), [&](const Parameter& p) {
      return text == fmt::format("{}={:g}", p.name, p.value);
    });
  });
}

}  // namespace

std::string Setting::name() const { return fmt::format("{} {}", method->name, label); }

ModelOptions Setting::applied_to(const ModelOptions& model) const {
  ModelOptions out = model;
  out.method = method->name;
  if (!method->takes_solids()) {
    out.thickness.reset();
    if (out.radius && std::isinf(*out.radius)) out.radius.reset();
  }
  if (!method->has_radius) out.radius.reset();
  if (method->marches) {
    out.slices = slices;
    out.steps = steps;
  }
  out.set.insert(out.set.end(), set.begin(), set.end());
  return out;
}

std::vector<std::string> Setting::arguments() const {
  std::vector<std::string> words = {"--method", std::string(method->name)};
  if (method->marches) {
    words.insert(words.end(),
                 {"--slices", std::to_string(slices), "--steps", std::to_string(steps)});
  }
  for (const std::string& text : set) words.insert(words.end(), {"--set", text});
  return words;
}

Ladder ladder_of(const Method& method, int reference) {
  Ladder ladder = plain_ladder_of(method.name, reference);
  ladder.limit.method = &method;
  for (Setting& s : ladder.settings) {
    s.method = &method;
    s.standard = is_default(method, s);
  }
  return ladder;
}

Setting standard_setting(const Method& method) {
  const Ladder ladder = ladder_of(method, 0);
  return *std::find_if(ladder.settings.begin(), ladder.settings.end(),
                       [](const Setting& s) { return s.standard; });
}

int reference_rays(std::size_t surface_pixels) {
  constexpr double kAllRays = 3e7;
  int count = 512;
  while (count > 64 && count * double(surface_pixels) > kAllRays) count /= 2;
  return count;
}

}  // namespace ssdo
