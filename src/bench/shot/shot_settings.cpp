// SPDX-License-Identifier: Apache-2.0
#include "bench/shot/shot_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace ssdo {

std::string ShotSetting::name() const {
  return arguments.empty() ? "alone" : fmt::format("{}", fmt::join(arguments, " "));
}

RunOptions ShotSetting::applied_to(RunOptions options) const {
  options.model.temporal = temporal;
  options.model.shot = {frames, 1};
  return options;
}

std::vector<ShotSetting> shot_settings(std::size_t count) {
  std::vector<ShotSetting> settings = {{}};
  if (count < 2) return settings;
  settings.push_back({{"--temporal"}, 0, true});
  for (const int frames : {1, 2, 4, 8}) {
    if (std::size_t(frames) < count)
      settings.push_back({{"--shot", std::to_string(frames)}, frames, false});
  }
  return settings;
}

}  // namespace ssdo
