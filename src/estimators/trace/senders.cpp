// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/senders.h"

#include <cmath>

#include "math/light_range.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/solids/unseen_side.h"

namespace ssdo {
namespace {

/// The direct light of `light` that arrives at a pixel.
glm::vec3 direct_of(const LightGroup& light, const Products& found, const Surfel& s,
                    std::size_t pixel) {
  if (found.visibility.are_ao || light.name.empty()) return found.direct[pixel];
  glm::vec3 direct = light.light.unoccluded_sky(s.normal) * found.visibility.sky[pixel];
  for (std::size_t i = 0; i < light.source_indices.size(); ++i)
    direct += light.light.sources[i]->link_weight(pixel) *
              light.light.sources[i]->unoccluded(s.position, s.normal) *
              found.visibility.sources[light.source_indices[i]][pixel];
  return direct;
}

/// Surfaces in place of objects that cast nothing send the same as their sender, a pixel beside
/// them.
void send_from_hole(const Plane<int>& from, TraceSenders& senders) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from[i] < 0) continue;
    senders.front[i] = senders.front[std::size_t(from[i])];
    if (!senders.back.empty()) senders.back[i] = senders.back[std::size_t(from[i])];
  }
}

/// The unoccluded light at the side that is not seen (scene/solids/unseen_side.h). An endless solid
/// has no such side that a lamp could be near to.
glm::vec3 unoccluded_behind(const Scene& scene, const Light& light, std::size_t pixel) {
  const Surfel& s = scene.geometry.surfaces[pixel];
  const Camera& camera = scene.geometry.camera;
  const glm::vec3 view = direction_to_viewer(s.position, camera.orthographic),
                  normal = unseen_normal(s.normal, view);
  const float thickness = scene.solids.thickness_seen(int(pixel)),
              width = PixelFootprint(camera).at(-s.position.z),
              through = way_through(thickness, camera.orthographic ? width : width / view.z);
  glm::vec3 sum = light.unoccluded_sky(normal);
  for (const auto& source : light.sources) {
    if (!source->local_lamp())
      sum += source->link_weight(pixel) * source->unoccluded(s.position, normal);
    else if (!std::isinf(thickness))
      sum += source->link_weight(pixel) * source->unoccluded(s.position - through * view, normal);
  }
  return sum;
}

}  // namespace

void find_senders(const Scene& scene, const Products& found, const Plane<glm::vec3>& bounce,
                  TraceSenders& senders) {
  const bool is_given = !scene.senders.radiance.empty(),
             two_sided = !scene.light.is_constant() && !is_given;
  senders.front = Plane<glm::vec3>(bounce.width, bounce.height, glm::vec3(0));
  if (two_sided) senders.back = senders.front;
  for_each_row(bounce.height, [&](int y) {
    for (std::size_t i = bounce.index(0, y); i < bounce.index(0, y + 1); ++i) {
      const Surfel& s = scene.geometry.surfaces[i];
      if (!s.is_usable()) continue;
      if (is_given) {
        senders.front[i] = within_range(scene.senders.radiance[i]);
        continue;
      }
      const glm::vec3 albedo(scene.senders.albedo[i]);
      senders.front[i] = within_range(albedo * (direct_of(senders.light, found, s, i) + bounce[i]));
      if (!two_sided) continue;
      // The hidden side receives the unoccluded light of its own side times the ao of the visible
      // side.
      const glm::vec3 behind = found.ao[i] * unoccluded_behind(scene, senders.light.light, i);
      senders.back[i] = within_range(albedo * (behind + bounce[i]));
    }
  });
  if (scene.caster_surfaces) send_from_hole(scene.caster_surfaces->sender, senders);
}

}  // namespace ssdo
