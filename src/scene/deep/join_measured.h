// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/deep/measured_solids.h"
#include "scene/geometry.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// The solids of a frame from measured and guessed ones. What is not measured is guessed as
/// guess_solids does, or is as thick as `thickness`, which may be infinite; see join_measured.cpp.
Solids join_measured(const Geometry& geometry, const MeasuredSolids& measured,
                     std::optional<float> thickness);

}  // namespace ssdo
