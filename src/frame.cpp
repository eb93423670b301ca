// SPDX-License-Identifier: Apache-2.0
#include "frame.h"

#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <string_view>

#include "estimators/registry.h"
#include "listing.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Blender's world has z up; it marks its files, and Nuke keeps the mark under a prefix.
UpAxis up_axis_of(const Imf::Header& header) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    if (std::string(it.name()).find("BlenderMultiChannel") != std::string::npos) return UpAxis::z;
  }
  const auto* software = header.findTypedAttribute<Imf::StringAttribute>("Software");
  return software && software->value().find("Blender") != std::string::npos ? UpAxis::z : UpAxis::y;
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
  if (!frame.environment.is_constant()) return;
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

Frame prepare_frame(const Options& options, const Light& light, const std::string& input,
                    const std::vector<LayerRequest>& aovs) {
  Frame frame;
  frame.input = input;
  Stopwatch watch;
  for (const std::string& path : files_of_frame(input, aovs)) frame.files.emplace_back(path);
  std::vector<const ExrReader*> files;
  for (const ExrReader& file : frame.files) files.push_back(&file);
  // Names that nothing asks for are no reason to refuse a frame.
  std::vector<Role> unused;
  if (!find_method(options.model.method).products.reflection) unused.push_back(Role::roughness);
  if (!options.model.temporal) unused.push_back(Role::motion);
  frame.layers = find_layers(files, aovs, options.input.part, unused);
  require_position(frame.layers, frame.files.front(),
                   options.command == Command::info ? "" : " ('ssdo info' lists the layers)");
  frame.gbuffer = read_gbuffer(files, frame.layers, options.input.gbuffer);
  frame.times.read = watch.lap();

  frame.geometry = build_geometry(frame.gbuffer, options.camera, input, frame.report);
  // From here on there is one position and one normal: those of the geometry.
  frame.gbuffer.position = frame.gbuffer.normal = {};
  frame.gbuffer.depth = {};

  warn_of_idle_depth_options(frame, options.input.gbuffer);
  const bool world = frame.geometry.world_known;
  const Imf::Header& header = frame.part().header;
  const FrameLight around =
      light.around(world ? up_axis_of(header) : UpAxis::y, chromaticities_of(header));
  frame.environment = around.environment;
  frame.light = around.description;
  frame.report.warnings.insert(frame.report.warnings.end(), around.warnings.begin(),
                               around.warnings.end());
  if (!frame.environment.is_constant() && !world) {
    frame.report.warnings.push_back(
        "the frame knows no world space; the environment is taken in "
        "camera space: give --camera FILE.json to place it");
  }
  warn_of_idle_light_options(frame, options.light);
  if (!frame.environment.is_constant())
    frame.light_model = model_light(frame.environment, frame.geometry.world_to_camera);
  frame.plan = make_plan(options.model, options.output, frame.gbuffer, frame.geometry,
                         frame.light_model ? &*frame.light_model : nullptr, input);
  if (frame.plan.method->looks_behind()) {
    const auto& thickness = options.model.thickness;
    frame.hidden = thickness ? constant_thickness(frame.geometry, float(*thickness))
                             : find_hidden_geometry(frame.geometry);
  }
  frame.times.prepare = watch.lap();
  return frame;
}

ColorTags color_tags(const Frame& frame) {
  const Imf::Header& header = frame.part().header;
  ColorTags tags;
  tags.path = frame.input;
  if (const auto* id = header.findTypedAttribute<Imf::StringAttribute>("colorInteropID")) {
    tags.interop_id = id->value();
  }
  if (const auto* flag = header.findTypedAttribute<Imf::IntAttribute>("acesImageContainerFlag")) {
    tags.aces_container = flag->value() == 1;
  }
  tags.chromaticities = chromaticities_of(header);
  return tags;
}

}  // namespace ssdo
