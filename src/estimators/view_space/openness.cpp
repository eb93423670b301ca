// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/openness.h"

#include <utility>

#include "estimators/view_space/ambient_light.h"

namespace ssdo {

Plane<float> find_openness(const ViewPlanes& receivers, const Progress& progress,
                           const std::function<void(const Tile&, Plane<float>&)>& find) {
  Plane<float> open(receivers.width(), receivers.height(), 1.0f);
  for_each_tile(
      open.width, open.height, [&](const Tile& tile) { find(tile, open); }, progress);
  return open;
}

Products products_of_ao(const Scene& scene, const Request& request, Plane<float> ao) {
  Products out;
  out.ao = std::move(ao);
  if (request.products.direct) out.direct = ambient_light(scene, out.ao);
  return out;
}

}  // namespace ssdo
