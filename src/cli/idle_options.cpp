// SPDX-License-Identifier: Apache-2.0
#include "cli/idle_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "estimators/registry.h"
#include "io/images/image_file.h"
#include "plan/composite_choice.h"

namespace ssdo {
namespace {

using Condition = std::function<bool(const Options&)>;

/// When an option has no effect, and what would give it one.
struct IdleRule {
  std::vector<std::string_view> options;  ///< as messages name them: a value may follow
  Condition idle;
  std::string_view reason;
};

const Method& method_of(const Options& o) { return find_method(o.model.method); }

/// Whether the run has outputs, and none of them is of the kind.
template <typename Kind>
Condition no_output(Kind kind) {
  return [kind](const Options& o) {
    if (o.command != Command::relight || (o.output.files.empty() && o.output.saves.empty()))
      return false;
    return std::none_of(o.output.files.begin(), o.output.files.end(), kind) &&
           std::none_of(o.output.saves.begin(), o.output.saves.end(),
                        [&](const SaveRequest& save) { return kind(save.path); });
  };
}

bool is_picture(const std::string& path) { return is_display_image(path); }
bool is_exr(const std::string& path) { return !is_picture(path); }
bool is_deep_picture(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  return is_picture(path) && ending.find_first_of("jJ") == ending.npos;
}

/// Whether a file holds one of these products; an EXR holds the usual ones if none are named.
bool asks_for(const Options& o, const std::vector<std::string_view>& products) {
  const OutputOptions& output = o.output;
  const auto is_one = [&](std::string_view name) {
    return name == kAllProducts || std::ranges::find(products, name) != products.end();
  };
  if (std::ranges::any_of(output.saves, is_one, &SaveRequest::product)) return true;
  if (output.files.empty() && !output.saves.empty()) return false;
  if (!output.products.empty()) return std::ranges::any_of(output.products, is_one);
  const auto is_usual = [](std::string_view name) { return find_product(name).usual; };
  return std::ranges::any_of(products, is_usual) &&
         (output.files.empty() || std::ranges::any_of(output.files, is_exr));
}

/// Whether a picture of -o shows the composite.
bool shows_composite(const OutputOptions& output) {
  return output.products.empty() && std::ranges::any_of(output.files, is_picture);
}

bool sets(const ModelOptions& model, std::string_view parameter) {
  return std::ranges::any_of(model.set, [&](const std::string& setting) {
    return setting.starts_with(parameter) && setting.substr(parameter.size()).starts_with('=');
  });
}

bool has_specular(const std::vector<LayerRequest>& aovs) {
  return std::ranges::any_of(aovs, [](const LayerRequest& a) { return a.role == Role::specular; });
}

/// Whether all that is made is as it is without these products: occlude takes how much of the light
/// arrives, and --error measures direct + bounce.
Condition occlude_without(const std::vector<std::string_view>& products) {
  return [products](const Options& o) {
    return o.command != Command::bench && !o.model.error &&
           choose_compose(o.output, o.input.aovs) == Compose::occlude && !asks_for(o, products);
  };
}

const std::vector<IdleRule>& rules() {
  static const std::vector<IdleRule> all = {
      {{"--motion-scale"},
       [](const Options& o) { return !o.model.temporal; },
       "motion is used with --temporal only"},
      {{"--quality", "--offscreen"},
       [](const Options& o) { return o.command != Command::bench && !method_of(o).takes.march; },
       "the method does not take it"},
      {{"--quality"},
       [](const Options& o) { return o.model.slices && o.model.steps; },
       "--slices and --steps stand in its place"},
      {{"--bounces"},
       [](const Options& o) {
         return o.command != Command::bench && !method_of(o).products.bounce;
       },
       "the method makes no bounce"},
      {{"--bounces"},
       occlude_without({"bounce", "error"}),
       "composite occlude does not use it, and no output has bounce"},
      {{"--bounces"},
       [](const Options& o) {
         return o.command == Command::relight && o.model.bounces > 0 && !o.model.error &&
                choose_compose(o.output, o.input.aovs) != Compose::occlude &&
                !shows_composite(o.output) && !asks_for(o, {"bounce", "composite", "error"});
       },
       "no output has bounce or the composite"},
      {{"--set roughness"},
       [](const Options& o) {
         return o.command == Command::relight && sets(o.model, "roughness") &&
                !asks_for(o, {"reflection"}) && !has_specular(o.input.aovs);
       },
       "no output has reflection"},
      {{"--env-exposure"},
       occlude_without({"direct", "bounce", "error"}),
       "composite occlude takes the share of the light that arrives, and no output has light"},
      {{"--seed"},
       [](const Options& o) {
         return o.command != Command::bench && method_of(o).ladder.seeds == 1;
       },
       "the method has no noise"},
      {{"--compose"},
       [](const Options& o) { return o.command == Command::bench; },
       "bench measures no composite"},
      {{"--mem-limit"},
       [](const Options& o) { return o.command == Command::bench; },
       "bench measures whole frames"},
      {{"--products"},
       [](const Options& o) { return o.output.files.empty() && !o.output.saves.empty(); },
       "it is for files of -o, and --save names its product"},
      {{"--pixel-type", "--compression", "--keep-channels", "--crop", "--history"},
       no_output(is_exr),
       "no output is an EXR"},
      {{"--bits"}, no_output(is_deep_picture), "no output is PNG or TIFF"},
      {{"--ocio", "--colorspace", "--display", "--view", "--look"},
       no_output(is_picture),
       "no output is PNG, JPEG or TIFF"},
  };
  return all;
}

}  // namespace

std::vector<std::string> idle_options(const std::set<std::string>& given, const Options& options) {
  std::vector<std::string> lines;
  for (const IdleRule& rule : rules()) {
    for (const std::string_view option : rule.options) {
      const std::string_view name = option.substr(0, option.find(' '));
      if (given.contains(std::string(name)) && rule.idle(options))
        lines.push_back(fmt::format("{} has no effect: {}", option, rule.reason));
    }
  }
  return lines;
}

}  // namespace ssdo
