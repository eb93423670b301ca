// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/light/distant_source.h"
#include "scene/light/environment.h"

namespace ssdo {

/// An environment in two parts whose light adds up to the whole in every texel.
struct SunsAndRest {
  std::vector<DistantSource> suns;  ///< strongest first, at most 8, in world space
  Environment rest;  ///< where suns were: the radiance around them, and what is not taken
};

/// Takes out the sources that spherical harmonics cannot hold: connected bright texels, no farther
/// than 40 degrees from their middle, whose light less that of harmonics in the same place is at
/// least 5 % of the irradiance of a surface that faces it. A source of 2 % stays in the map; from
/// there on, a growing part of it is taken out. A longer region that harmonics hardly hold is taken
/// in pieces. Not for a constant.
SunsAndRest take_suns(const Environment& whole);

}  // namespace ssdo
