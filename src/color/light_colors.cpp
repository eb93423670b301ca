// SPDX-License-Identifier: Apache-2.0
#include "color/light_colors.h"

#include "color/downsample.h"
#include "parallel/tiles.h"

namespace ssdo {

Plane<glm::vec3> unoccluded_light(const Scene& scene, const Light& light) {
  auto all = Plane<glm::vec3>::like(scene.geometry.surfaces);
  for_each_row(all.height, [&](int y) {
    for (std::size_t i = all.index(0, y); i < all.index(0, y + 1); ++i) {
      const Surfel& s = scene.geometry.surfaces[i];
      all[i] = s.is_usable() ? light.unoccluded_in(i, s.position, s.normal) : glm::vec3(0);
    }
  });
  return all;
}

namespace {

/// Light over other light, channel by channel; `otherwise` where there is none.
Plane<glm::vec3> ratio_of(Plane<glm::vec3> part, const Plane<glm::vec3>& whole, float otherwise) {
  for_each_row(part.height, [&](int y) {
    for (std::size_t i = part.index(0, y); i < part.index(0, y + 1); ++i)
      for (int c = 0; c < 3; ++c)
        part[i][c] = whole[i][c] > 0 ? part[i][c] / whole[i][c] : otherwise;
  });
  return part;
}

}  // namespace

Plane<glm::vec3> shadow_of_objects(const Product& product, const Results& results) {
  const Products& found = results.shown();
  const auto at_output = [&](const Plane<glm::vec3>& light) {
    return product_at_output_size(find_product("direct"), light, results);
  };
  return ratio_of(at_output(found.lit), at_output(found.lit_without), product.background);
}

Plane<glm::vec3> composed_of_light(const Product& product, const LitBy& by,
                                   const Results& results) {
  const Plane<glm::vec3> whole = product_at_output_size(
      find_product("unshadowed"), unoccluded_light(results.scene, by.light), results);
  if (product.name == "unshadowed") return whole;
  return ratio_of(product_at_output_size(find_product("direct"), by.direct, results), whole,
                  product.background);
}

}  // namespace ssdo
