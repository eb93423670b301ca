// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "plan.h"

namespace ssdo {

/// One quality of one method.
struct Setting {
  const Method* method = nullptr;
  std::string label;             ///< "2 x 24", "16 samples"
  int slices = 0, steps = 0;     ///< of a method that marches
  std::vector<std::string> set;  ///< NAME=VALUE of another
  bool standard = false;         ///< what the main job does when it is asked for nothing

  /// The method and its label.
  std::string name() const;

  /// The model with this method and quality in place of its own; its other parameters stay, but
  /// for a thickness and an endless radius where the method knows none.
  ModelOptions applied_to(const ModelOptions& model) const;

  /// The arguments of the main job that choose it.
  std::vector<std::string> arguments() const;
};

/// Settings of one method from cheap to dear, and what they converge to.
struct Ladder {
  std::vector<Setting> settings;
  Setting limit;  ///< so many samples that its own noise does not count
  int seeds = 1;  ///< of the limit, whose mean is taken: 1 or an even number
};

/// The ladder of each method of the table. `rays` is that of the limit of method trace, per seed.
Ladder ladder_of(const Method& method, int rays);

/// The one that the main job takes.
Setting standard_setting(const Method& method);

/// How many rays per pixel and seed the reference of a frame takes: a power of 2 that keeps their
/// number bounded in large frames.
int reference_rays(std::size_t surface_pixels);

}  // namespace ssdo
