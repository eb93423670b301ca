// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/border/beyond.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/parts.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod, kSlices = 8, kSteps = 16;

/// The mean ao of a frame from which on all of a sun's light passes the border.
constexpr float kOpenFrame = 0.6f;

/// The weight of sky over that of walls, and the share of a frame above the horizon from which on
/// the frame counts in full.
constexpr double kSkyTells = 10, kAboveTellsAll = 1 / 3.0;

/// The sine of elevation from which on a pixel counts in full as above the horizon; gradual,
/// because all pixels of an orthographic camera cross the horizon together.
constexpr double kAllAbove = 0.1;

bool is_endlessly_far(const Source& source) {
  return std::isinf(source.cone(glm::vec3(0)).distance);
}

/// The sine of elevation at which a pixel looks, where that is above the horizon; else 0.
float sine_above_horizon(const MarchScene& scene, int x, int y, const glm::vec3& up) {
  const glm::vec2 slope = scene.orthographic ? glm::vec2(0) : ray_slope(scene, x, y);
  return std::max(0.0f, glm::dot(glm::normalize(glm::vec3(slope, -1)), up));
}

}  // namespace

SlicePattern mean_ao_pattern(const Interleaving& layout, const Window& display) {
  return {layout, display, kSlices, kSteps, 0, kPeriod};
}

void add_enclosure(const MarchScene& scene, const Window& display, const glm::vec3& up,
                   float radius, const Window& rows, Enclosure& sum) {
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
      if (!scene.shows_surface(i) && !scene.shows_background(x, y)) continue;
      const double sine = double(sine_above_horizon(scene, x, y, up)), weight = sine * sine;
      sum.pixels += 1;
      sum.above += std::min(1.0, sine / kAllAbove);
      if (!scene.shows_surface(i)) {
        sum.sky += weight;
        continue;
      }
      sum.walls += weight;
      sum.ao += double(ao[i]);
      sum.surfaces += 1;
    }
  }
}

void add_enclosure(const Scene& band, const Request& request, Enclosure& sum) {
  const MarchScene scene =
      make_march_scene(band.casters(), band.solids, request.receivers,
                       band.caster_surfaces ? &band.geometry : nullptr, request.radius);
  add_enclosure(scene, band.geometry.display, up_in_camera(band), request.radius, scene.receivers,
                sum);
}

glm::vec3 up_in_camera(const Scene& scene) {
  return scene.geometry.world_to_camera[scene.light.environment.frame().up == UpAxis::z ? 2 : 1];
}

bool is_behind(const Source& source, const glm::vec3& position, const glm::vec3& normal) {
  constexpr float kRounding = 1e-3f;
  const SourceCone cone = source.cone(position);
  return glm::dot(cone.to, normal) < std::sin(cone.angular_radius) + kRounding;
}

MayMeetPlane met_by_rays_to_sources(const Light& light) {
  return [&light](const glm::vec3& position, const glm::vec3& normal) {
    return std::ranges::any_of(
        light.sources, [&](const auto& source) { return is_behind(*source, position, normal); });
  };
}

bool needs_enclosure(const Scene& scene, const Request& request) {
  const ProductSet& products = request.products;
  const auto& sources = scene.light.sources;
  const bool has_far = std::any_of(sources.begin(), sources.end(),
                                   [](const auto& source) { return is_endlessly_far(*source); });
  // A panorama shows what stands beyond the border, and rays are tested against it.
  const bool all_is_shown = std::any_of(scene.views.begin(), scene.views.end(),
                                        [](const OtherView& view) { return view.picture->closed; });
  return (products.direct || products.bounce || products.error) && has_far &&
         request.extend_offscreen && !all_is_shown;
}

bool band_needs_enclosure(const Scene& overview, const Request& request) {
  // The mean of an overview is off by less.
  constexpr double kOff = 0.1;
  const Enclosure& frame = request.around_band->far->enclosure;
  return needs_enclosure(overview, request) && frame.ao < (kOpenFrame + kOff) * frame.surfaces;
}

Enclosure enclosure_of(const MarchScene& scene, const Scene& frame, float radius) {
  Enclosure sum;
  add_enclosure(scene, frame.geometry.display, up_in_camera(frame), radius, scene.raster(), sum);
  return sum;
}

float offscreen_sun_visibility_of(const Enclosure& frame, const Scene& scene,
                                  const Request& request) {
  return needs_enclosure(scene, request) ? offscreen_sun_visibility(frame) : 1;
}

float offscreen_sun_visibility(const MarchScene& scene, const Scene& frame,
                               const Request& request) {
  if (!needs_enclosure(frame, request)) return 1;
  if (const auto& band = request.around_band)
    return offscreen_sun_visibility(band->enclosure.value_or(band->far->enclosure));
  return offscreen_sun_visibility(enclosure_of(scene, frame, request.radius));
}

float offscreen_sun_visibility(const Enclosure& frame) {
  if (frame.surfaces == 0) return 1;
  const double open = std::min(1.0, frame.ao / frame.surfaces / double(kOpenFrame)),
               told = std::min(1.0, frame.above / (kAboveTellsAll * frame.pixels)),
               walls = frame.walls / std::max(frame.walls + kSkyTells * frame.sky, 1e-30),
               closed = told * walls;
  return float(1 - closed * (1 - open * open));
}

OffscreenVisibility offscreen_visibility(float offscreen_sun, const Source& source) {
  constexpr float kSky = 0.25f;
  if (!is_endlessly_far(source)) return {};
  const float sky = std::min(1.0f, source.sh_fraction / kSky);
  return {offscreen_sun + sky * (1 - offscreen_sun), sky * kLightThroughBeyond};
}

}  // namespace ssdo
