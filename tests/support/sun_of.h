// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/light/distant_source.h"
#include "scene/light/light.h"

namespace ssdo::test {

/// A source of the light of a map, the strongest first.
inline const DistantSource& sun_of(const Light& light, std::size_t number = 0) {
  return *light.sources.at(number)->distant();
}

}  // namespace ssdo::test
