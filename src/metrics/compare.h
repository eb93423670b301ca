// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "error.h"
#include "metrics/compare_options.h"

namespace ssdo {

/// What `ssdo compare` says, and whether it fails: ExitCode::failed where `fail_above` is given and
/// a layer's RMSE is above it, more than `max_invalid` of its pixels have no counterpart, or no
/// layers are named and one picture has a layer that the other lacks. Of a sequence, the code of
/// the first frame that fails: its RMSE, or that it cannot be compared.
struct CompareReport {
  std::string text;
  ExitCode code = ExitCode::done;
};

/// Compares two pictures, or two sequences of pictures; measures the flicker of sequences where
/// `points` are given.
/// Errors: ExitCode::input for a file that cannot be read, layer for a layer that does not exist or
/// has no counterpart, failed where no pixel is valid in both, output for `diff`. Those of a frame
/// of a sequence stand in the report; usage for options that do not fit together.
CompareReport compare(const CompareOptions& options);

}  // namespace ssdo
