// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/other_views/other_view_light.h"
#include "estimators/products.h"
#include "math/plane.h"
#include "scene/light/light_group.h"
#include "scene/scene.h"

namespace ssdo {

/// A surface that a ray meets.
struct SurfaceHit {
  bool other_view = false;  ///< whether the frame does not show it
  bool back = false;        ///< whether the ray meets the side that the view does not see
  std::size_t sender = 0;   ///< a pixel, or a vertex of another view
};

/// The radiance that surfaces send of one light, or of all lights as one, in a pass of bounces.
struct TraceSenders {
  LightGroup light;
  Plane<glm::vec3> front, back;        ///< by pixel; back is empty where both sides send the same
  std::vector<OtherViewLight> others;  ///< by pass

  glm::vec3 sent_by(const SurfaceHit& met, int pass) const {
    if (met.other_view) {
      const OtherViewLight& vertices = others[std::size_t(pass - 1)];
      return (met.back ? vertices.unseen : vertices.seen)[met.sender];
    }
    return (met.back && !back.empty() ? back : front)[met.sender];
  }
};

/// Finds front and back: albedo times the light that arrives, or the layer of radiance. `found` has
/// ao, direct and its shares; `bounce` is that of the light in the pass before.
void find_senders(const Scene& scene, const Products& found, const Plane<glm::vec3>& bounce,
                  TraceSenders& senders);

}  // namespace ssdo
