// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/options.h"
#include "bench/truth.h"
#include "io/files/run_files.h"
#include "relight/frame.h"

namespace ssdo {

/// What a bench measures: a frame with its truths, and the products whose error is measured.
struct Subject {
  Frame frame;                          ///< prepared with all that any method needs
  std::map<std::string, Truth> truths;  ///< by product
  std::vector<std::string> products;    ///< in the order of measured_products()
  std::size_t surface_pixels = 0;
};

/// Reads the frame and its truths, and refuses what cannot be measured or reported before any time
/// is spent. `inputs` are the files of the job that no report may replace; truths are added.
/// Errors: those of prepare_frame, read_truth and check_report_files; ExitCode::usage for products
/// that are not measured; layer for a truth that does not show the frame; failed for a frame
/// without a surface.
Subject read_subject(const BenchJob& job, std::vector<RunFile> inputs);

}  // namespace ssdo
