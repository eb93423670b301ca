// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "error.h"
#include "io/safe_file.h"
#include "math/plane.h"

namespace ssdo {

/// What `ssdo compare` is asked for. Pictures are FILE or FILE:LAYER.
struct CompareOptions {
  std::string a, b;
  std::string mask;  ///< pixels where it is not 0 are compared; empty: all
  std::string diff;  ///< EXR for A - B; empty: none
  std::optional<double> fail_above;
  bool json = false;
  OutputPolicy policy;
};

/// How far values are from others.
struct Difference {
  std::size_t count = 0;
  double rmse = 0, bias = 0;    ///< of a - b
  double largest = 0, p99 = 0;  ///< of |a - b|; 99 % of all are at most p99
  double mean_b = 0;
  double peak = 1;               ///< largest |a| or |b|, at least 1
  double relative_rmse() const;  ///< to the mean of b
  double psnr() const;           ///< decibels, to the peak; infinite without any error
};

/// Of two lists of finite numbers, as long as each other.
Difference measure_difference(const std::vector<float>& a, const std::vector<float>& b);

/// Channels over a window.
struct Channels {
  Window window;
  std::vector<Plane<float>> planes;
};

/// Of two pictures, where both have finite values.
struct ChannelsDifference {
  Difference figures;
  std::size_t pixels = 0;               ///< that count
  std::vector<Plane<float>> a_minus_b;  ///< over the window of A; 0 where a pixel does not count
};

/// `counts(x, y)` says which pixels count, in the coordinates of the windows. Channels pair in
/// order; one channel is compared with each of several, and other numbers must be equal.
ChannelsDifference compare_channels(const Channels& a, const Channels& b,
                                    const std::function<bool(int x, int y)>& counts);

/// What `ssdo compare` says, and whether it fails: ExitCode::failed where a layer's RMSE is above
/// `fail_above`.
struct CompareReport {
  std::string text;
  ExitCode code = ExitCode::done;
};

/// Errors: ExitCode::input for a file that cannot be read, layer for a layer that does not exist or
/// has no counterpart, failed where no pixel is valid in both, output for `diff`.
CompareReport compare(const CompareOptions& options);

}  // namespace ssdo
