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
  Rung rung;              ///< labelled "2 x 24", "16 samples"
  bool standard = false;  ///< what the main job does when it is asked for nothing

  /// The method and its label.
  std::string name() const;

  /// The model with this method and quality in place of its own; its other parameters stay, but
  /// for a thickness and an endless radius where the method knows none.
  ModelOptions applied_to(const ModelOptions& model) const;

  /// The arguments of the main job that choose it.
  std::vector<std::string> arguments() const;
};

/// The ladder of a method.
struct Settings {
  std::vector<Setting> ladder;
  Setting limit;
  int seeds = 1;
};

/// `rays` is how many samples per seed the limit of the reference has; others have their own.
Settings settings_of(const Method& method, int rays);

/// The one that the main job takes.
Setting standard_setting(const Method& method);

/// How many rays per pixel and seed the reference of a frame takes: a power of 2 that keeps their
/// number bounded in large frames.
int reference_rays(std::size_t surface_pixels);

}  // namespace ssdo
