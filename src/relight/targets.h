// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "color/color.h"
#include "color/compose.h"
#include "io/exr/exr_writer.h"
#include "io/files/safe_file.h"
#include "relight/job.h"

namespace ssdo {

/// What goes into an EXR, and what holds the pixels.
struct ExrContents {
  std::vector<NamedChannels> products;
  std::vector<Plane<float>> laid;  ///< planes of a view that shares its part with a larger one
  ExrOutput output;
};

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
struct ViewOutput {
  const RelightJob& job;
  const Scene& scene;
  const Plan& plan;
  const Products& products;
  const DisplayTransform* display;
};

/// Writes the targets of the jobs, which are the same for all `views`.
Written write_targets(const std::vector<ViewOutput>& views,
                      const std::function<void(double)>& on_progress);

}  // namespace ssdo
