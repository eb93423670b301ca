// SPDX-License-Identifier: Apache-2.0
//
// The noise of penumbras. Few rays of a pixel to a sun say nothing of their noise: where the
// penumbra is narrower than a pixel, not even those of its neighbours do. So where the error is
// wanted, a second set of rays goes to other points of the sun. Each set is filtered as a whole,
// and
//
//   error = E cos(N) (s1 - s2) / sqrt(2)
//
// s1 and s2 being the shares of the sun after the filter, which has independent noise of one size.
// What stays the same from set to set, such as the edges of shadows that a filter keeps, is no
// noise and cancels.
#include "filters/sun_errors.h"

#include <algorithm>
#include <cmath>

#include "math/luminance.h"
#include "parallel/tiles.h"

namespace ssdo {

void add_sun_errors(Products& products, const Scene& scene) {
  if (products.error.empty()) return;
  const Surfaces& surfaces = scene.geometry.surfaces;
  const LightVisibility& visibility = products.visibility;
  for (std::size_t k = 0; k < visibility.sources_again.size(); ++k) {
    const Source& source = *scene.light.sources[k];
    const float light = luminance(source.irradiance) / std::sqrt(2.0f);
    for_each_row(surfaces.height, [&](int y) {
      for (int x = 0; x < surfaces.width; ++x) {
        const std::size_t i = surfaces.index(x, y);
        const float one = std::clamp(visibility.sources[k][i], 0.0f, 1.0f),
                    other = std::clamp(visibility.sources_again[k][i], 0.0f, 1.0f);
        if (one == other || !surfaces[i].is_surface()) continue;
        products.error[i] += light * source.link_weight(i) *
                             source.received(surfaces[i].position, surfaces[i].normal) *
                             (one - other);
      }
    });
  }
}

}  // namespace ssdo
