// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <vector>

#include "math/plane.h"
#include "metrics/difference.h"
#include "scene/geometry.h"

namespace ssdo {

/// A point of a still surface that two frames of a shot show, in the pixels of their display
/// windows.
struct SharedPoint {
  int x, y;            ///< the pixel of the present frame
  int left, top;       ///< the upper left of the four pixels of the frame before that are around it
  float across, down;  ///< from the centre of that pixel, 0..1; 0: on its column, its row
  bool at_border;      ///< within kBorder pixels of the border of one of both pictures
};

constexpr int kBorder = 16;

/// The points of still surfaces that both of two frames show; see flicker.cpp.
struct SharedPoints {
  std::vector<SharedPoint> points;  ///< row by row
  /// The motion layer contradicts the cameras at most of the points, and was not used.
  bool motion_is_wrong = false;
};

/// Both frames must have `world_known`. `motion` leads from each pixel of `now` to the place of its
/// point in the frame `before`, in pixels, x right and y down; if empty, only P tells what moves.
/// Points are looked for at the pixels of `now` where `counts(x, y)`, in display coordinates.
SharedPoints find_shared_points(const Geometry& before, const Geometry& now,
                                const Plane<glm::vec2>& motion,
                                const std::function<bool(int x, int y)>& counts);

/// Changes that come frame by frame: their RMS, and the 99th percentile of their size.
class Changes {
 public:
  void add(double change);
  void add(const Changes& more);

  std::size_t count() const { return count_; }
  double rms() const;  ///< not a number where there is none
  double p99() const;  ///< at most 0.4 % above the exact one

 private:
  std::size_t count_ = 0;
  double squares_ = 0;
  std::vector<std::uint32_t> of_size_;  ///< how many there are, by the leading bits of a float
};

/// What is told of flicker; not a number where there are no points.
struct FlickerFigures {
  std::size_t points = 0;
  double rms = 0, p99 = 0;  ///< of the change of each channel at each point
  double border_rms = 0;    ///< of the points at the border
  double mean = 0;          ///< of the layer at the points
};

/// How much a layer changes at points that two frames show.
struct Flicker {
  std::size_t points = 0;  ///< where all of the layer's pixels are finite
  Changes all, border;     ///< of each channel at each point
  double sum = 0;          ///< of all channels of the present frame

  FlickerFigures figures() const;
  void add(const Flicker& more);
};

/// The change from `before` to `now`, which hold the same number of channels.
Flicker measure_flicker(const SharedPoints& shared, const Channels& before, const Channels& now);

/// A - B as channels, paired as in compare_channels(); not a number where one of both is not
/// finite. Over the window that both have.
Channels subtract(const Channels& a, const Channels& b);

}  // namespace ssdo
