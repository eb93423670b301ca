// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/slice_pattern.h"
#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// The slices in which a request looks for visibility. `far` may be null.
SlicePattern pattern_of(const Request& request, const Interleaving& layout, const Window& display,
                        const OverviewRaster* far = nullptr);

/// The slices in which a request gathers bounce light. `has_lamps`: some of it is that of lamps
/// that stand in the scene.
SlicePattern bounce_pattern_of(const Request& request, bool has_lamps, const Interleaving& layout,
                               const Window& display, const OverviewRaster* far = nullptr);

/// As BandSupport has it.
int reach_rows(const Geometry& some, int stride, const Window& frame, const Window& display,
               const Request& request);

}  // namespace ssdo
