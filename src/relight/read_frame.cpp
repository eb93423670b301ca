// SPDX-License-Identifier: Apache-2.0
#include "relight/read_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "error.h"
#include "plan/composite_choice.h"
#include "scene/objects/read_object_masks.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Memory of a scene of casters without some objects, over that of the frame. Measured: 100 bytes a
/// pixel.
constexpr double kFurtherScene = 0.5;

/// How many more scenes of casters there are, each without some objects.
int further_scenes(const FrameFiles& files) {
  return int(!files.objects.no_cast.empty()) + int(!files.objects.shadow_of.empty()) +
         int(files.links.cast.size());
}

/// The roles that nothing asks for: a wrong layer for one is no reason to refuse a frame.
std::vector<Role> unused_roles(const FrameOptions& options, const FrameFiles& files) {
  std::vector<Role> unused;
  if (!wants_reflection(options.output, files.aovs)) unused.push_back(Role::roughness);
  if (!options.model.temporal && options.model.shot.count == 0) unused.push_back(Role::motion);
  return unused;
}

}  // namespace

bool wants_reflection(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  const auto is_mirrored = [](std::string_view product) {
    return product == "reflection" || product == "specular";
  };
  const auto is_specular = [](const LayerRequest& aov) { return aov.role == Role::specular; };
  return std::ranges::any_of(output.products, is_mirrored) ||
         contains(output.products, kAllProducts) ||
         std::ranges::any_of(output.saves, is_mirrored, &SaveRequest::product) ||
         (choose_compose(output, aovs) == Compose::occlude &&
          std::ranges::any_of(aovs, is_specular));
}

Frame read_frame(const FrameOptions& options, const FrameFiles& files, int lamps,
                 std::optional<DeepImage>& own) {
  Stopwatch watch;
  std::deque<ExrReader> opened = open_view(files.input, files.aovs, options.input.allow_partial);
  const double opening = watch.lap();
  InputOptions input = for_view(options.input, files);
  input.gbuffer.downsample = options.output.downsample;
  input.gbuffer.beauty = choose_compose(options.output, files.aovs) != Compose::relight ||
                         files.objects.keeps_pixels();
  input.gbuffer.most_pixels =
      std::size_t(double(most_pixels_in(options.memory, options.output, lamps)) /
                  (1 + kFurtherScene * further_scenes(files)));
  View view =
      read_view(std::move(opened), files.aovs, input, options.camera, unused_roles(options, files));
  if (view.geometry.camera.panorama) {
    throw Error(ExitCode::layer,
                fmt::format("{}: is a lat-long panorama, which shows no frame; give it with --also "
                            "to a frame of the same scene",
                            files.input));
  }
  Frame frame;
  frame.input = files.input;
  frame.view = files.view;
  frame.files = std::move(view.files);
  frame.objects = files.objects;
  frame.layers = std::move(view.layers);
  frame.gbuffer = std::move(view.gbuffer);
  frame.report = std::move(view.report);
  frame.scene = take_scene(frame.gbuffer, std::move(view.geometry));
  open_mattes(frame.objects, frame.files, options.input.allow_partial);
  std::vector<std::string> warnings;
  frame.gbuffer.masks = read_object_masks(frame.objects, frame.selections(warnings),
                                          frame.gbuffer.window, frame.gbuffer.grid);
  frame.warn(warnings);
  own = std::move(view.deep);
  frame.times.read = opening + view.read_ms;
  frame.times.prepare = watch.lap() - view.read_ms;
  return frame;
}

}  // namespace ssdo
