// SPDX-License-Identifier: Apache-2.0
#include "relight/plan_frame.h"

#include <fmt/format.h>

#include <algorithm>

#include "error.h"
#include "plan/explain.h"
#include "plan/make_plan.h"
#include "relight/frame_warnings.h"
#include "scene/layers/groups.h"
#include "scene/layers/names.h"
#include "scene/layers/windows.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Bands have the rows of the frame.
void check_bands(const Frame& frame) {
  const bool composites = frame.plan.composition.shows_rendered();
  if (window_of_outputs(frame.readers(), frame.layers, composites, {}) == frame.gbuffer.file_window)
    return;
  throw Error(ExitCode::usage,
              fmt::format("{}: a rendered layer reaches beyond the display window, where the data "
                          "window of P ends, and takes all of the frame at once: render P with the "
                          "same overscan, or raise --mem-limit",
                          frame.input));
}

/// In a part with several views, "direct.right.R" is the right view's light of all.
void check_names_of_lights(const Frame& frame) {
  const std::vector<std::string> views = views_of(group_channels(frame.files.front(), 0));
  for (const LightGroup& light : light_groups_of(frame.scene.light)) {
    const auto is_name = [&](const std::string& view) { return lower(view) == lower(light.name); };
    if (std::ranges::none_of(views, is_name)) continue;
    throw Error(ExitCode::usage,
                fmt::format("{}: light '{}' has the name of a view, whose channels its own would "
                            "be taken for; give it another for --per-light",
                            frame.input, light.name));
  }
}

}  // namespace

void plan_frame(Frame& frame, const FrameOptions& options, int number, bool has_deep_pixels) {
  ModelOptions model = options.model;
  if (model.temporal || model.shot.count > 0) model.seed += unsigned(number);
  frame.plan = make_plan(model, options.output, frame.scene, frame.gbuffer, frame.input);
  if (frame.plan.shot && frame.scene.geometry.median_depth > 0 &&
      !frame.scene.geometry.world_known) {
    throw Error(ExitCode::layer,
                fmt::format("{}: knows no world space to find its points in other frames; render P "
                            "in world space, or give --camera FILE.json with its pose",
                            frame.input));
  }
  if (prior_of(model) == Prior::learned) use_prior(frame.plan, {frame.up});
  if (options.output.per_light) check_names_of_lights(frame);
  if (frame.gbuffer.grid.is_coarse()) {
    check_bands(frame);
    const Window& all = frame.gbuffer.file_window;
    frame.bands = plan_bands(frame.input, all, frame.part().display_window, frame.scene, frame.plan,
                             options.output, options.memory);
    frame.plan.reasons.push_back(describe(*frame.bands, all));
  }
  warn_of_plan(frame, options, has_deep_pixels);
  explain_earlier_products(frame);
  explain_views(frame.plan, frame.views);
  if (!frame.near_backdrop.empty()) frame.plan.reasons.push_back(frame.near_backdrop);
  frame.guessed = explain_guessed(frame.plan, frame.scene);
}

}  // namespace ssdo
