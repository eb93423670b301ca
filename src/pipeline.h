// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "estimate.h"
#include "estimators/estimator.h"
#include "frame.h"
#include "io/safe_file.h"
#include "options.h"

namespace ssdo {

/// A file to write: every product of the plan, or one.
struct Target {
  std::string path;
  std::optional<std::string> product;  ///< --save
};

/// How colours become those of a display, where a target is a picture that shows colours.
/// Errors: those of DisplayTransform.
std::optional<DisplayTransform> make_display(const Options& options, const Frame& frame,
                                             const std::vector<Target>& targets);

/// The main job on a frame that has been prepared: estimate, filter, compose, colour, write.
/// All targets appear, or none. `told` hears how far it is, 0..1. `before` is what a temporal plan
/// takes from the frame before, if there is one.
struct Relit {
  std::size_t clamped_values = 0;  ///< beyond the range of half
  std::vector<std::string> notes;  ///< how colours were transformed, and what the error is
  std::vector<std::string> warnings;
  History history;                  ///< of a temporal plan, for the next frame; without a geometry
  std::optional<ErrorFound> error;  ///< where the plan asks for it
};
Relit relight(const Options& options, Frame& frame, const std::vector<Target>& targets,
              const OutputPolicy& policy, const std::function<void(double)>& told,
              const std::optional<History>& before);

/// Writes what the targets show of `products` to temporaries, for the caller to commit. `display`
/// may be null where no target is a picture of a colour. Adds to the times of the frame.
std::vector<std::unique_ptr<SafeFile>> write_targets(
    const Options& options, Frame& frame, const std::vector<Target>& targets,
    const OutputPolicy& policy, const Products& products, const DisplayTransform* display,
    const std::function<void(double)>& told, Relit& relit);

}  // namespace ssdo
