// SPDX-License-Identifier: Apache-2.0
#include "scene/light/named_light.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace ssdo {

std::vector<NamedLight> lights_of(const Light& all) {
  NamedLight environment{std::string(kEnvironmentName), all, {}};
  environment.light.sources.clear();
  std::vector<NamedLight> lamps;
  for (std::size_t k = 0; k < all.sources.size(); ++k) {
    const auto& source = all.sources[k];
    NamedLight& light =
        source->name.empty() ? environment : lamps.emplace_back(NamedLight{source->name, {}, {}});
    light.light.sources.push_back(source);
    light.numbers.push_back(k);
  }
  const bool is_dark = environment.light.is_constant() &&
                       environment.light.environment.constant_radiance() == glm::vec3(0);
  if (!is_dark || lamps.empty()) lamps.insert(lamps.begin(), std::move(environment));
  return lamps;
}

bool has_lamps(const Light& all) {
  return std::ranges::any_of(all.sources, [](const auto& s) { return !s->name.empty(); });
}

NamedLight as_one_light(const Light& all) {
  NamedLight one{"", all, std::vector<std::size_t>(all.sources.size())};
  std::iota(one.numbers.begin(), one.numbers.end(), std::size_t(0));
  return one;
}

}  // namespace ssdo
