// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/beyond.h"

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/march.h"
#include "estimators/bitmask/parts.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod, kSlices = 8, kSteps = 16;

/// The mean ao of a frame from which on all of a sun comes past the border.
constexpr float kOpenFrame = 0.6f;

}  // namespace

SlicePattern mean_ao_pattern(const Interleaving& layout, const Window& display) {
  return {layout, display, kSlices, kSteps, 0, kPeriod};
}

void add_ao(const MarchScene& scene, const Window& display, float radius, const Window& rows,
            AoSum& sum) {
  const Interleaving& layout = scene.layout;
  const SlicePattern sparse = mean_ao_pattern(layout, display);
  InterleavedPlane ao(layout);
  VisibilityJob job{.march = {scene, sparse, radius, true}, .ao = &ao};
  for_each_band_of(rows, [&](const Window& part) { march_visibility(job, part); }, {});
  // The first member of a pattern is the one that marches.
  const int first_y = rows.y0 + (-(rows.y0 + scene.first_y) & (kPeriod - 1));
  for (int y = first_y; y < rows.y1; y += kPeriod) {
    for (int x = -layout.phase() & (kPeriod - 1); x < layout.width(); x += kPeriod) {
      const std::ptrdiff_t i = layout.index(x, y);
      if (std::isnan(scene.depth()[i])) continue;
      sum.ao += double(ao[i]);
      sum.surfaces += 1;
    }
  }
}

void add_ao(const Scene& band, const Request& request, AoSum& sum) {
  const MarchScene scene = make_march_scene(band.geometry, band.solids, request.receivers);
  add_ao(scene, band.geometry.display, request.radius, scene.receivers, sum);
}

bool needs_mean_ao(const Scene& scene, const Request& request) {
  const ProductSet& products = request.products;
  // A panorama shows what stands beyond the border, and rays have asked it.
  const bool all_is_shown =
      std::any_of(scene.views.begin(), scene.views.end(),
                  [](const FurtherView& view) { return view.picture->closed; });
  return (products.direct || products.bounce || products.error) && !scene.light.suns.empty() &&
         request.extend_offscreen && !all_is_shown;
}

bool band_needs_mean_ao(const Scene& overview, const Request& request) {
  // The mean of an overview is off by less.
  constexpr float kOff = 0.1f;
  return needs_mean_ao(overview, request) && request.around_band->far->mean_ao < kOpenFrame + kOff;
}

float mean_ao(const MarchScene& scene, const Window& display, float radius) {
  AoSum sum;
  add_ao(scene, display, radius, scene.raster(), sum);
  return sum.mean();
}

float sun_past_beyond(float mean_ao) { return std::min(1.0f, mean_ao / kOpenFrame); }

PassBeyond pass_beyond(float sun_past, float held) {
  constexpr float kSky = 0.25f;
  const float sky = std::min(1.0f, held / kSky);
  return {sun_past + sky * (1 - sun_past), sky * kLightThroughBeyond};
}

}  // namespace ssdo
