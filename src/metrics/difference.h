// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "math/plane.h"

namespace ssdo {

/// How far values are from others.
struct Difference {
  std::size_t count = 0;
  double rmse = 0, bias = 0;    ///< of a - b
  double largest = 0, p99 = 0;  ///< of |a - b|; 99 % of all are at most p99
  double mean_b = 0;
  double peak = 1;               ///< largest |a| or |b|, at least 1
  double relative_rmse() const;  ///< to the mean of b
  double psnr() const;           ///< decibels, to the peak; infinite without any error

  /// The difference of these numbers and more; without a percentile.
  void add(const Difference& more);
};

/// The difference of two lists of finite numbers of the same length.
Difference measure_difference(const std::vector<float>& a, const std::vector<float>& b);

/// Channels over a window.
struct Channels {
  Window window;
  std::vector<Plane<float>> planes;

  /// Channel `c` at a pixel in the coordinates of the window; a single channel stands for each.
  float at(std::size_t c, int x, int y) const {
    return planes[planes.size() == 1 ? 0 : c](x - window.x0, y - window.y0);
  }
};

/// Pixels inside the mask that are left out of a comparison.
struct LeftOut {
  std::size_t in_both = 0;  ///< not finite in both pictures, as a depth is beyond all surfaces
  std::size_t in_one = 0;   ///< finite in one picture and not in the other
  std::size_t outside = 0;  ///< in the window of one picture only

  /// The pixels that one picture shows and the other does not.
  std::size_t without_counterpart() const { return in_one + outside; }
  std::size_t all() const { return in_both + without_counterpart(); }
};

/// The difference of two pictures over the pixels where both have finite values.
struct ChannelsDifference {
  Difference figures;
  std::size_t pixels = 0;  ///< that count
  LeftOut left_out;
  std::vector<Plane<float>> a_minus_b;  ///< over the window of A; 0 where a pixel does not count

  /// The ratio of pixels without a counterpart to those that at least one picture shows.
  double invalid_share() const;
};

/// `counts(x, y)` says which pixels count, in the coordinates of the windows. Channels pair in
/// order; one channel is compared with each of several, and other numbers must be equal.
ChannelsDifference compare_channels(const Channels& a, const Channels& b,
                                    const std::function<bool(int x, int y)>& counts);

}  // namespace ssdo
