// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light_group.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ssdo {

std::vector<LightGroup> light_groups_of(const Light& all) {
  LightGroup environment{std::string(kEnvironmentName), all, {}};
  environment.light.sources.clear();
  std::vector<LightGroup> lamps;
  for (std::size_t k = 0; k < all.sources.size(); ++k) {
    const auto& source = all.sources[k];
    LightGroup& light =
        source->name.empty() ? environment : lamps.emplace_back(LightGroup{source->name, {}, {}});
    light.light.sources.push_back(source);
    light.source_indices.push_back(k);
  }
  const bool is_dark = environment.light.is_constant() &&
                       environment.light.environment.constant_radiance() == glm::vec3(0);
  if (!is_dark || lamps.empty()) lamps.insert(lamps.begin(), std::move(environment));
  return lamps;
}

bool has_lamps(const Light& all) {
  return std::ranges::any_of(all.sources, [](const auto& s) { return !s->name.empty(); });
}

LightGroup as_one_group(const Light& all) {
  LightGroup one{"", all, std::vector<std::size_t>(all.sources.size())};
  std::iota(one.source_indices.begin(), one.source_indices.end(), std::size_t(0));
  return one;
}

}  // namespace ssdo
