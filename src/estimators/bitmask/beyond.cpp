// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/beyond.h"

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/march.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod;

// Of one pixel in each pattern, for the mean of a frame: the same for every quality and seed.
constexpr int kSlices = 8, kSteps = 16;

}  // namespace

float mean_ao(const MarchScene& scene, const Window& display, float radius) {
  const Interleaving& layout = scene.layout;
  const SlicePattern sparse(layout, display, kSlices, kSteps, 0, kPeriod);
  InterleavedPlane ao(layout);
  VisibilityJob job{.march = {scene, sparse, radius, true}, .ao = &ao};
  for_each_band(layout.height(),
                [&](int y0, int y1) {
                  march_visibility(job, {0, y0, layout.width(), y1});
                },
                {});
  // The first member of a pattern is the one that marches.
  double sum = 0, count = 0;
  for (int y = -scene.first_y & (kPeriod - 1); y < layout.height(); y += kPeriod) {
    for (int x = -layout.phase() & (kPeriod - 1); x < layout.width(); x += kPeriod) {
      const std::ptrdiff_t i = layout.index(x, y);
      if (std::isnan(scene.depth()[i])) continue;
      sum += double(ao[i]);
      count += 1;
    }
  }
  return count > 0 ? float(sum / count) : 1.0f;
}

float sun_past_beyond(float mean_ao) {
  constexpr float kOpenFrame = 0.6f;
  return std::min(1.0f, mean_ao / kOpenFrame);
}

PassBeyond pass_beyond(float sun_past, float held) {
  constexpr float kSky = 0.25f;
  const float sky = std::min(1.0f, held / kSky);
  return {sun_past + sky * (1 - sun_past), sky * kLightThroughBeyond};
}

}  // namespace ssdo
