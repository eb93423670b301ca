// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "jobs/sequence/frame_ranges.h"

namespace ssdo {

/// Lines of a frame, to be printed.
struct Line {
  std::string text;          ///< empty: nothing is printed, and the warning counts all the same
  std::string warning = {};  ///< what it warns of, where other frames may say the same; else empty
  bool repeats = false;      ///< printed for every frame that has it
};

/// The warnings of a run: each kind is printed where it first appears, and at the end with the
/// frames that it holds for. Two warnings are of one kind if they differ by their numbers and by
/// the number of the frame in the names of files.
class RepeatedWarnings {
 public:
  /// Takes note of a warning of frame `number`, the `place`th of the run, frames in their order.
  /// Returns whether it is to be printed: no earlier frame has it.
  bool add(std::size_t place, int number, const std::string& warning);

  /// A line for each kind that several frames have: "WARNING: frames 3 to 24".
  std::vector<std::string> summary() const;

 private:
  struct Kind {
    std::string first;    ///< its wording where it first appears
    bool varies = false;  ///< in its numbers
    FramesByPlace frames = {};
  };
  std::map<std::string, std::size_t> index_;
  std::vector<Kind> kinds_;  ///< in the order of their first appearance
};

}  // namespace ssdo
