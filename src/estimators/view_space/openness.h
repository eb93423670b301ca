// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "estimators/estimator.h"
#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// How open the pixels of `receivers` are, 0..1. `find` sets the surfaces of each tile; the rest is
/// 1.
Plane<float> find_openness(const ViewPlanes& receivers, const Progress& progress,
                           const std::function<void(const Tile&, Plane<float>&)>& find);

/// The products of methods that find only `ao`: direct light, where it is asked for, is that of
/// ambient_light().
Products products_of_ao(const Scene& scene, const Request& request, Plane<float> ao);

}  // namespace ssdo
