// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>

namespace ssdo {

/// Depth that a thing is guessed to have, over the width that the frame shows.
inline constexpr float kDepthOfWidth = 0.85f;

/// Lines to both sides of a pixel over which the width of what it shows is averaged.
inline constexpr int kWidthReach = 16;

/// The depth of a run that is cut where the known rows of a frame end.
constexpr float kUnknown = -1;

/// A run of pixels, and the guess that what it shows is kDepthOfWidth times as deep as it is wide.
/// Boxes and posts are as deep as they are wide, a round thing is pi / 4 of that in the mean. With
/// factors of 1, 0.9, 0.85, 0.8 and 0.7, means of bitmask over five scenes of Cycles, before
/// shown_depth() limited them: RMSE of ao 0.0641, 0.0645, 0.0648, 0.0653 and 0.0669 at a small
/// radius, 0.0832, 0.0824, 0.0822, 0.0822 and 0.0829 at a large one, 0.1223, 0.1210, 0.1206, 0.1202
/// and 0.1198 without one; relative error of direct light 0.288, 0.284, 0.283, 0.281 and 0.279, of
/// bounce 0.540, 0.535, 0.532, 0.530 and 0.525. What a ball on the ground lights or leaves dark is
/// wrong in 0.7 % of the frame's pixels with 1, in 2.6 % with 0.85 and in 4.7 % with 0.7.
struct WidthOfRun {
  float depth = std::numeric_limits<float>::infinity();  ///< infinite: no end is seen; or kUnknown
  int pixels = 0;
  bool is_whole = false;  ///< both ends are seen
  float shown = 0;        ///< the part of `depth` that the sides in view show, of a whole run
};

/// Runs across one thing differ in length by about one pixel; from this difference on, two runs
/// belong to different things.
constexpr int kOtherWidth = 4;

/// A thing is at most so many times as wide as a part of it that is seen beside something nearer.
constexpr int kMostHidden = 4;

/// How surely two runs beside each other are of one width, 0..1.
inline float likeness(const WidthOfRun& own, const WidthOfRun& beside) {
  const int more = beside.pixels - own.pixels, less = beside.is_whole ? -more : 0;
  const float of_less = float(kOtherWidth - less) / (kOtherWidth - 1),
              of_more = own.is_whole && beside.is_whole
                            ? float(kOtherWidth - more) / (kOtherWidth - 1)
                            : 2 - 2 * float(more) / float((kMostHidden - 1) * own.pixels);
  return std::min({1.0f, of_less, of_more});
}

}  // namespace ssdo
