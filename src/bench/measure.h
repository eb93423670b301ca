// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "metrics/difference.h"
#include "relight/frame.h"
#include "stopwatch.h"

namespace ssdo {

/// Cost of a stage: the time of all threads together, and the time by the clock.
struct Cost {
  double cpu_ms = 0, wall_ms = 0;
};

/// Measures laps by both clocks.
class CostWatch {
 public:
  CostWatch();
  Cost lap();

 private:
  Stopwatch wall_;
  double cpu_;
};

/// Each product by its name, as an EXR would hold it.
using ProductChannels = std::map<std::string, Channels>;

/// The products of a plan, and their cost: medians of `runs` runs.
struct Measured {
  Products products;
  Cost estimate, filter;
  int runs = 0;
};

/// The products that `plan` makes.
ProductChannels channels_of(const Frame& frame, const Plan& plan, const Products& products);

/// Estimates and filters as the main job does; several times where that is quick.
Measured measure(const Frame& frame, const Plan& plan, const Progress& progress);

/// An estimate of the limit for infinitely many samples: the mean over several seeds, unfiltered.
struct Converged {
  ProductChannels products;
  ProductChannels half_difference;  ///< of the means of both halves of the seeds; empty for 1 seed
};

/// `seeds` is 1 or even. They follow the plan's own seed without including it, so that the noise of
/// the limit is independent of that of the settings compared with it.
Converged converge(const Frame& frame, const Plan& plan, int seeds,
                   const std::function<void(int)>& on_progress);

/// How far A is from B on the surfaces of the frame.
ChannelsDifference compare_surfaces(const Frame& frame, const Channels& a, const Channels& b);

/// Whether the error of a product is absolute, as for shares in 0..1; else it is relative to the
/// mean.
bool has_absolute_error(const std::string& product);

/// The RMSE of a product, or its relative RMSE; see has_absolute_error().
double error_of(const std::string& product, const Difference& difference);

}  // namespace ssdo
