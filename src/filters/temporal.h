// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>

#include "estimators/estimator.h"
#include "math/half_color.h"
#include "scene/geometry.h"

namespace ssdo {

/// What the frames before hand on to the next one.
struct History {
  Geometry geometry;    ///< of the latest frame; it must know the world
  Products mean;        ///< over frames; bent in the latest camera's space, not made unit
  Plane<float> frames;  ///< how many frames each pixel's mean counts; 0 where there is no surface
  Plane<HalfColor> albedo;  ///< of the latest frame, to recognise a cut by; may be empty
};

/// The means after the frame that `geometry` and `now` show, for the frame after it; the caller
/// adds geometry and albedo. History counts where it shows the same surface, see temporal.cpp;
/// there is none where `before` is null, one of both frames knows no world, or they have other
/// products. `motion` leads from each pixel to where what it shows was seen in the frame before, in
/// pixels, x right and y down; where it is empty or not finite, things stand still.
History accumulate(const History* before, const Geometry& geometry, const Products& now,
                   const Plane<glm::vec2>& motion = {});

/// The means as products: bent is unit, background as each estimator leaves it.
Products products_of(const History& history);

}  // namespace ssdo
