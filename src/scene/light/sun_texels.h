// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "math/plane.h"
#include "scene/light/distant_source.h"
#include "scene/light/environment.h"
#include "scene/light/surroundings.h"

namespace ssdo {

/// The texels of a map, from which sources are taken one after the other.
class SunTexels {
 public:
  explicit SunTexels(const Environment& whole);

  int width() const { return rest_->width; }
  int height() const { return rest_->height; }

  /// Without the sources removed so far.
  const std::shared_ptr<const Plane<glm::vec3>>& rest() const { return rest_; }

  /// The light by which the texels of `windows` exceed the sky around them, as a source; nothing if
  /// they do not. `threshold` is the radiance of what surely belongs to it. Share and sh_fraction
  /// are 0.
  std::optional<DistantSource> measure(const std::vector<Window>& windows, float threshold,
                                       const Surroundings& around) const;

  /// Removes `part`, 0..1, of a source: in its place stays the sky around it, with the rest of the
  /// source. Returns what each window would lose with all of the source: radiance times solid
  /// angle.
  std::vector<glm::vec3> remove(const std::vector<Window>& windows, const Surroundings& around,
                                float part);

 private:
  /// Calls `visit(window, x, y, direction, sky)` for every texel; the sky that is left in its place
  /// is in the unit of the map, and in no channel brighter than the texel.
  template <class Visit>
  void for_each_texel(const std::vector<Window>& windows, const Surroundings& around,
                      const Visit& visit) const;

  Window bounds(const std::vector<Window>& windows) const;

  const Environment& whole_;
  std::shared_ptr<const Plane<glm::vec3>> rest_;
  std::shared_ptr<Plane<glm::vec3>> copy_;  ///< the same, once there is something to change
  std::vector<glm::vec3> horizon_;          ///< unit direction on the horizon, by column
  std::vector<glm::vec2> polar_;            ///< sine and cosine of the polar angle, by row
};

}  // namespace ssdo
