// SPDX-License-Identifier: Apache-2.0
#include "relight/ineffective_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "estimators/registry.h"
#include "io/images/image_file.h"
#include "plan/composite_choice.h"

namespace ssdo {
namespace {

/// The condition under which options have no effect, by the request and by `Of`, and the reason.
template <class Of>
struct IdleRule {
  using Condition = std::function<bool(const FrameOptions&, const Of&)>;

  std::vector<std::string_view> options;  ///< as messages name them: a value may follow
  Condition idle;
  std::string_view reason;  ///< may hold {method} and {of_composite}
};
using Condition = IdleRule<Purpose>::Condition;

const Method& method_of(const FrameOptions& o) { return find_method(o.model.method); }

/// Whether the run has outputs, and none of them is of the kind.
template <typename Kind>
Condition no_output(Kind kind) {
  return [kind](const FrameOptions& o, Purpose purpose) {
    if (purpose != Purpose::relight || (o.output.files.empty() && o.output.saves.empty()))
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
bool asks_for(const FrameOptions& o, const std::vector<std::string_view>& products) {
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

/// Whether the outputs do not depend on these products: the composite is occlude, which needs only
/// the arriving share of the light, and there is no --error, which measures direct + bounce.
Condition occlude_without(const std::vector<std::string_view>& products) {
  return [products](const FrameOptions& o, Purpose purpose) {
    return purpose != Purpose::bench && !o.model.error &&
           choose_compose(o.output, o.input.aovs) == Compose::occlude && !asks_for(o, products);
  };
}

/// Options that others leave without effect.
const std::vector<IdleRule<Purpose>>& rules_of_options() {
  static const std::vector<IdleRule<Purpose>> all = {
      {{"--motion-scale"},
       [](const FrameOptions& o, Purpose) { return !o.model.temporal && o.model.shot.count == 0; },
       "motion is used with --shot and --temporal only"},
      {{"--prior"},
       [](const FrameOptions&, Purpose purpose) { return purpose == Purpose::bench; },
       "bench measures methods by their rules"},
      {{"--prior"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight && o.model.prior == Prior::learned &&
                !shows_composite(o.output) &&
                !asks_for(o, {"ao", "bent", "direct", "shadow", "bounce", "specular", "composite",
                              "guessed"});
       },
       "no output has a product that it changes"},
      {{"--quality", "--offscreen"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose != Purpose::bench && !method_of(o).supports.march;
       },
       "the method does not take it"},
      {{"--quality"},
       [](const FrameOptions& o, Purpose) { return o.model.slices && o.model.steps; },
       "--slices and --steps stand in its place"},
      {{"--bounces"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose != Purpose::bench && !method_of(o).products.bounce;
       },
       "the method makes no bounce"},
      {{"--bounces"},
       occlude_without({"bounce", "error"}),
       "composite occlude does not use it, and no output has bounce"},
      {{"--bounces"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight && o.model.bounces > 0 && !o.model.error &&
                choose_compose(o.output, o.input.aovs) != Compose::occlude &&
                !shows_composite(o.output) && !asks_for(o, {"bounce", "composite", "error"});
       },
       "no output has bounce or the composite"},
      {{"--set roughness"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight && sets(o.model, "roughness") &&
                !asks_for(o, {"reflection", "specular"}) && !has_specular(o.input.aovs);
       },
       "no output has reflection or specular"},
      {{"--set ior"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight && sets(o.model, "ior") && !asks_for(o, {"specular"});
       },
       "no output has specular"},
      {{"--per-light"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight &&
                !asks_for(o, {"direct", "bounce", "unshadowed", "shadow"});
       },
       "no output has direct, bounce, unshadowed or shadow"},
      {{"--per-light"},
       [](const FrameOptions&, Purpose purpose) { return purpose == Purpose::bench; },
       "bench measures the light of all"},
      {{"--shadow-of", "--only", "--no-receive", "--holdout"},
       [](const FrameOptions&, Purpose purpose) { return purpose == Purpose::bench; },
       "bench measures the whole frame, and writes none"},
      {{"--shadow-of"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose == Purpose::relight && !o.output.products.empty() &&
                !asks_for(o, {"shadow_of"});
       },
       "no output has shadow_of"},
      {{"--env-exposure"},
       occlude_without({"direct", "bounce", "error"}),
       "composite occlude takes the share of the light that arrives, and no output has light"},
      {{"--light", "--lights"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose != Purpose::bench && !method_of(o).products.direct;
       },
       "the method makes no light"},
      {{"--seed"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose != Purpose::bench && method_of(o).ladder.seeds == 1;
       },
       "the method has no noise"},
      {{"--also"},
       [](const FrameOptions& o, Purpose purpose) {
         return purpose != Purpose::bench && !method_of(o).supports.thickness;
       },
       "method {method} does not look behind what is seen"},
      {{"--compose"},
       [](const FrameOptions&, Purpose purpose) { return purpose == Purpose::bench; },
       "bench measures no composite"},
      {{"--mem-limit"},
       [](const FrameOptions&, Purpose purpose) { return purpose == Purpose::bench; },
       "bench measures whole frames"},
      {{"--products"},
       [](const FrameOptions& o, Purpose) {
         return o.output.files.empty() && !o.output.saves.empty();
       },
       "it is for files of -o, and --save names its product"},
      {{"--per-light", "--pixel-type", "--compression", "--keep-channels", "--crop", "--history"},
       no_output(is_exr),
       "no output is an EXR"},
      {{"--bits"}, no_output(is_deep_picture), "no output is PNG or TIFF"},
      {{"--ocio", "--colorspace", "--display", "--view", "--look"},
       no_output(is_picture),
       "no output is PNG, JPEG or TIFF"},
  };
  return all;
}

using Facts = FrameFacts;

bool makes_composite(const Facts& frame) { return contains(frame.plan.make, "composite"); }
bool occludes(const Facts& frame) {
  return makes_composite(frame) && frame.plan.composition.compose == Compose::occlude;
}

/// Options that a frame has no use for.
const std::vector<IdleRule<Facts>>& rules_of_frames() {
  using Asked = FrameOptions;
  static const std::vector<IdleRule<Facts>> all = {
      {{"--depth-kind"},
       [](const Asked& o, const Facts& f) { return o.input.gbuffer.depth_kind && !f.depth; },
       "the frame has no depth layer"},
      {{"--background-depth"},
       [](const Asked& o, const Facts& f) { return o.input.gbuffer.background_depth && !f.depth; },
       "the frame has no depth layer"},
      {{"--space"},
       [](const Asked& o, const Facts& f) {
         return o.input.gbuffer.space && !f.position && !f.normal;
       },
       "the frame has neither P nor N"},
      {{"--env-rotate"},
       [](const Asked& o, const Facts& f) {
         return o.light.rotate_degrees != 0 && f.constant_light;
       },
       "the light is the same from everywhere"},
      {{"--env-up"},
       [](const Asked& o, const Facts& f) {
         return o.light.up && f.constant_light && !f.lamps && prior_of(o.model) == Prior::rules;
       },
       "the light is the same from everywhere"},
      {{"--crop"},
       [](const Asked& o, const Facts& f) { return o.output.crop && !f.overscan; },
       "the frame has no pixels beyond its display window"},
      {{"--compose"},
       [](const Asked& o, const Facts& f) { return o.output.compose && !makes_composite(f); },
       "{of_composite}"},
      {{"--holdout"},
       [](const Asked& o, const Facts& f) {
         return !o.input.objects.holdout.empty() && !makes_composite(f);
       },
       "{of_composite}"},
      {{"--aov ambient"},
       [](const Asked&, const Facts& f) { return f.ambient && !occludes(f); },
       "{of_composite}"},
      {{"--aov specular-color"},
       [](const Asked&, const Facts& f) {
         return f.specular_color && !f.plan.request.products.specular;
       },
       "no output has specular"},
      {{"--set ior"},
       [](const Asked& o, const Facts& f) {
         return f.specular_color && f.plan.request.products.specular && sets(o.model, "ior");
       },
       "the layer specular-color stands in its place"},
      {{"--aov specular"},
       [](const Asked&, const Facts& f) { return f.specular && !occludes(f); },
       "{of_composite}"},
      {{"--aov light"},
       [](const Asked&, const Facts& f) { return f.lights && !occludes(f); },
       "{of_composite}"},
  };
  return all;
}

std::string warning(std::string_view option, std::string_view reason, std::string_view method,
                    std::string_view of_composite = "") {
  return fmt::format("{} has no effect: {}", option,
                     fmt::format(fmt::runtime(reason), fmt::arg("method", method),
                                 fmt::arg("of_composite", of_composite)));
}

}  // namespace

std::vector<std::string> ineffective_options(const std::set<std::string>& given,
                                             const FrameOptions& options, Purpose purpose) {
  std::vector<std::string> lines;
  for (const IdleRule<Purpose>& rule : rules_of_options()) {
    for (const std::string_view option : rule.options) {
      const std::string_view name = option.substr(0, option.find(' '));
      if (given.contains(std::string(name)) && rule.idle(options, purpose))
        lines.push_back(warning(option, rule.reason, options.model.method));
    }
  }
  return lines;
}

std::vector<std::string> ineffective_options(const FrameOptions& options, const FrameFacts& frame) {
  const std::string of_composite =
      makes_composite(frame)
          ? fmt::format("composite {} does not use it", name_of(frame.plan.composition.compose))
          : "no output has the composite";
  std::vector<std::string> lines;
  for (const IdleRule<Facts>& rule : rules_of_frames()) {
    if (!rule.idle(options, frame)) continue;
    for (const std::string_view option : rule.options)
      lines.push_back(warning(option, rule.reason, frame.plan.method->name, of_composite));
  }
  return lines;
}

}  // namespace ssdo
