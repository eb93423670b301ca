// SPDX-License-Identifier: Apache-2.0
#include "color/light_colors.h"

#include "color/downsample.h"
#include "parallel/tiles.h"

namespace ssdo {

Plane<glm::vec3> unoccluded_light(const Scene& scene, const Light& light) {
  auto all = Plane<glm::vec3>::like(scene.geometry.surfel);
  for_each_row(all.height, [&](int y) {
    for (std::size_t i = all.index(0, y); i < all.index(0, y + 1); ++i) {
      const Surfel& s = scene.geometry.surfel[i];
      all[i] = s.is_usable() ? light.unoccluded(s.position, s.normal) : glm::vec3(0);
    }
  });
  return all;
}

Plane<glm::vec3> composed_of_light(const Product& product, const LitBy& by,
                                   const Results& results) {
  const Plane<glm::vec3> whole = product_at_output_size(
      find_product("unshadowed"), unoccluded_light(results.scene, by.light), results);
  if (product.name == "unshadowed") return whole;
  Plane<glm::vec3> share = product_at_output_size(find_product("direct"), by.direct, results);
  for_each_row(share.height, [&](int y) {
    for (std::size_t i = share.index(0, y); i < share.index(0, y + 1); ++i)
      for (int c = 0; c < 3; ++c)
        share[i][c] = whole[i][c] > 0 ? share[i][c] / whole[i][c] : product.background;
  });
  return share;
}

}  // namespace ssdo
