// SPDX-License-Identifier: Apache-2.0
#include "scene/view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "error.h"
#include "scene/build_geometry.h"
#include "scene/camera/position_check.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/gbuffer/depth_check.h"
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
  const std::string hint = hint_at(Role::position, group_channels(view.files.front(), 0, eye));
  return hint.empty() ? error : Error(error.code, fmt::format("{}; {}", error.what(), hint));
}

/// What a view is read from, and how.
struct Reading {
  const std::vector<const ExrReader*>& files;
  GBufferOptions options;
  const CameraOptions& camera;
  const Plane<float>& deep;
};

/// Refuses a P that no camera has seen. `camera` is the one that was found, if any.
void check_positions(const View& view, const Camera* camera) {
  const auto& layer = view.layers[Role::position];
  if (!layer) return;
  const std::string fault = find_fault_of_positions(view.gbuffer, camera);
  if (fault.empty()) return;
  throw Error(ExitCode::layer, fmt::format("{}: position '{}' {}",
                                           view.files[std::size_t(layer->file)].path().string(),
                                           layer->name, fault));
}

/// The camera of P, in the pixels of the G-buffer.
Camera camera_of_positions(const View& view) {
  return to_grid(view.report.placement.position_camera, view.gbuffer.grid);
}

/// Layers that were never written, which are 0 everywhere, are not used of any part of the frame.
/// The G-buffer has left out such an alpha.
void leave_out_unwritten_layers(View& view) {
  GBuffer& g = view.gbuffer;
  const auto leave_out = [&](Role role, std::string_view where) {
    std::optional<Layer>& layer = view.layers[role];
    g.warnings.push_back(fmt::format("{} '{}' is 0 everywhere{}, and is left out", role_name(role),
                                     layer->name.empty() ? layer->channels[0] : layer->name,
                                     where));
    layer.reset();
  };
  if (view.layers[Role::alpha] && g.alpha.empty())
    leave_out(Role::alpha, ", also where other layers show surfaces");
  const auto is_0 = [](const glm::vec3& n) { return n == glm::vec3(0); };
  const bool shows = std::ranges::find(g.valid.pixels, 1) != g.valid.pixels.end();
  if (view.layers[Role::normal] && shows && std::ranges::all_of(g.normal.pixels, is_0)) {
    g.normal = {};
    leave_out(Role::normal, "");
  }
}

/// Fills the G-buffer and the geometry.
void read_surfaces(const Reading& reading, View& view) {
  Stopwatch watch;
  view.gbuffer = read_gbuffer(reading.files, view.layers, reading.options, &reading.deep);
  view.read_ms += watch.lap();
  leave_out_unwritten_layers(view);
  view.report = {};
  const std::string file = view.files.front().path().string();
  try {
    view.geometry = build_geometry(view.gbuffer, reading.camera, file, view.report);
  } catch (const Error&) {
    check_positions(view, nullptr);
    throw;
  }
  if (view.report.placement.median_depth <= 0) return;
  const Camera camera = camera_of_positions(view);
  check_positions(view, &camera);
}

/// Whether the camera of P is known well enough to hold a depth to it.
bool knows_camera_of_positions(const View& view) {
  constexpr double kWell = 0.005;  // of the diagonal of the picture
  const Window& window = view.gbuffer.window;
  const auto& residual = view.report.residual;
  return view.report.placement.median_depth > 0 && residual &&
         residual->median_px < kWell * std::hypot(window.width(), window.height());
}

/// The same without a depth that contradicts the camera of P. A wrong depth may take so many
/// surfaces for background that no camera is found: then there is one without it.
void read_surfaces_by_right_depth(Reading reading, View& view) {
  std::exception_ptr failure;
  try {
    read_surfaces(reading, view);
  } catch (const Error&) {
    failure = std::current_exception();
  }
  const bool has_both = !view.gbuffer.depth.empty() && !view.gbuffer.position.empty();
  if (!has_both && failure) std::rethrow_exception(failure);
  if (!has_both || (!failure && !knows_camera_of_positions(view))) return;
  const auto instead = [&](const GBuffer& g) {
    return what_depth_is_instead(g, camera_of_positions(view));
  };
  std::string found = failure ? "" : instead(view.gbuffer);
  if (!failure && found.empty()) return;
  const GBuffer with_depth = std::move(view.gbuffer);
  reading.options.known = with_depth.encodings;
  reading.options.known->depth_is_wrong = true;
  reading.options.known->depth_of_position.reset();
  try {
    read_surfaces(reading, view);
    if (failure && knows_camera_of_positions(view)) found = instead(with_depth);
  } catch (const Error&) {
    if (!failure) throw;
  }
  if (found.empty()) std::rethrow_exception(failure);
  view.gbuffer.warnings.push_back(fmt::format("depth contradicts P ({}) and is left out", found));
}

}  // namespace

FrameFiles in_view(FrameFiles files, std::string_view view) {
  files.view = view;
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
  view.read_ms = watch.lap();
  try {
    read_surfaces_by_right_depth({files, reading, camera, deep}, view);
  } catch (const Error& error) {
    if (view.layers[Role::position] || error.code != ExitCode::layer) throw;
    throw with_hint(error, view, options.view);
  }
  if (view.deep) view.gbuffer.bad_pixels += broken_pixels(*view.deep);
  view.gbuffer.warnings.insert(view.gbuffer.warnings.begin(), warnings.begin(), warnings.end());
  // From here on there is one position, one normal and one kind of pixel: those of the geometry.
  view.gbuffer.position = {};  // on their own lines: an assignment of a plane keeps memory
  view.gbuffer.normal = {};
  view.gbuffer.depth = {};
  view.gbuffer.valid = {};
  return view;
}

}  // namespace ssdo
