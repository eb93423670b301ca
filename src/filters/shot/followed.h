// SPDX-License-Identifier: Apache-2.0
//
// Points that move, followed through the frames of a shot by their motion layers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/followed_point.h"
#include "filters/shot/other_findings.h"

namespace ssdo {

/// Points of a frame that move, in the frames before and after it; see followed.cpp. From one call
/// of reach() to the next, the points are kept, but of the frames only the last one.
class Followed {
 public:
  /// `own` has to outlive it.
  explicit Followed(const Findings& own);

  /// The frames that row() goes through from now on: those before the frame, from the nearest on,
  /// then those after it, likewise. These may come in several calls; then they, and the last of the
  /// call before, have to live until the next.
  void reach(const std::vector<OtherFindings>& others);

  /// Sets the points of row `y` in each of the others, in the order of x; once for each row. Rows
  /// may be asked for at the same time. `are_last`: reach() is not called again.
  void row(int y, bool are_last, std::vector<std::vector<FollowedPoint>>& points);

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
    bool is_before;  ///< earlier than the own frame
    bool is_next;    ///< adjacent to the own frame
    Link link;
    CameraChange from_own;
  };
  /// A point in a frame, and the pixels around it that show its surface.
  struct Spot {
    glm::dvec2 at;               ///< pixels of the display window
    glm::dvec2 aside;            ///< `at` less the weighted mean of these pixels
    glm::vec3 position, normal;  ///< camera space
    float rounding;
    std::int32_t pixel;  ///< as in Sights
    float weight[4];
  };
  /// A point on its way.
  struct Walk {
    int x;  ///< where it starts
    double speed;
    Spot last;
    glm::dvec2 step;  ///< last motion apart from the cameras, on the way to frames after
  };

  Spot spot_of(std::size_t pixel) const;
  void mark_origins(const Link& link);
  std::vector<Walk> walks_of(int y, const Beside& next) const;
  bool go_back(const Link& link, Walk& walk) const;
  bool go_forth(const Link& link, Walk& walk) const;
  void add(int y, const Walk& walk, const Beside& beside, std::vector<FollowedPoint>& points) const;
  static bool find(const CameraChange& change, const KeptSurfaces& to, const Spot& from,
                   const glm::dvec2& step, Spot& found);
  static glm::dvec2 motion_at(const Link& link, const Spot& spot);

  const Findings& own_;
  const Findings* last_;  ///< the last frame reached; null: the chain is broken
  int last_away_ = 0;
  std::vector<Beside> besides_;           ///< of the last call of reach()
  std::vector<std::vector<Walk>> walks_;  ///< by row; empty: none have begun
  /// By pixel of the frame: a pixel of the frame after that moves and was there; -1: none. Empty:
  /// nothing moves.
  std::vector<std::int32_t> came_to_;
};

}  // namespace ssdo
