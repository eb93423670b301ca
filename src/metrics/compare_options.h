// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/files/safe_file.h"

namespace ssdo {

/// What `ssdo compare` is asked for. Pictures are FILE or FILE:LAYER; those of a sequence have a
/// frame pattern in FILE.
struct CompareOptions {
  std::string a, b;  ///< `b` may be empty where `points` are given
  std::string mask;  ///< pixels where it is not 0 are compared; empty: all
  std::string diff;  ///< EXR for A - B; empty: none
  std::optional<double> fail_above;
  double max_invalid = 0;  ///< share of pixels without a counterpart that `fail_above` lets pass
  bool json = false;
  OutputPolicy policy;
  std::optional<std::vector<int>> frames;  ///< of a sequence; not given: those that exist
  std::string points;  ///< pattern of the G-buffers that flicker is measured with; empty: none
  std::string camera;  ///< their camera as JSON; empty: found as for a frame
};

}  // namespace ssdo
