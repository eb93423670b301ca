// SPDX-License-Identifier: Apache-2.0
//
// How much light comes through what may go on beyond the frame.
//
// A surface at the frame's border may go on (border/extension-inl.h) or end there. For ao and for
// light that bounces it goes on: in the mean of five scenes that has less error than an end there,
// though walls that end just outside of the picture make a room too dark. For light from outside,
// of a map that is not the same from everywhere, neither holds: a corner, a lawn and a room that is
// open in front have less error with open borders, a street and a court with surfaces that go on.
// The mean ao of the frame did not tell them apart. So half of the light comes through.
//
// Surfaces that go on hide a sun as far as they are likely to (border/border_extents.h). Past
// them a sun is seen, unless the place is closed: a room shows in a frame as walls above the
// horizon without sky over them. There a ray that leaves the frame meets about as much beyond it as
// rays meet in it:
//
//   sun past the border = 1 - closed (1 - min(1, A / 0.6)^2)
//   closed = min(1, 3 H) W / (W + 10 S)
//
// A is the mean ao of the frame's surfaces, H the share of the frame above the horizon, W and S the
// sums of the squared sines of elevation over pixels of it that show surfaces and sky. A frame that
// looks down tells nothing. Sky low in a frame is that of a window. All of it changes smoothly with
// the camera.
//
// With a panorama nothing is dimmed past the border: only surfaces that go on hide, as far as it
// does not show their end.
//
// Fitted to small scenes that were made for it, two rooms, a courtyard, five streets and five
// alleys, each under several suns, against a ray caster: RMSE of direct light over its largest
// value, with A / 0.6 for all frames and surfaces that go on without end, with nothing but those of
// border_extents.h, and with both:
//
//   open set    0.229 0.106 0.103      with overscan   courtyard 0.078 - 0.059
//   courtyard   0.153 0.139 0.135                      streets   0.172 - 0.159
//   streets     0.196 0.169 0.169                      alleys    0.196 - 0.131
//   rooms       0.150 0.257 0.145                      room      0.115 - 0.118
#pragma once

#include <glm/vec3.hpp>

#include "estimators/bitmask/border/border_extents.h"
#include "estimators/bitmask/border/offscreen_visibility.h"
#include "estimators/bitmask/march_scene.h"
#include "estimators/bitmask/slice_pattern.h"
#include "estimators/estimator.h"
#include "scene/light/light.h"
#include "scene/light/source.h"

namespace ssdo {

/// Share of the light of a map that comes through surfaces that may go on beyond the frame.
inline constexpr float kLightThroughBeyond = 0.5f;

/// The slices for the mean ao of a frame, in one pixel of each pattern: the same for every quality
/// and seed.
SlicePattern mean_ao_pattern(const Interleaving& layout, const Window& display);

/// Adds the enclosure of some rows of a raster, from one pixel of each pattern, with ao where
/// surfaces go on beyond the frame. `up` unit, in camera space; `radius` in scene units, or
/// infinity.
void add_enclosure(const MarchScene& scene, const Window& display, const glm::vec3& up,
                   float radius, const Window& rows, Enclosure& sum);

/// Adds the enclosure of the receivers of a band.
void add_enclosure(const Scene& band, const Request& request, Enclosure& sum);

/// The way up in camera space, unit.
glm::vec3 up_in_camera(const Scene& scene);

/// Whether part of a source lies behind a plane, unit `normal`: rays to it from in front of the
/// plane meet the plane.
bool is_behind(const Source& source, const glm::vec3& position, const glm::vec3& normal);

/// The planes that rays to any of the sources of a light meet, which has to outlive this.
MayMeetPlane met_by_rays_to_sources(const Light& light);

/// Whether the enclosure of the frame changes the light that is asked for.
bool needs_enclosure(const Scene& scene, const Request& request);

/// Whether bands have to be read once more for the enclosure of the frame, which the overview does
/// not give to the bit.
bool band_needs_enclosure(const Scene& overview, const Request& request);

/// The enclosure of all of a frame.
Enclosure enclosure_of(const MarchScene& scene, const Scene& frame, float radius);

/// Share of a sun's light, 0..1, that reaches a receiver past the frame's border where no surface
/// that goes on hides it.
float offscreen_sun_visibility(const Enclosure& frame);

/// The same where enclosure changes the light that is asked of a scene; else 1.
float offscreen_sun_visibility_of(const Enclosure& frame, const Scene& scene,
                                  const Request& request);

/// The same of a frame or, for a band, of the frame around it.
float offscreen_sun_visibility(const MarchScene& scene, const Scene& frame, const Request& request);

/// The shares for one source. A source of which harmonics would keep 0.25 or more (a disc of 11
/// degrees) is treated as sky, and a smaller one the less so. Relative error of direct light of a
/// room under two soft boxes: 0.141 if a source is sky by Source::sh_fraction alone, 0.093 so.
///
/// A place that is closed against the sky is not closed against a lamp, which stands in it: only
/// surfaces that go on hide a source that is not endlessly far.
OffscreenVisibility offscreen_visibility(float offscreen_sun, const Source& source);

}  // namespace ssdo
