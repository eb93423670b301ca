// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "jobs/progress.h"
#include "jobs/run_options.h"
#include "jobs/sequence/repeated_warnings.h"

namespace ssdo {

/// What follows the name of a file, of a view where it is not empty: " (left): warning: WARNING".
std::string warning_of(const std::string& warning, const std::string& view);

/// What is to be printed about a frame, in its order.
class Messages {
 public:
  Messages(std::string input, const Verbosity& verbosity)
      : input_(std::move(input)), verbosity_(&verbosity) {}

  void add_text(std::string text) { lines_.push_back({std::move(text)}); }
  void add(const std::string& line);

  /// Warnings of a view of the frame, which is empty where there is one only. Those of `every`
  /// frame are no repetitions, whatever their wording.
  void warn(const std::vector<std::string>& warnings, const std::string& view, bool every = false);

  /// Warnings that are printed elsewhere, and count in the summary.
  void note(const std::vector<std::string>& warnings, const std::string& view);

  /// Takes all lines out.
  std::vector<Line> take();

 private:
  std::string input_;
  const Verbosity* verbosity_;
  std::vector<Line> lines_;
};

/// Prints on standard error, beside the progress of the run; if that is closed, the work goes on.
class Printer {
 public:
  explicit Printer(ProgressLine& progress) : progress_(progress) {}

  void print(const std::string& line);

  /// The messages of frame `number`, the `place`th of the run; a warning that an earlier frame has
  /// is left for the summary.
  void print(Messages& messages, std::size_t place, int number);

  /// A line for each warning that several frames have, with the frames that it holds for.
  std::vector<std::string> summary() const { return repeated_.summary(); }

 private:
  void print_text(const std::string& text);

  ProgressLine& progress_;
  RepeatedWarnings repeated_;
};

}  // namespace ssdo
