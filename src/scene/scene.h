// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "math/half_color.h"
#include "math/plane.h"
#include "scene/geometry.h"
#include "scene/light/light.h"
#include "scene/other_views/other_surfaces.h"
#include "scene/other_views/other_view.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// What the visible surfaces do with light, by pixel: what the sender of a solid indexes.
struct Senders {
  Plane<HalfColor> albedo;    ///< needed for a bounce; else may be empty
  Plane<glm::vec3> radiance;  ///< what they send, where a layer says so; else empty
};

/// All that is known about what a frame shows, in camera space and scene units: what an estimator
/// looks at.
struct Scene {
  Geometry geometry;
  Solids solids;
  std::vector<OtherView> views;  ///< of other cameras
  OtherSurfaces other_surfaces;  ///< what they show that the frame does not
  Senders senders;
  Light light;
  Plane<float> roughness;           ///< 0..1; empty: the same everywhere, a parameter of the method
  Plane<HalfColor> specular_color;  ///< F0, 0..1; empty: of an index of refraction, a parameter
};

}  // namespace ssdo
