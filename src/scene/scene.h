// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "math/half_color.h"
#include "math/plane.h"
#include "scene/geometry.h"
#include "scene/light/light.h"
#include "scene/other_views/other_surfaces.h"
#include "scene/other_views/other_view.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// What the visible surfaces do with light, by pixel; the sender of a solid is an index into it.
struct Senders {
  Plane<HalfColor> albedo;    ///< needed for a bounce; else may be empty
  Plane<glm::vec3> radiance;  ///< what they send, where a layer says so; else empty
};

/// What hides and sends light, where that is not what the pixels show: objects that cast nothing
/// are taken out, and what may be behind them is put in their place.
struct CasterSurfaces {
  Geometry geometry;          ///< at the pixels of Scene::geometry
  Plane<int> sender;          ///< the pixel whose light a pixel sends; -1: its own surface's
  Plane<unsigned char> hole;  ///< 1 in the pixels of those objects
};

/// All that is known about what a frame shows, in camera space and scene units: what an estimator
/// looks at.
struct Scene {
  Geometry geometry;  ///< what receives light, and, without `caster_surfaces`, hides and sends it
  std::optional<CasterSurfaces> caster_surfaces;
  Solids solids;                 ///< of what casts
  std::vector<OtherView> views;  ///< of other cameras
  OtherSurfaces other_surfaces;  ///< seen by `views`, but not by the frame
  Senders senders;
  Light light;
  /// For each lamp that names its casters, by its number in Light::sources: these casters alone, in
  /// this frame and in the other views. Only caster_surfaces, solids and other_surfaces are filled.
  std::map<std::size_t, std::shared_ptr<const Scene>> linked_occluders;
  Plane<float> roughness;           ///< 0..1; empty: the same everywhere, a parameter of the method
  Plane<HalfColor> specular_color;  ///< F0, 0..1; empty: of an index of refraction, a parameter
  /// The same frame without the objects of --shadow-of; null: not asked for. Its light, roughness
  /// and colours are those of this scene, and empty there.
  std::shared_ptr<Scene> without;

  const Geometry& casters() const { return caster_surfaces ? caster_surfaces->geometry : geometry; }
};

}  // namespace ssdo
