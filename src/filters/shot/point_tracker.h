// SPDX-License-Identifier: Apache-2.0
//
// Points that move, followed through the frames of a shot by their motion layers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/other_findings.h"
#include "filters/shot/tracked_point.h"

namespace ssdo {

/// Points of a frame that move, in the frames before and after it; see point_tracker.cpp. From one
/// call of reach() to the next, the points are kept, but of the frames only the last one.
class PointTracker {
 public:
  /// `own` has to outlive it.
  explicit PointTracker(const Findings& own);

  /// The frames that row() goes through from now on: those before the frame, from the nearest on,
  /// then those after it, likewise. These may come in several calls; then they, and the last of the
  /// call before, have to live until the next.
  void reach(const std::vector<OtherFindings>& others);

  /// Sets the points of row `y` in each of the others, in the order of x; once for each row. Rows
  /// may be asked for at the same time. `are_last`: reach() is not called again.
  void row(int y, bool are_last, std::vector<std::vector<TrackedPoint>>& points);

 private:
  /// Two frames of which one follows the other in time.
  struct Link {
    const KeptSurfaces *before, *after;
    const ObjectMotion* motion;  ///< of `after`
    CameraChange back, forth;
  };
  /// A frame and the link through which it is reached.
  struct NeighbourFrame {
    std::size_t other;
    bool is_before;  ///< earlier than the own frame
    bool is_next;    ///< adjacent to the own frame
    Link link;
    CameraChange from_own;
  };
  /// A point in a frame, and the pixels around it that show its surface.
  struct TrackedPosition {
    glm::dvec2 at;               ///< pixels of the display window
    glm::dvec2 aside;            ///< `at` less the weighted mean of these pixels
    glm::vec3 position, normal;  ///< camera space
    float rounding;
    std::int32_t pixel;  ///< as in ReprojectedPoints
    float weight[4];
  };
  /// A point on its way.
  struct Track {
    int x;  ///< where it starts
    double speed;
    TrackedPosition last;
    glm::dvec2 step;  ///< last motion apart from the cameras, on the way to frames after
  };

  TrackedPosition position_of(std::size_t pixel) const;
  void mark_origins(const Link& link);
  std::vector<Track> tracks_of(int y, const NeighbourFrame& next) const;
  bool go_back(const Link& link, Track& track) const;
  bool go_forth(const Link& link, Track& track) const;
  void add(int y, const Track& track, const NeighbourFrame& beside,
           std::vector<TrackedPoint>& points) const;
  static bool find(const CameraChange& change, const KeptSurfaces& to, const TrackedPosition& from,
                   const glm::dvec2& step, TrackedPosition& found);
  static glm::dvec2 motion_at(const Link& link, const TrackedPosition& spot);

  const Findings& own_;
  const Findings* last_;  ///< the last frame reached; null: the chain is broken
  int last_away_ = 0;
  std::vector<NeighbourFrame> neighbours_;  ///< of the last call of reach()
  std::vector<std::vector<Track>> tracks_;  ///< by row; empty: none have begun
  /// By pixel of the frame: a pixel of the frame after that moves and was there; -1: none. Empty:
  /// nothing moves.
  std::vector<std::int32_t> came_to_;
};

}  // namespace ssdo
