// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/find_reflection.h"

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "estimators/bitmask/border/border_light.h"
#include "estimators/bitmask/parts.h"
#include "estimators/bitmask/rays/bright_level.h"
#include "estimators/bitmask/rays/depth_bounds.h"
#include "estimators/guessed.h"
#include "estimators/specular/mirror_model.h"

namespace ssdo {
namespace {

/// Rays into what is mirrored, for every slice.
constexpr int kReflectionRays = 2;

}  // namespace

void find_reflection(const ReflectionInput& input, Products& products, const Progress& progress) {
  const March& march = input.march;
  const Raster& raster = input.raster;
  const Scene& scene = input.scene;
  const Request& request = input.request;
  const InterleavedVectors& sent = input.sent;
  const Interleaving& layout = march.scene.layout;
  InterleavedPlane roughness(layout), open;
  for_each_row(layout.height(), [&](int y) {
    roughness.fill_row(layout, y, float(request.parameters.at("roughness")));
    if (scene.roughness.empty()) return;
    raster.for_each_pixel(
        y, [&](std::size_t pixel, std::ptrdiff_t i) { roughness[i] = scene.roughness[pixel]; });
  });
  if (request.products.reflection) open = InterleavedPlane(layout);
  std::optional<MirroredLightJob> light;
  InterleavedVectors sky, surfaces;
  std::array<BorderValues, 3> beyond;
  std::optional<GuessedRays> guesses;
  InterleavedPlane guessed, guessed_open;
  if (request.products.specular) {
    products.visibility.mirror = std::make_shared<const MirrorModel>(scene, request);
    sky = raster.make_color(), surfaces = raster.make_color();
    const bool sends = sent[0].data() != nullptr;
    if (sends) {
      const float level = bright_level({march.scene, sent, input.two_sided, input.lit}).bright;
      const SentAtBorder at_border = sent_at_border(march.scene, sent, input.two_sided);
      beyond = light_beyond(at_border, at_border, level);
    }
    light.emplace(MirroredLightJob{*products.visibility.mirror, scene.specular_color,
                                   sends ? &sent : nullptr, input.two_sided,
                                   sends ? beyond.data() : nullptr, &sky, &surfaces});
    if (request.ask_prior) {
      guesses.emplace(scene, request.radius);
      guessed = InterleavedPlane(layout), guessed_open = InterleavedPlane(layout);
      light->guesses = &*guesses, light->guessed = &guessed, light->guessed_open = &guessed_open;
    }
  }
  const std::vector<DepthBounds> bounds = depth_bounds(march.scene);
  const ReflectionJob job{march,
                          bounds,
                          &roughness,
                          kReflectionRays * request.slices,
                          request.seed,
                          open.data() ? &open : nullptr,
                          light ? &*light : nullptr};
  for_each_band_of(
      march.scene.receivers, [&](const Window& part) { march_reflection(job, part); }, progress);
  if (open.data()) products.reflection = raster.picture(std::move(open), 1.0f);
  if (!light) return;
  products.visibility.mirrored_sky = raster.picture(std::move(sky));
  if (guesses) {
    products.visibility.mirrored_guessed = raster.picture(std::move(guessed));
    products.visibility.mirrored_guessed_open = raster.picture(std::move(guessed_open));
  }
  products.specular = raster.picture(std::move(surfaces));
}

}  // namespace ssdo
