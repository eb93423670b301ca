// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/kept_surfaces.h"

namespace ssdo {

/// What other frames of a shot show of the surfaces of one: shares of the points of a grid.
struct SeenByOthers {
  int frames = 0;      ///< others that know the world
  double some = 0;     ///< the share that one of them shows
  double times = 0;    ///< how many of them show a point, in the mean
  double through = 0;  ///< the share whose place one of them looks through: it has moved
};

/// Points are about 480 across the frame. Nothing is shown of a frame without a world, or without a
/// surface.
SeenByOthers seen_by(const std::vector<const KeptSurfaces*>& others, const KeptSurfaces& own);

}  // namespace ssdo
