// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/options.h"

namespace ssdo {

/// Tells a person or a scheduler how far the job is. A bar on standard error if that is a terminal;
/// whole, flushed lines on standard output for the schedulers, which read there.
class ProgressLine {
 public:
  ProgressLine(ProgressStyle style, bool quiet);
  ~ProgressLine();

  /// `done` of the whole job, 0..1; `what` is being worked on.
  void tell(double done, const std::string& what);

  /// Takes the bar off the line, so that other text can be written.
  void clear();

 private:
  void draw(int percent, const std::string& what);

  ProgressStyle style_;
  bool bar_ = false, drawn_ = false;
  int last_percent_ = -1;
};

}  // namespace ssdo
