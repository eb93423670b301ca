// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/further/further_view.h"
#include "scene/geometry.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// Takes from guessed solids, but not from measured ones, what further views know better: they end
/// where a view looks through them, and surfaces that were guessed behind others or beyond the
/// frame end where a view shows what is there.
void carve(Solids& solids, const Geometry& frame, const std::vector<FurtherView>& views);

}  // namespace ssdo
