// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "io/exr/deep_reader.h"

namespace ssdo {

/// A stretch of a view ray that light does not pass, by the depths of its ends; `back` equals
/// `front` where only a surface is known.
struct RaySolid {
  float front = 0, back = 0;
};

/// The solids of one ray, near to far, from the samples of a pixel in any order; see
/// ray_solids.cpp. Samples that are not finite, without alpha, at a depth of 0 or less or of `far`
/// or more are left out.
class RaySolids {
 public:
  explicit RaySolids(float far) : far_(far) {}

  /// Takes samples of one more deep image.
  void add(std::span<const DeepSample> samples);

  /// The solids of all samples since the last call, which begin at most `most` in number.
  const std::vector<RaySolid>& find(std::size_t most);

 private:
  struct Event {
    float depth;
    int kind;  ///< of what happens there, in this order: a medium ends, a surface, one begins
    double optical_depth;  ///< of the surface, or of the medium per unit of depth
  };

  void clear();
  void make_events();
  RaySolid solid_from(float front, bool in_medium);

  float far_;
  std::vector<DeepSample> samples_;
  std::vector<Event> events_;
  std::vector<RaySolid> solids_;
};

}  // namespace ssdo
