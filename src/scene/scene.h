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

/// What the visible surfaces do with light, by pixel: what the sender of a solid indexes.
struct Senders {
  Plane<HalfColor> albedo;    ///< needed for a bounce; else may be empty
  Plane<glm::vec3> radiance;  ///< what they send, where a layer says so; else empty
};

/// What hides and sends light, where that is not what the pixels show: objects that cast nothing
/// are taken out, and what may be behind them is put in their place.
struct Casting {
  Geometry geometry;          ///< of the pixels of the scene's
  Plane<int> sender;          ///< the pixel whose light such a pixel sends; -1: it is as it shows
  Plane<unsigned char> hole;  ///< 1 in the pixels of those objects
};

/// All that is known about what a frame shows, in camera space and scene units: what an estimator
/// looks at.
struct Scene {
  Geometry geometry;  ///< what receives light, and, without `casting`, hides and sends it
  std::optional<Casting> casting;
  Solids solids;                 ///< of what casts
  std::vector<OtherView> views;  ///< of other cameras
  OtherSurfaces other_surfaces;  ///< what they show that the frame does not
  Senders senders;
  Light light;
  /// What blocks the light of a lamp that names its casters, by its number in Light::sources: this
  /// frame and the other views without the rest. Casting, solids and other_surfaces alone are
  /// filled.
  std::map<std::size_t, std::shared_ptr<const Scene>> blockers;
  Plane<float> roughness;           ///< 0..1; empty: the same everywhere, a parameter of the method
  Plane<HalfColor> specular_color;  ///< F0, 0..1; empty: of an index of refraction, a parameter
  /// The same frame without the objects of --shadow-of; null: not asked for. Its light, roughness
  /// and colours are those of this scene, and empty there.
  std::shared_ptr<Scene> without;

  const Geometry& casters() const { return casting ? casting->geometry : geometry; }
};

}  // namespace ssdo
