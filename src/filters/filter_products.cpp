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
bool filter_shadows(const Filter& filter, LightVisibility& visibility, const Surfaces& guide,
                    int pattern_size) {
  const auto each = [&](std::vector<Plane<float>>& suns, std::vector<ShadowSample>& samples) {
    for (std::size_t k = 0; filter.shadow && k < samples.size(); ++k)
      suns[k] = filter.shadow({std::move(suns[k]), std::move(samples[k])}, guide, pattern_size);
    return !std::exchange(samples, {}).empty();
  };
  const bool drawn = each(visibility.sources, visibility.samples);
  each(visibility.sources_again, visibility.samples_again);
  return filter.shadow && drawn;
}

}  // namespace

Products filter_products(const Filter& filter, Products noisy, const Surfaces& guide,
                         int pattern_size) {
  if (!filter.apply) return noisy;
  LightVisibility& visibility = noisy.visibility;
  FilterPlanes planes;
  std::vector<std::variant<Plane<float>*, Plane<glm::vec3>*>> places;
  const auto take = [&](auto& plane, const Filtering& filtering) {
    if (plane.empty()) return;
    places.emplace_back(&plane);
    planes.push_back({std::move(plane), filtering});
  };
  const bool suns_are_done = filter_shadows(filter, visibility, guide, pattern_size);
  for_each_plane([&](const Product& product, auto& plane) { take(plane, product.filtering); },
                 noisy);
  // Several passes are one mean: shares are clamped after the last (light_visibility.cpp).
  constexpr Filtering kOfShares{.shadowed = true};
  take(visibility.sky, kOfShares);
  for (auto* suns : {&visibility.sources, &visibility.sources_again})
    for (Plane<float>& sun : *suns)
      if (!suns_are_done) take(sun, kOfShares);
  take(visibility.emitted, {});
  for (LightProducts& light : noisy.lights) take(light.emitted, {});
  take(visibility.mirrored_sky, kOfShares);
  take(visibility.mirrored_guessed, {});
  take(visibility.mirrored_guessed_open, {});
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
