// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "filters/shot/moved_weights.h"
#include "filters/shot/other_findings.h"
#include "filters/shot/shot_reprojection.h"
#include "scene/light/light.h"

namespace ssdo {

/// Another frame whose values enter the mean.
struct ContributingFrame {
  const Findings& findings;
  std::size_t other;  ///< its place among the others
  ShotReprojection reprojection;
  std::vector<std::uint16_t> arranged;                  ///< where it has other layers
  std::optional<MovedWeights> moved;                    ///< where something has moved
  std::vector<float> weights, weights_of_kinds, units;  ///< see fusion.cpp
};

/// The frames of `others` that know the world and have the sources of `own`. `light` is in the
/// camera space of the frame, `kinds` are those of light by channel.
std::vector<ContributingFrame> contributing_frames_of(const Findings& own,
                                                      const std::vector<OtherFindings>& others,
                                                      const Light& light,
                                                      const std::vector<int>& kinds);

}  // namespace ssdo
