// SPDX-License-Identifier: Apache-2.0
#include "filters/filter_products.h"

#include <cstddef>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace ssdo {
namespace {

/// Filters every share that has a draw, if the filter treats them apart. Whether it does.
bool filter_shadows(const Filter& filter, LightShares& shares, const Surfaces& guide,
                    int pattern_size) {
  const auto each = [&](std::vector<Plane<float>>& suns, std::vector<ShadowDraw>& draws) {
    for (std::size_t k = 0; filter.shadow && k < draws.size(); ++k)
      suns[k] = filter.shadow({std::move(suns[k]), std::move(draws[k])}, guide, pattern_size);
    return !std::exchange(draws, {}).empty();
  };
  const bool drawn = each(shares.suns, shares.draws);
  each(shares.suns_again, shares.draws_again);
  return filter.shadow && drawn;
}

}  // namespace

Products filter_products(const Filter& filter, Products noisy, const Surfaces& guide,
                         int pattern_size) {
  if (!filter.apply) return noisy;
  LightShares& shares = noisy.shares;
  FilterPlanes planes;
  std::vector<std::variant<Plane<float>*, Plane<glm::vec3>*>> places;
  const auto take = [&](auto& plane, const Filtering& filtering) {
    if (plane.empty()) return;
    places.emplace_back(&plane);
    planes.push_back({std::move(plane), filtering});
  };
  const bool suns_are_done = filter_shadows(filter, shares, guide, pattern_size);
  for_each_plane([&](const Product& product, auto& plane) { take(plane, product.filtering); },
                 noisy);
  // Several passes are one mean: shares are clamped after the last (shares.cpp).
  constexpr Filtering kOfShares{.shadowed = true};
  take(shares.sky, kOfShares);
  for (auto* suns : {&shares.suns, &shares.suns_again})
    for (Plane<float>& sun : *suns)
      if (!suns_are_done) take(sun, kOfShares);
  take(shares.emitted, {});
  for (LightProducts& light : noisy.lights) take(light.emitted, {});
  take(shares.mirrored_sky, kOfShares);
  planes = filter.apply(std::move(planes), guide, pattern_size);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const auto put_back = [&](auto* place) {
      *place = std::get<std::decay_t<decltype(*place)>>(std::move(planes[k].plane));
    };
    std::visit(put_back, places[k]);
  }
  return noisy;
}

}  // namespace ssdo
