// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/place_in_sequence.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "filters/continuity.h"

namespace ssdo {
namespace {

/// Motion vectors refer to the frame before in time, which may not be the one before in the list.
void place_motion(Frame& frame, TemporalInput& temporal, const FrameBefore& before) {
  if (!before.is_last_in_time) {
    temporal.motion = {};
    frame.history.push_back("motion is not used: it leads to a frame that is not the last");
    return;
  }
  const std::string& name = frame.layers[Role::motion]->name;
  frame.history.push_back(
      fmt::format("motion {} times {:g}, {:g}: pixels to the frame before, y up, where what moves "
                  "has its history",
                  name, before.motion_scale.x, before.motion_scale.y));
  if (contradicts_cameras(temporal.history->geometry, frame.scene.geometry, temporal.motion)) {
    frame.report.warnings.push_back(
        fmt::format("{} moves other ways than the cameras say; are its units pixels to the frame "
                    "before, y up? give --motion-scale",
                    name));
  }
}

}  // namespace

void place_in_sequence(Frame& frame, TemporalInput& temporal, const FrameBefore& before) {
  std::optional<History>& history = temporal.history;
  const Geometry& geometry = frame.scene.geometry;
  temporal.motion = std::move(frame.gbuffer.motion);
  std::string reason =
      !geometry.world_known ? "no history: the frame knows no world space"
      : history             ? "history of the frame before, where that shows the same surface"
                : "no history: the first frame, or the one before was not made by this run";
  if (history && history->geometry.world_known && geometry.world_known) {
    const Continuity found =
        compare_frames({history->geometry, history->albedo}, {geometry, frame.scene.senders.albedo},
                       temporal.motion);
    history->albedo = {};  // not needed any more
    if (found.is_cut()) {
      history.reset();
      reason = fmt::format(
          "no history: a cut, the frame before has {:.0f} % of the surfaces that both look at",
          100 * found.kept / found.met);
    }
  }
  frame.history.push_back(reason);
  if (history && !temporal.motion.empty()) place_motion(frame, temporal, before);
}

}  // namespace ssdo
