// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "math/plane.h"
#include "scene/other_views/other_view.h"
#include "scene/scene.h"

namespace ssdo {

/// The surfaces of a frame without what a selection covers. This hole is filled with what other
/// views show there, else with what the surfaces around it suggest (remove_objects.cpp). `coverage`
/// is as selected_coverage() has it, over the window of the geometry. Where `backdrop` is 1,
/// nothing is left; it may be empty. If the geometry is some rows of a frame, `overview` is what
/// casts in a smaller picture of it, one pixel of every kOverviewStride x kOverviewStride: it
/// suggests what the surfaces beyond these rows do.
CasterSurfaces remove_objects(const Geometry& geometry, const Plane<float>& coverage,
                              const Plane<float>& backdrop, const std::vector<OtherView>& views,
                              const Geometry* overview = nullptr);

}  // namespace ssdo
