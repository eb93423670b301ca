// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/resources.h"
#include "frame.h"
#include "pipeline.h"

namespace ssdo {

/// What --stats writes: an array with one object per frame that was done; see man ssdo, STATISTICS.
class Statistics {
 public:
  void add(const Frame& frame, std::optional<int> number, const std::vector<Target>& targets,
           const Resources& resources, const Relit& relit);

  /// A log is replaced where an image would not be.
  static OutputPolicy policy(OutputPolicy of_images) {
    of_images.overwrite = true;
    return of_images;
  }

  /// Writes what has been added. Errors: ExitCode::output.
  void write(const std::string& path, const OutputPolicy& policy) const;

 private:
  nlohmann::json frames_ = nlohmann::json::array();
};

}  // namespace ssdo
