// SPDX-License-Identifier: Apache-2.0
#include "cli/place_in_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "band_plan.h"
#include "cli/jobs.h"
#include "filters/continuity.h"
#include "scene/camera/find_camera.h"

namespace ssdo {
namespace {

/// Motion vectors refer to the frame before in time, which may not be the one before in the list.
void place_motion(Frame& frame, Past& past, const FrameBefore& before) {
  if (!before.is_last_in_time) {
    past.motion = {};
    frame.history.push_back("motion is not used: it leads to a frame that is not the last");
    return;
  }
  const std::string& name = frame.layers[Role::motion]->name;
  frame.history.push_back(
      fmt::format("motion {} times {:g}, {:g}: pixels to the frame before, y up, where what moves "
                  "has its history",
                  name, before.motion_scale.x, before.motion_scale.y));
  if (contradicts_cameras(past.history->geometry, frame.scene.geometry, past.motion)) {
    frame.report.warnings.push_back(
        fmt::format("{} moves other ways than the cameras say; are its units pixels to the frame "
                    "before, y up? give --motion-scale",
                    name));
  }
}

/// How far a frame is looked for whose P tells its camera.
constexpr int kMostFramesAway = 8;

/// The horizontal field of view of another frame, in degrees, as its own P has it.
std::optional<double> lens_of(const Options& options, const FrameFiles& files) try {
  const std::vector<Role> unused = {Role::albedo,   Role::beauty,    Role::radiance, Role::ambient,
                                    Role::specular, Role::roughness, Role::motion};
  std::vector<LayerRequest> aovs = files.aovs;
  std::erase_if(aovs, [&](const LayerRequest& request) {
    return std::ranges::find(unused, request.role) != unused.end();
  });
  InputOptions input = for_view(options.input, files);
  input.gbuffer.most_pixels = most_pixels_in(options.memory);
  const View view = read_view(open_view(files.input, aovs, input.allow_partial), aovs, input,
                              options.camera, unused);
  const Camera& camera = view.report.placement.camera;
  if (camera.orthographic || camera.panorama || view.report.placement.median_depth <= 0)
    return std::nullopt;
  return camera.hfov_degrees(view.gbuffer.display_of_file().width());
} catch (const Error&) {
  return std::nullopt;  // a frame that cannot be read tells nothing
}

}  // namespace

Frame prepare_in_sequence(const Options& options, const Lighting& light, FurtherPictures& pictures,
                          const FrameFiles& files, std::optional<int> number) try {
  return prepare_frame(options, light, pictures, files, number.value_or(0));
} catch (const UndeterminedCamera&) {
  if (!number) throw;
  for (int i = 2; i < 2 * (kMostFramesAway + 1); ++i) {
    const std::int64_t other = std::int64_t(*number) + (i % 2 == 0 ? -i / 2 : i / 2);
    if (std::int64_t(int(other)) != other) continue;
    FrameFiles beside = in_view(files_at(options, int(other)), files.view);
    std::error_code ignored;
    if (!std::filesystem::exists(beside.input, ignored)) continue;
    FrameOptions with_lens = options;
    with_lens.camera.fov = lens_of(options, beside);
    if (!with_lens.camera.fov) continue;
    try {
      Frame frame = prepare_frame(with_lens, light, pictures, files, *number);
      frame.report.camera_source = "fitted from P with the lens of " + beside.input;
      return frame;
    } catch (const Error&) {
      break;
    }
  }
  throw;
}

void place_in_sequence(Frame& frame, Past& past, const FrameBefore& before) {
  std::optional<History>& history = past.history;
  const Geometry& geometry = frame.scene.geometry;
  past.motion = std::move(frame.gbuffer.motion);
  std::string reason =
      !geometry.world_known ? "no history: the frame knows no world space"
      : history             ? "history of the frame before, where that shows the same surface"
                : "no history: the first frame, or the one before was not made by this run";
  if (history && history->geometry.world_known && geometry.world_known) {
    const Continuity found = compare_frames({history->geometry, history->albedo},
                                            {geometry, frame.scene.senders.albedo}, past.motion);
    history->albedo = {};  // not needed any more
    if (found.is_cut()) {
      history.reset();
      reason = fmt::format(
          "no history: a cut, the frame before has {:.0f} % of the surfaces that both look at",
          100 * found.kept / found.met);
    }
  }
  frame.history.push_back(reason);
  if (history && !past.motion.empty()) place_motion(frame, past, before);
}

}  // namespace ssdo
