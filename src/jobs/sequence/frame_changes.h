// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "relight/frame.h"

namespace ssdo {

/// What is expected to stay the same from one frame of a sequence to the next, or to change little.
struct FrameTraits {
  int number = 0;
  std::string view;                            ///< of a stereo file; empty: there is one only
  std::array<std::string, kRoleCount> layers;  ///< by role, without their view; empty: none
  std::array<bool, kRoleCount> half{};         ///< whether these are stored as half
  int width = 0, height = 0;                   ///< of the display window
  std::string normal_space;                    ///< empty: there are no normals to use
  std::string depth_kind;                      ///< empty: there is no depth
  std::vector<std::string> also;               ///< files of --also
  std::vector<bool> fits;                      ///< which of these are views that are used
  Camera camera;                               ///< in the pixels of `display`
  Window display;
  float median_depth = 0;                      ///< of the surfaces; 0: there are none
  bool world_known = false;                    ///< where not, the camera has no place
  float radius = 0;                            ///< of the plan
  std::optional<float> radius_alone, guessed;  ///< see Plan and Frame
  bool in_shot = false;                        ///< Plan::shot
  std::string remedy;                          ///< see GuessedShare

  /// Names and values, for people, of what is known of all that should stay the same.
  std::vector<std::pair<std::string, std::string>> properties() const;
};

FrameTraits traits_of(const Frame& frame, const FrameFiles& files, int number);

/// A line for each layer that comes, goes, has another name or is stored in another type, for
/// another size, for normals of another space, and for a view of --also that is used in one of them
/// only.
std::vector<std::string> changes(const FrameTraits& before, const FrameTraits& now);

/// What differs between the views of a stereo frame, as warnings. Errors: ExitCode::layer where
/// both are made from the same channels.
std::vector<std::string> compare_views(const Frame& left, const Frame& right);

}  // namespace ssdo
