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

/// The distance along the view ray from the surface in each pixel of a frame to the back face
/// behind it; infinite where the view shows none. Nothing if `view` is not a picture of back faces
/// from the camera of the frame: see back_faces.cpp.
std::optional<Plane<float>> find_back_faces(const OtherView& view, const Geometry& frame);

/// Ends each visible solid at its nearest back face, unless a deep image has measured its end
/// already.
void end_at_back_faces(Solids& solids, const std::vector<Plane<float>>& distances);

/// How many pixels have a back face.
std::size_t count_back_faces(const Plane<float>& distances);

}  // namespace ssdo
