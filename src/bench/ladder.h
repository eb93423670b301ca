// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "plan/plan.h"

namespace ssdo {

/// A method with values for its parameters.
struct Setting {
  const Method* method = nullptr;
  Rung rung;              ///< labelled "2 x 24", "16 samples"
  bool standard = false;  ///< whether these are the method's defaults

  /// The method and its label.
  std::string name() const;

  /// The model with this method and its values. Its other parameters stay, except a thickness or an
  /// endless radius that the method does not take.
  ModelOptions applied_to(const ModelOptions& model) const;

  /// The arguments of the main job that choose this setting.
  std::vector<std::string> arguments() const;
};

/// The settings of a method: those to choose among, cheapest first, and one far beyond them.
struct Settings {
  std::vector<Setting> ladder;
  Setting limit;
  int seeds = 1;
};

/// `rays` is the number of samples per seed in the limit of the reference method; other methods
/// have limits of their own.
Settings settings_of(const Method& method, int rays);

/// The setting with the method's defaults.
Setting standard_setting(const Method& method);

/// Rays per pixel and seed for the reference of a frame: a power of 2, smaller in large frames to
/// bound their total.
int reference_rays(std::size_t surface_pixels);

}  // namespace ssdo
