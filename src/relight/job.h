// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "io/files/safe_file.h"
#include "plan/outputs.h"
#include "relight/estimate.h"
#include "relight/frame.h"

namespace ssdo {

/// A frame that has been prepared, and the files to make from it. Views of a stereo file are frames
/// with the same files.
struct RelightJob {
  const FrameOptions& options;
  const Frame& frame;
  const std::vector<Target>& targets;
  OutputPolicy policy;
};

/// What came of a job.
struct Relit {
  Estimate found;     ///< of a frame in a shot, until it knows what the others have found
  Plan plan;          ///< of the frame, with the slices and steps that were needed
  Scene scene;        ///< as estimate() leaves it; of a frame in bands, its overview
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

/// A frame that has been relit.
struct RelitFrame {
  RelightJob job;
  Relit* relit;
};

}  // namespace ssdo
