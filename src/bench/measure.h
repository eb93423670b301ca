// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "frame.h"
#include "metrics/difference.h"

namespace ssdo {

/// What a stage takes: the time of all threads together, and the time that passes.
struct Cost {
  double cpu_ms = 0, wall_ms = 0;
};

/// Each product by its name, as an EXR would hold it.
using ProductChannels = std::map<std::string, Channels>;

/// What a plan makes of a frame, and what that costs: medians of `runs` runs.
struct Measured {
  Products products;
  Cost estimate, filter;
  int runs = 0;
};

/// The products that `plan` makes.
ProductChannels channels_of(const Frame& frame, const Plan& plan, const Products& products);

/// Estimates and filters as the main job does. What is quick runs several times.
Measured measure(const Frame& frame, const Plan& plan, const Progress& progress);

/// What samples without end would give: the mean over several seeds, without a filter.
struct Converged {
  ProductChannels products;
  ProductChannels half_difference;  ///< of the means of both halves of the seeds; empty for 1 seed
};

/// `seeds` is 1 or even; those that follow the plan's own are taken, so that its noise is not that
/// of what is held to it.
Converged converge(const Frame& frame, const Plan& plan, int seeds,
                   const std::function<void(int)>& on_progress);

/// How far A is from B on the surfaces of the frame.
ChannelsDifference compare_surfaces(const Frame& frame, const Channels& a, const Channels& b);

/// Whether the error of a product is judged as it is: that of a share; of others, it is relative to
/// the mean.
bool has_absolute_error(const std::string& product);

/// The figure that a product is judged by: RMSE or relative RMSE.
double error_of(const std::string& product, const Difference& difference);

}  // namespace ssdo
