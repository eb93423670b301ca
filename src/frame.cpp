// SPDX-License-Identifier: Apache-2.0
#include "frame.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "error.h"
#include "estimators/registry.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/deep/join_measured.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Blender's world has z up; it marks its files, and Nuke keeps the mark under a prefix.
UpAxis up_axis_of(const Imf::Header& header) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (std::string(it.name()).find("BlenderMultiChannel") != std::string::npos) return UpAxis::z;
  }
  const bool blender = string_attribute(header, "Software").find("Blender") != std::string::npos;
  return blender ? UpAxis::z : UpAxis::y;
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

/// The deep images that --also names. Those of several views show the frame's.
std::vector<DeepImage> read_deep_images(const std::vector<std::string>& paths, Frame& frame,
                                        const GBufferOptions& options) {
  std::vector<DeepImage> images;
  for (const std::string& path : paths) {
    const ExrReader file(path);
    if (!has_deep_part(file)) {
      throw Error(ExitCode::usage,
                  fmt::format("--also {}: further views are not supported yet", path));
    }
    const std::string& view = frame.part().view;
    auto channels = view.empty() ? std::nullopt : find_deep_channels(file, view);
    if (!channels) channels = find_deep_channels(file, "");
    images.push_back(read_deep_frame(file, *channels, options, frame.report.warnings));
  }
  return images;
}

/// The solids of a frame, measured where deep images show them and guessed elsewhere.
Solids find_solids(const Geometry& geometry, const std::vector<DeepImage>& images,
                   const FrameOptions& options, std::vector<std::string>& warnings) {
  std::optional<float> thickness;
  if (options.model.thickness) thickness = float(*options.model.thickness);
  if (images.empty())
    return thickness ? constant_thickness(geometry, *thickness) : guess_solids(geometry);
  const GBufferOptions& reading = options.input.gbuffer;
  DeepDepths depths{std::nullopt, farthest_sample(reading)};
  if (reading.depth_kind)
    depths.kind = *reading.depth_kind == DepthKind::ray ? DepthKind::ray : DepthKind::planar;
  return join_measured(geometry, measure_solids(geometry, images, depths, warnings), thickness);
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

Frame prepare_frame(const FrameOptions& options, const Lighting& light, const FrameFiles& files,
                    int number) {
  Frame frame;
  frame.input = files.input;
  Stopwatch watch;
  // Names that nothing asks for are no reason to refuse a frame.
  std::vector<Role> unused;
  if (!find_method(options.model.method).products.reflection) unused.push_back(Role::roughness);
  if (!options.model.temporal) unused.push_back(Role::motion);
  View view = read_view(files.input, files.aovs, options.input, options.camera, unused);
  frame.files = std::move(view.files);
  frame.layers = std::move(view.layers);
  frame.gbuffer = std::move(view.gbuffer);
  frame.report = std::move(view.report);
  frame.times.read = view.read_ms;
  Stopwatch reading;
  std::vector<DeepImage> deep = read_deep_images(files.also, frame, options.input.gbuffer);
  if (view.deep) deep.push_back(std::move(*view.deep));
  frame.times.read += reading.lap();

  Scene& scene = frame.scene;
  scene.geometry = std::move(view.geometry);
  scene.senders = {std::move(frame.gbuffer.albedo), std::move(frame.gbuffer.radiance)};
  scene.roughness = std::move(frame.gbuffer.roughness);

  if (deep.empty()) warn_of_idle_depth_options(frame, options.input.gbuffer);
  const bool world = scene.geometry.world_known;
  const Imf::Header& header = frame.part().header;
  const FrameEnvironment around =
      light.around(world ? up_axis_of(header) : UpAxis::y, chromaticities_of(header));
  scene.light = model_light(around.environment, scene.geometry.world_to_camera);
  frame.light = around.description;
  frame.report.warnings.insert(frame.report.warnings.end(), around.warnings.begin(),
                               around.warnings.end());
  if (!scene.light.is_constant() && !world) {
    frame.report.warnings.push_back(
        "the frame knows no world space; the environment is taken in "
        "camera space: give --camera FILE.json to place it");
  }
  warn_of_idle_light_options(frame, options.light);
  ModelOptions model = options.model;
  if (model.temporal) model.seed += unsigned(number);
  if (find_method(model.method).takes.thickness)
    scene.solids = find_solids(scene.geometry, deep, options, frame.report.warnings);
  else if (!files.also.empty())
    frame.report.warnings.push_back(fmt::format(
        "--also has no effect: method {} does not look behind what is seen", model.method));
  frame.plan = make_plan(model, options.output, scene, frame.gbuffer, frame.input);
  frame.times.prepare = watch.lap() - frame.times.read;
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
