// SPDX-License-Identifier: Apache-2.0
#include "frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/matrix.hpp>
#include <string_view>
#include <utility>

#include "composite_choice.h"
#include "error.h"
#include "estimators/registry.h"
#include "known_geometry.h"
#include "scene/layers/advice.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The worlds of Blender and Unreal have z up.
UpAxis up_axis_of(const GBuffer& g) {
  const auto unreal = g.header.lower_bound("unreal/");
  const bool by_unreal = unreal != g.header.end() && unreal->first.starts_with("unreal/");
  return g.by_blender || by_unreal ? UpAxis::z : UpAxis::y;
}

bool wants_reflection(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  return contains(output.products, "reflection") || contains(output.products, kAllProducts) ||
         std::any_of(output.saves.begin(), output.saves.end(),
                     [](const SaveRequest& save) { return save.product == "reflection"; }) ||
         (choose_compose(output, aovs) == Compose::occlude &&
          std::any_of(aovs.begin(), aovs.end(),
                      [](const LayerRequest& aov) { return aov.role == Role::specular; }));
}

/// Names the layers that may be meant for what the frame lacks.
void hint_at_missing_layers(Frame& frame) {
  for (const Role role : {Role::normal, Role::albedo}) {
    if (frame.layers[role]) continue;
    const std::string hint = hint_at(role, group_channels(frame.files.front(), 0, frame.view));
    if (hint.empty()) continue;
    frame.report.warnings.push_back(
        fmt::format("no layer for {} found by name; {}", role_name(role), hint));
  }
}

void warn_of_idle_depth_options(Frame& frame, const GBufferOptions& options) {
  if (frame.layers[Role::depth]) return;
  const auto warn = [&](std::string_view option) {
    frame.report.warnings.push_back(
        fmt::format("{} has no effect: the frame has no depth layer", option));
  };
  if (options.depth_kind) warn("--depth-kind");
  if (options.background_depth) warn("--background-depth");
}

void warn_of_idle_light_options(Frame& frame, const LightOptions& options) {
  if (!frame.scene.light.is_constant()) return;
  const auto warn = [&](std::string_view option) {
    frame.report.warnings.push_back(
        fmt::format("{} has no effect: the light is the same from everywhere", option));
  };
  if (options.rotate_degrees != 0) warn("--env-rotate");
  if (options.up) warn("--env-up");
}

}  // namespace

const Layer& Frame::lead() const {
  return layers[Role::position] ? *layers[Role::position] : *layers[Role::depth];
}

const ExrPart& Frame::part() const {
  return files[std::size_t(lead().file)].parts()[std::size_t(lead().part)];
}

std::vector<std::string> Frame::warnings() const {
  std::vector<std::string> all = gbuffer.warnings;
  all.insert(all.end(), report.warnings.begin(), report.warnings.end());
  return all;
}

std::vector<std::string> Frame::losses() const {
  std::vector<std::string> all;
  for (const ExrReader& file : files)
    for (const std::string& line : file.losses()) all.push_back(line);
  all.insert(all.end(), further_losses.begin(), further_losses.end());
  return all;
}

Frame prepare_frame(const FrameOptions& options, const Lighting& light, FurtherPictures& pictures,
                    const FrameFiles& files, int number) {
  Frame frame;
  frame.input = files.input;
  frame.view = files.view;
  Stopwatch watch;
  // Names that nothing asks for are no reason to refuse a frame.
  std::vector<Role> unused;
  if (!wants_reflection(options.output, files.aovs)) unused.push_back(Role::roughness);
  if (!options.model.temporal) unused.push_back(Role::motion);
  std::deque<ExrReader> opened = open_view(files.input, files.aovs, options.input.allow_partial);
  const double opening = watch.lap();
  InputOptions input = for_view(options.input, files);
  input.gbuffer.downsample = options.output.downsample;
  input.gbuffer.beauty = choose_compose(options.output, files.aovs) != Compose::relight;
  input.gbuffer.most_pixels = most_pixels_in(options.memory);
  View view = read_view(std::move(opened), files.aovs, input, options.camera, unused);
  frame.files = std::move(view.files);
  frame.layers = std::move(view.layers);
  frame.gbuffer = std::move(view.gbuffer);
  frame.report = std::move(view.report);
  frame.times.read = opening + view.read_ms;
  hint_at_missing_layers(frame);

  Scene& scene = frame.scene;
  scene.geometry = std::move(view.geometry);
  scene.senders = {in_half(frame.gbuffer.albedo), std::move(frame.gbuffer.radiance)};
  frame.gbuffer.albedo = {};
  scene.roughness = std::move(frame.gbuffer.roughness);
  if (scene.geometry.camera.panorama) {
    throw Error(ExitCode::layer,
                fmt::format("{}: is a lat-long panorama, which shows no frame; give it with --also "
                            "to a frame of the same scene",
                            frame.input));
  }
  Stopwatch of_known;
  KnownGeometry known = read_known_geometry(frame, files, options, pictures, view.deep);
  frame.times.known = of_known.lap();
  if (known.deep.empty()) warn_of_idle_depth_options(frame, options.input.gbuffer);
  const bool world = scene.geometry.world_known;
  const Imf::Header& header = frame.part().header;
  const FrameEnvironment around =
      light.around(world ? up_axis_of(frame.gbuffer) : UpAxis::y, chromaticities_of(header));
  scene.light = model_light(around.environment, scene.geometry.world_to_camera);
  frame.light = around.description;
  frame.report.warnings.insert(frame.report.warnings.end(), around.warnings.begin(),
                               around.warnings.end());
  if (!scene.light.is_constant() && !world) {
    frame.report.warnings.push_back(
        "the frame knows no world space; the environment is taken in "
        "camera space: give --camera FILE.json to place it");
  }
  if (!scene.light.is_constant() && world && glm::determinant(scene.geometry.world_to_camera) < 0) {
    frame.report.warnings.push_back(
        "the world of P is left-handed: the map lies in its axes, and appears mirrored");
  }
  warn_of_idle_light_options(frame, options.light);
  ModelOptions model = options.model;
  if (model.temporal) model.seed += unsigned(number);
  of_known.lap();
  if (find_method(model.method).takes.thickness) {
    std::optional<float> thickness;
    if (model.thickness) thickness = float(*model.thickness);
    frame.views = use_known_geometry(known, scene, thickness, options.input.gbuffer);
  } else {
    const auto warn = [&](std::string_view option) {
      known.warnings.push_back(fmt::format(
          "{} has no effect: method {} does not look behind what is seen", option, model.method));
    };
    if (!files.also.empty()) warn("--also");
    if (!files.neighbours.empty()) warn("--neighbours");
  }
  if (!files.also.empty() || !files.neighbours.empty()) frame.times.known += of_known.lap();
  frame.report.warnings.insert(frame.report.warnings.end(), known.warnings.begin(),
                               known.warnings.end());
  frame.further_losses = std::move(known.losses);
  frame.plan = make_plan(model, options.output, scene, frame.gbuffer, frame.input);
  if (frame.gbuffer.grid.is_coarse()) {
    const Window& all = frame.part().data_window;
    frame.bands = plan_bands(frame.input, all, frame.part().display_window, scene, frame.plan,
                             options.output, options.memory);
    frame.plan.reasons.push_back(describe(*frame.bands, all));
  }
  const std::vector<std::string> idle =
      idle_for_composite(frame.plan, options.output, frame.gbuffer);
  frame.report.warnings.insert(frame.report.warnings.end(), idle.begin(), idle.end());
  explain_views(frame.plan, frame.views);
  frame.advice = explain_guessed(frame.plan, scene);
  frame.times.prepare = watch.lap() - view.read_ms - frame.times.known;
  return frame;
}

ColorTags color_tags(const Frame& frame) {
  const Imf::Header& header = frame.part().header;
  ColorTags tags;
  tags.path = frame.input;
  tags.interop_id = string_attribute(header, "colorInteropID");
  tags.aces_container = int_attribute(header, "acesImageContainerFlag") == 1;
  tags.chromaticities = chromaticities_of(header);
  return tags;
}

}  // namespace ssdo
