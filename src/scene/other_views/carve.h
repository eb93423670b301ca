// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/geometry.h"
#include "scene/other_views/other_view.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// Takes from guessed solids, but not from measured ones, what other views know better: they end
/// where a view looks through them, and surfaces that were guessed beyond the frame end where a
/// panorama shows what is there.
void carve(Solids& solids, const Geometry& frame, const std::vector<OtherView>& views);

}  // namespace ssdo
