// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "color/compose.h"
#include "estimate.h"
#include "frame.h"
#include "io/exr/exr_writer.h"
#include "io/safe_file.h"
#include "outputs.h"

namespace ssdo {

/// What goes into an EXR, and what holds the pixels.
struct ExrContents {
  std::vector<NamedChannels> products;
  std::vector<Plane<float>> laid;  ///< planes of a view that shares its part with a larger one
  ExrOutput output;
};

/// A frame that has been prepared, and the files to make from it. Views of a stereo file are frames
/// with the same files.
struct RelightJob {
  const FrameOptions& options;
  const Frame& frame;
  const std::vector<Target>& targets;
  OutputPolicy policy;
  std::function<void()> on_estimated = {};  ///< as estimate() calls it
};

/// What came of a job.
struct Relit {
  Plan plan;          ///< of the frame, with the slices and steps that were needed
  Products products;  ///< after the filter
  std::optional<DisplayTransform> display;  ///< where a target is a picture that shows colours
  StageTimes times;                         ///< of all stages up to here
  std::vector<std::unique_ptr<SafeFile>> written;  ///< in bands, in place of products
  std::size_t clamped_values = 0;                  ///< beyond the range of half
  std::optional<ErrorFound> error;                 ///< where the plan asks for it
  History history;                 ///< of a temporal plan, for the next frame; without a geometry
  std::vector<std::string> notes;  ///< how colours were transformed, and what the error is
  std::vector<std::string> warnings;
};

/// The main job up to its files: estimate and filter. `on_progress` is called with the share that
/// is done, 0..1. Errors: those of the stages.
Relit relight(const RelightJob& job, const std::function<void(double)>& on_progress,
              const Past& past);

/// A frame that has been relit.
struct RelitFrame {
  RelightJob job;
  Relit* relit;
};

/// The rest of it: compose, colour, write. `views` are those of one frame, usually one. All targets
/// appear, or none. Adds to the times and clamped values of the first. Errors: those of the stages.
void write_outputs(const std::vector<RelitFrame>& views,
                   const std::function<void(double)>& on_progress);

/// How colours become those of a display, where a target is a picture that shows colours. Where a
/// target is a picture, loads what writes it.
/// Errors: those of DisplayTransform and load_image_codec(); ExitCode::input where the picture does
/// not fit into memory.
std::optional<DisplayTransform> make_display(const RelightJob& job);

/// What an EXR of a job holds of `results`, which have to stay. Channels are named as those of the
/// frame's view are.
ExrContents exr_contents(const RelightJob& job, const Plan& plan, const Target& target,
                         const Results& results);

/// Files that have been written but do not have their names yet: the caller commits them.
struct Written {
  std::vector<std::unique_ptr<SafeFile>> files;
  std::size_t clamped_values = 0;
  double compose_ms = 0, write_ms = 0;
};

/// What targets show of a frame. `display` may be null where no target is a picture of a colour.
struct Shown {
  const RelightJob& job;
  const Plan& plan;
  const Products& products;
  const DisplayTransform* display;
};

/// Writes the targets of the jobs, which are the same for all `views`.
Written write_targets(const std::vector<Shown>& views,
                      const std::function<void(double)>& on_progress);

}  // namespace ssdo
