// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "math/plane.h"
#include "scene/geometry.h"
#include "scene/other_views/other_view.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// The distance from what each pixel of a frame shows to the back face behind it, along its view
/// ray; infinite where the view shows none. Nothing where `view` is not of back faces from the
/// frame's own camera: see back_faces.cpp.
std::optional<Plane<float>> find_back_faces(const OtherView& view, const Geometry& frame);

/// Ends what is seen at the nearest of its back faces, unless a deep image has measured it already.
void end_at_back_faces(Solids& solids, const std::vector<Plane<float>>& distances);

/// How many pixels have a back face.
std::size_t count_back_faces(const Plane<float>& distances);

}  // namespace ssdo
