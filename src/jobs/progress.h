// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "jobs/run_options.h"

namespace ssdo {

/// Shows how far the job is: as a bar on standard error if that is a terminal, and as flushed lines
/// on standard output, where schedulers read them.
class ProgressLine {
 public:
  ProgressLine(ProgressStyle style, bool quiet);
  ~ProgressLine();

  /// `done` is the share of the whole job, 0..1, and `what` the current work. Less than was told
  /// before is not shown.
  void tell(double done, const std::string& what);

  /// Clears the bar, so that other text can be written.
  void clear();

 private:
  void draw(int percent, const std::string& what);

  ProgressStyle style_;
  bool bar_ = false, drawn_ = false;
  int last_percent_ = -1;
};

}  // namespace ssdo
