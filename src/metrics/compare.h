// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "error.h"
#include "io/files/safe_file.h"

namespace ssdo {

/// What `ssdo compare` is asked for. Pictures are FILE or FILE:LAYER.
struct CompareOptions {
  std::string a, b;
  std::string mask;  ///< pixels where it is not 0 are compared; empty: all
  std::string diff;  ///< EXR for A - B; empty: none
  std::optional<double> fail_above;
  double max_invalid = 0;  ///< share of pixels without a counterpart that `fail_above` lets pass
  bool json = false;
  OutputPolicy policy;
};

/// What `ssdo compare` says, and whether it fails: ExitCode::failed where `fail_above` is given and
/// a layer's RMSE is above it, more than `max_invalid` of its pixels have no counterpart, or no
/// layers are named and one picture has a layer that the other lacks.
struct CompareReport {
  std::string text;
  ExitCode code = ExitCode::done;
};

/// Errors: ExitCode::input for a file that cannot be read, layer for a layer that does not exist or
/// has no counterpart, failed where no pixel is valid in both, output for `diff`.
CompareReport compare(const CompareOptions& options);

}  // namespace ssdo
