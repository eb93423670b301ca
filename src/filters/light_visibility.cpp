// SPDX-License-Identifier: Apache-2.0
//
// What a filter averages in place of light and directions.
//
//   direct = E(N) S + sum over sources of E_k(P, N) s_k
//
// E(N) is the unoccluded light of the sky, a function of the normal, and E_k that of source k; S,
// by channel, and s_k are the shares of them that arrive. Noise is in the shares alone, so filters
// average these, and the product is taken afterwards: an average of the light itself blurs what
// normal maps show. Under a sun, a normal map with a sine of 15 degrees and 8 pixels kept 0.14 of
// its contrast.
//
// A method that does not know the parts has one share of all light, direct / E(N). Where E(N) is 0,
// ao is the share. Methods that look the light up in another direction than N may find far more
// than E(N) where E(N) is small: kMostShare limits the share, or such a pixel would light up those
// around it.
//
// The bent normal is averaged by how it deviates from N, in a frame in which N is the z axis, the
// view axis. The rotation that takes N there by the shortest way is smooth over all normals that
// the camera sees.
//
// Bounce light of small bright senders is averaged apart and not limited by ao
// (filters/geometry_filter.cpp), since few slices may have missed the senders.
//
// What surfaces mirror is put together from shares too (estimators/specular/specular.h).
//
// Where the share of all light is ao, there is nothing to be filtered but ao.
//
// The light of each lamp is its own unoccluded light times its share: a term of the sum above.
//
// ao is averaged as it is. What of ao is open by the normal alone would be divided out in
// shares_of_row() and multiplied in light_of_row().
//
// Compiled once for every instruction set.
#include "filters/light_visibility.h"

#include <algorithm>
#include <utility>

#include "estimators/guessed.h"
#include "estimators/specular/specular.h"
#include "filters/filter_products.h"
#include "filters/sun_errors.h"
#include "scene/light/light_group.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/light_visibility.cpp"
#include <hwy/foreach_target.h>

#include "filters/tile_rows-inl.h"
#include "scene/light/light-inl.h"
#include "scene/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kMostShare = 2;

/// Calls `work(index, count, surfels)` for vectors of a row; the last may have fewer pixels than
/// lanes. The normal is (0, 0, 1) where there is no surface.
template <class Work>
HWY_INLINE void for_each_vector(const Surfaces& surfaces, int y, const Work& work) {
  for (int x = 0; x < surfaces.width; x += kLanes) {
    Surfels s = surfels_at(surfaces, x, y);
    s.normal = if_then_else(s.surface, s.normal, set(glm::vec3(0, 0, 1)));
    work(surfaces.index(x, y), surfaces.width - x, s);
  }
}

/// `v` turned as the unit vector `a` is turned to the unit vector `b` by the shortest way.
HWY_INLINE V3 turned(const V3& v, const V3& a, const V3& b) {
  const V3 both = a + b;
  const V opposite = hn::Max(set(1) + dot(a, b), set(1e-6f));
  return mul_add(both, hn::Neg(dot(both, v) / opposite), mul_add(b, set(2) * dot(a, v), v));
}

/// The share of its unoccluded light that each pixel of a row receives.
void shares_of_row(const Scene& scene, Products& products, int y) {
  const bool has_ao = !products.ao.empty();
  for_each_vector(
      scene.geometry.surfaces, y, [&](std::size_t i, int count, const Surfels& s) HWY_ATTR {
        if (!products.bent.empty()) {
          const V3 bent = load_first(count, &products.bent[i]),
                   deviation = turned(bent, s.normal, set(glm::vec3(0, 0, 1)));
          store_first(count, if_then_else(s.surface, deviation, bent), &products.bent[i]);
        }
        if (products.direct.empty()) return;
        const V3 light = load_first(count, &products.direct[i]),
                 all = unoccluded(scene.light, s.position, s.normal);
        const V ao = has_ao ? load_first(count, &products.ao[i]) : set(1);
        const auto share = [&](V part, V whole) HWY_ATTR {
          return hn::IfThenElse(whole > set(0), hn::Min(part / whole, set(kMostShare)), ao);
        };
        const V3 shares{share(light.x, all.x), share(light.y, all.y), share(light.z, all.z)};
        store_first(count, if_then_else_zero(s.surface, shares), &products.direct[i]);
      });
}

/// The part of `light` that arrives at a vector of pixels: `sky` is the share of its sky,
/// `share_of(k)` that of its source k.
template <class ShareOf>
HWY_INLINE V3 arriving(const Light& light, const Surfels& s, const V3& sky,
                       const ShareOf& share_of) {
  V3 sum = saturate(sky) * unoccluded_sky(light, s.normal);
  for (std::size_t k = 0; k < light.sources.size(); ++k)
    sum = mul_add(unoccluded(*light.sources[k], s.position, s.normal), share_of(k), sum);
  return sum;
}

/// The share of a source that arrives at pixels from `i` on and lights them.
HWY_INLINE V lit_share(const Source& source, const Plane<float>& share, std::size_t i, int count) {
  const V arrives = saturate(load_first(count, &share[i]));
  return source.receivers ? arrives * link_weight(source, i, count) : arrives;
}

/// The light of a row from its shares, light by light, before light_of_row() takes their room.
void lights_of_row(const Scene& scene, const std::vector<LightGroup>& lights, Products& products,
                   int y) {
  const LightVisibility& visibility = products.visibility;
  for_each_vector(
      scene.geometry.surfaces, y, [&](std::size_t i, int count, const Surfels& s) HWY_ATTR {
        const V3 sky = load_first(count, &visibility.sky[i]);
        for (std::size_t l = 0; l < lights.size(); ++l) {
          const auto share_of = [&](std::size_t k) HWY_ATTR {
            return lit_share(*lights[l].light.sources[k],
                             visibility.sources[lights[l].source_indices[k]], i, count);
          };
          const V3 sum = arriving(lights[l].light, s, sky, share_of);
          store_first(count, if_then_else_zero(s.surface, sum), &products.lights[l].direct[i]);
        }
      });
}

/// The light of a row from its shares.
void light_of_row(const Scene& scene, Products& products, int y) {
  const Light& light = scene.light;
  Plane<glm::vec3>& found =
      products.visibility.sky.empty() ? products.direct : products.visibility.sky;
  for_each_vector(
      scene.geometry.surfaces, y, [&](std::size_t i, int count, const Surfels& s) HWY_ATTR {
        const V3 n = s.normal;
        if (!products.bent.empty()) {
          const V3 deviation = load_first(count, &products.bent[i]),
                   bent = normalise(turned(deviation, set(glm::vec3(0, 0, 1)), n));
          store_first(count, if_then_else(s.surface, bent, deviation), &products.bent[i]);
        }
        if (found.empty()) return;
        V3 sum;
        if (products.visibility.are_ao) {
          sum = unoccluded(light, s.position, n) * load_first(count, &products.ao[i]);
        } else if (products.visibility.sky.empty()) {
          sum = load_first(count, &products.direct[i]) * unoccluded(light, s.position, n);
        } else {
          const auto share_of = [&](std::size_t k) HWY_ATTR {
            return lit_share(*light.sources[k], products.visibility.sources[k], i, count);
          };
          sum = arriving(light, s, load_first(count, &products.visibility.sky[i]), share_of);
        }
        store_first(count, if_then_else_zero(s.surface, sum), &found[i]);
      });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(shares_of_row);
HWY_EXPORT(light_of_row);
HWY_EXPORT(lights_of_row);

namespace {

/// Adds what is emitted to the bounce `times` times.
void add_emitted(Products& products, float times) {
  const auto add = [&](const Plane<glm::vec3>& emitted, Plane<glm::vec3>& bounce) {
    for (std::size_t i = 0; i < emitted.size(); ++i) bounce[i] += times * emitted[i];
  };
  add(products.visibility.emitted, products.bounce);
  for (LightProducts& light : products.lights) add(light.emitted, light.bounce);
}

Products without_visibility(Products products) {
  products.visibility = {};
  for (LightProducts& light : products.lights) light.emitted = {};
  return products;
}

/// The direct light of each light, where there are several: methods that take lamps know the parts.
void find_lights(Products& products, const Scene& scene) {
  if (products.lights.size() < 2 || products.visibility.sky.empty()) return;
  const std::vector<LightGroup> lights = light_groups_of(scene.light);
  for (LightProducts& light : products.lights)
    light.direct = Plane<glm::vec3>::like(scene.geometry.surfaces);
  for_each_row(scene.geometry.surfaces.height, [&](int y) {
    HWY_DYNAMIC_DISPATCH(lights_of_row)(scene, lights, products, y);
  });
}

Products filter_found(const Filter& filter, Products noisy, const Scene& scene, int pattern_size,
                      const std::function<void(Products&)>& amend, bool as_visibility) {
  if (as_visibility) noisy = to_visibility(std::move(noisy), scene);
  if (filter.apply)
    noisy = filter_products(filter, std::move(noisy), scene.geometry.surfaces, pattern_size);
  add_sun_errors(noisy, scene);
  // Unfiltered, direct is the method's own, and so are its parts.
  if (!as_visibility) find_lights(noisy, scene);
  if (amend) amend(noisy);
  return noisy;
}

/// What the product `guessed` is made of.
struct Guesses {
  Plane<float> guessed, ao;
};

/// The mean of both over a pattern of kGuessedPattern pixels, whatever the method's pattern is.
Guesses mean_of_guesses(const Filter& filter, Guesses noisy, const Surfaces& guide) {
  if (!filter.apply) return noisy;
  FilterPlanes planes;
  planes.push_back({std::move(noisy.guessed), find_product("guessed").filtering});
  planes.push_back({std::move(noisy.ao), find_product("ao").filtering});
  planes = filter.apply(std::move(planes), guide, kGuessedPattern);
  return {std::get<Plane<float>>(std::move(planes[0].plane)),
          std::get<Plane<float>>(std::move(planes[1].plane))};
}

}  // namespace

Products find_visibility(const Filter& filter, Products noisy, const Scene& scene, int pattern_size,
                         const std::function<void(Products&)>& amend, bool as_visibility) {
  Guesses guesses;
  const Surfaces& guide = scene.geometry.surfaces;
  const bool have_guesses = !noisy.guessed.empty(), apart = pattern_size != kGuessedPattern;
  if (have_guesses && apart)
    guesses = mean_of_guesses(filter, {std::exchange(noisy.guessed, {}), noisy.ao}, guide);
  Products found =
      filter_found(filter, std::move(noisy), scene, pattern_size, amend, as_visibility);
  if (!have_guesses) return found;
  if (!apart) guesses.guessed = std::move(found.guessed), guesses.ao = found.ao;
  // A second mean: one alone leaves steps, eight pixels apart, where the rays of neighbouring
  // pixels pass different things.
  guesses = mean_of_guesses(filter, std::move(guesses), guide);
  for (std::size_t i = 0; i < guesses.ao.size(); ++i)
    guesses.guessed[i] = guessed_product(guesses.guessed[i], std::clamp(guesses.ao[i], 0.0f, 1.0f));
  found.guessed = std::move(guesses.guessed);
  return found;
}

Products light_of_visibility(Products found, const Scene& scene, bool as_visibility) {
  add_specular(found, scene);
  return as_visibility ? from_visibility(std::move(found), scene)
                       : without_visibility(std::move(found));
}

Products filter_visibility(const Filter& filter, Products noisy, const Scene& scene,
                           int pattern_size, const std::function<void(Products&)>& amend) {
  const bool as_visibility = filter.apply != nullptr;
  return light_of_visibility(
      find_visibility(filter, std::move(noisy), scene, pattern_size, amend, as_visibility), scene,
      as_visibility);
}

Products to_visibility(Products products, const Scene& scene) {
  add_emitted(products, -1);
  if (!products.visibility.sky.empty() || products.visibility.are_ao) products.direct = {};
  if (products.direct.empty() && products.bent.empty()) return products;
  for_each_row(scene.geometry.surfaces.height, [&](int y) {
    HWY_DYNAMIC_DISPATCH(shares_of_row)(scene, products, y);
  });
  return products;
}

Products from_visibility(Products products, const Scene& scene) {
  add_emitted(products, 1);
  find_lights(products, scene);
  // The light of the sky's share takes its place.
  if (products.visibility.are_ao) products.direct = Plane<glm::vec3>::like(scene.geometry.surfaces);
  if (!products.direct.empty() || !products.visibility.sky.empty() || !products.bent.empty()) {
    for_each_row(scene.geometry.surfaces.height, [&](int y) {
      HWY_DYNAMIC_DISPATCH(light_of_row)(scene, products, y);
    });
  }
  if (!products.visibility.sky.empty()) products.direct = std::move(products.visibility.sky);
  return without_visibility(std::move(products));
}

}  // namespace ssdo
#endif
