// SPDX-License-Identifier: Apache-2.0
//
// Points that move, followed by the motion layers through the frames of a shot.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filters/shot/followed_point.h"
#include "filters/shot/other_findings.h"

namespace ssdo {

/// Points of a frame in frames beside; see followed.cpp.
class Followed {
 public:
  /// `own` and `others` have to outlive it.
  Followed(const Findings& own, const std::vector<OtherFindings>& others);

  /// Sets the points of a row, by the others and in the order of x.
  void row(int y, std::vector<std::vector<FollowedPoint>>& points) const;

 private:
  /// Two frames of which one follows the other in time.
  struct Link {
    const KeptSurfaces *before, *after;
    const OwnMotion* motion;  ///< of `after`
    CameraChange back, forth;
  };
  /// A frame and the link through which it is reached.
  struct Beside {
    std::size_t other;
    Link link;
    CameraChange from_own;
  };
  struct Spot;

  Spot spot_of(std::size_t pixel) const;
  void link(const std::vector<OtherFindings>& others, int direction, std::vector<Beside>& reached);
  void mark_origins();
  void follow_back(int x, const Spot& start, std::vector<std::vector<FollowedPoint>>& points) const;
  void follow_forth(int x, const Spot& start, std::size_t from,
                    std::vector<std::vector<FollowedPoint>>& points) const;
  void add(int x, const Spot& start, const Spot& there, double speed, const Beside& beside,
           std::vector<FollowedPoint>& points) const;
  static bool find(const CameraChange& change, const KeptSurfaces& to, const Spot& from,
                   const glm::dvec2& at, Spot& found);
  static glm::dvec2 motion_at(const Link& link, const Spot& spot);

  const Findings& own_;
  std::vector<Beside> before_, after_;  ///< from the nearest on
  /// By pixel, one of the frame after that moves and was there; -1: there is none. Empty: nothing
  /// moves.
  std::vector<std::int32_t> came_to_;
};

}  // namespace ssdo
