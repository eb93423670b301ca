// SPDX-License-Identifier: Apache-2.0
#include "scene/view.h"

#include <fmt/format.h>

#include <utility>

#include "error.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/layers/advice.h"
#include "scene/layers/groups.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Where no layer tells where surfaces are, deep samples do: the first solid of a pixel is what it
/// shows. Returns its depth, and sets how the depth is to be read on.
Plane<float> take_depth_from_samples(View& view, const std::string& part, GBufferOptions& options,
                                     std::vector<std::string>& warnings) {
  const ExrReader& file = view.files.front();
  if (view.layers[Role::position] || view.layers[Role::depth]) return {};
  const auto channels = find_deep_channels(file, part);
  if (!channels) return {};
  view.deep = read_deep_frame(file, *channels, options, warnings);
  const std::string& name = channels->front.name;
  view.layers[Role::depth] = Layer{0, channels->front.part, name, {name}, view.deep->half, false};
  const float far = farthest_sample(options);
  if (options.depth_kind && *options.depth_kind != DepthKind::ray)
    options.depth_kind = DepthKind::planar;
  return nearest_surfaces(*view.deep, far);
}

/// An error of a frame without P, with the layer that may hold it.
Error with_hint(const Error& error, const View& view, const std::string& eye) {
  if (view.layers[Role::position] || error.code != ExitCode::layer) return error;
  const std::string hint = hint_at(Role::position, group_channels(view.files.front(), 0, eye));
  return hint.empty() ? error : Error(error.code, fmt::format("{}; {}", error.what(), hint));
}

}  // namespace

FrameFiles in_view(FrameFiles files, std::string_view view) {
  files.view = view;
  for (FrameFiles& neighbour : files.neighbours) neighbour.view = view;
  return files;
}

FrameFiles other_eye(const FrameFiles& files) {
  return in_view(files, files.view == kEyes[0] ? kEyes[1] : kEyes[0]);
}

InputOptions for_view(InputOptions options, const FrameFiles& files) {
  options.view = files.view;
  return options;
}

std::deque<ExrReader> open_view(const std::string& input, const std::vector<LayerRequest>& aovs,
                                bool allow_partial) {
  const Salvage salvage = allow_partial ? Salvage::done : Salvage::offered;
  std::deque<ExrReader> files;
  for (const std::string& path : files_of_frame(input, aovs)) files.emplace_back(path, salvage);
  return files;
}

View read_view(std::deque<ExrReader> opened, const std::vector<LayerRequest>& aovs,
               const InputOptions& options, const CameraOptions& camera,
               const std::vector<Role>& unused) {
  View view;
  Stopwatch watch;
  view.files = std::move(opened);
  std::vector<const ExrReader*> files;
  for (const ExrReader& file : view.files) files.push_back(&file);
  view.layers = find_layers(files, aovs, options.part, unused, options.view);
  GBufferOptions reading = options.gbuffer;
  std::vector<std::string> warnings;
  const Plane<float> deep = take_depth_from_samples(
      view, options.view.empty() ? options.part : options.view, reading, warnings);
  require_position(view.layers, view.files.front(), options.view,
                   options.listed ? "" : " ('ssdo info' lists the layers)");
  try {
    view.gbuffer = read_gbuffer(files, view.layers, reading, &deep);
    view.read_ms = watch.lap();
    view.geometry =
        build_geometry(view.gbuffer, camera, view.files.front().path().string(), view.report);
  } catch (const Error& error) {
    throw with_hint(error, view, options.view);
  }
  view.gbuffer.warnings.insert(view.gbuffer.warnings.begin(), warnings.begin(), warnings.end());
  // From here on there is one position, one normal and one kind of pixel: those of the geometry.
  view.gbuffer.position = {};  // on their own lines: an assignment of a plane keeps memory
  view.gbuffer.normal = {};
  view.gbuffer.depth = {};
  view.gbuffer.valid = {};
  return view;
}

}  // namespace ssdo
