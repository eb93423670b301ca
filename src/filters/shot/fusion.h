// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "filters/shot/findings.h"
#include "filters/shot/other_findings.h"
#include "filters/shot/point_tracker.h"
#include "math/uninitialized.h"
#include "scene/light/light.h"

namespace ssdo {

struct RowOfPixels;
struct ContributingFrame;

/// The mean of what a frame and others of its shot have found of the same points; see fusion.cpp.
/// The same bits for the same frames in the same order.
class Fusion {
 public:
  /// `light` is in the camera space of the frame. Both have to outlive this.
  Fusion(const Findings& own, const Light& light);

  /// Adds all other frames at once, or some at a time, in the order of PointTracker::reach(), which
  /// also says how long they have to live. `are_last`: no others follow. Frames without a world, or
  /// with other sources, add nothing; frames that lack layers add nothing to what is made from
  /// these layers.
  void add(const std::vector<OtherFindings>& others, bool are_last);

  /// Fills the planes of `products` that take_findings() has left empty. `geometry` is that of the
  /// frame. Nothing can be added after that.
  void finish(const Geometry& geometry, Products& products);

 private:
  struct Scratch;

  static void add_frame(const ContributingFrame& frame, const RowOfPixels& row, Scratch& scratch);

  const Findings& own_;
  const Light& light_;
  PointTracker followed_;
  std::vector<int> kinds_;                               ///< of light, by channel
  std::vector<std::vector<int>> groups_;                 ///< those of each group of channels
  std::vector<float, Uninitialized<float>> sums_, all_;  ///< of changes, and of weights
};

}  // namespace ssdo
