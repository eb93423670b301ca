// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "relight/frame.h"

namespace ssdo {

/// What is expected to stay the same from one frame of a sequence to the next.
struct FrameLooks {
  int number = 0;
  std::array<std::string, kRoleCount> layers;  ///< by role, without their view; empty: none
  int width = 0, height = 0;                   ///< of the display window
  std::string normal_space;                    ///< empty: there are no normals to use
  std::vector<std::string> also;               ///< files of --also
  std::vector<bool> fits;                      ///< which of these are views that are used
};

FrameLooks looks_of(const Frame& frame, const FrameFiles& files, int number);

/// A line for each layer that comes, goes or has another name, for another size, for normals of
/// another space, and for a view of --also that is used in one of them only.
std::vector<std::string> changes(const FrameLooks& before, const FrameLooks& now);

/// What differs between the views of a stereo frame, as warnings. Errors: ExitCode::layer where
/// both are made from the same channels.
std::vector<std::string> compare_views(const Frame& left, const Frame& right);

}  // namespace ssdo
