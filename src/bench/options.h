// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "relight/frame.h"

namespace ssdo {

/// The largest error that is wanted of a product.
struct WantedError {
  std::string product;  ///< empty: the first that is measured
  double error = 0;
};

/// Options of `ssdo bench`, in addition to those of the main job.
struct BenchOptions {
  std::vector<std::string> methods;  ///< empty: all
  std::vector<std::string> truths;   ///< [PRODUCT=]FILE:LAYER
  std::vector<std::string> reports;  ///< files that end in .html, .csv or .json
  std::vector<WantedError> wants;

  /// Arguments of the main job that the command line gave, option by option, for the commands that
  /// it recommends.
  std::vector<std::vector<std::string>> carried;
};

/// One frame to measure on.
struct BenchJob {
  std::string input;          ///< file of the frame
  const FrameOptions& frame;  ///< of the main job, for all settings
  const BenchOptions& options;
};

}  // namespace ssdo
