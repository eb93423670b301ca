// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "filters/shot/fusion.h"
#include "relight/job.h"
#include "relight/lighting.h"
#include "scene/other_views/other_pictures.h"

namespace ssdo {

/// Reads the files of a frame and decides what to do with them: read, layers, gbuffer, camera,
/// geometry, plan. `files` has the place of those that `options` names; `pictures` are those of
/// the run. `number` is the frame's in its sequence: a temporal plan has another sampling pattern
/// in every frame. Errors: those of the stages; ExitCode::input for a file of --also that is
/// missing or no EXR.
Frame prepare_frame(const FrameOptions& options, const Lighting& lighting, OtherPictures& pictures,
                    const FrameFiles& files, int number = 0);

/// Estimates and filters. `scene` is moved out of job.frame. `on_progress` is called with the
/// share that is done, 0..1. With a plan for a shot, relight_in_shot() has to follow. Errors: those
/// of the stages.
Relit relight(const RelightJob& job, Scene scene, const std::function<void(double)>& on_progress,
              const TemporalInput& temporal);

/// What a frame has found, for all frames of its shot, itself included. Leaves `relit` without the
/// planes.
Findings take_findings(Relit& relit);

/// The rest of relight() for a frame in a shot, once `fusion` has what it and the frames around it
/// have found, in the order of the shot.
void relight_in_shot(Fusion& fusion, Relit& relit);

/// The last stages of a frame: compose, colour, write. `views` are the views of one frame, usually
/// a single one. All targets appear, or none. Adds to the times and clamped values of the first
/// view. Errors: those of the stages.
void write_outputs(const std::vector<RelitFrame>& views,
                   const std::function<void(double)>& on_progress);

}  // namespace ssdo
