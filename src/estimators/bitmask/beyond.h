// SPDX-License-Identifier: Apache-2.0
//
// How much light comes through what may go on beyond the frame.
//
// A surface at the frame's border may go on (bitmask/extension-inl.h) or end there. For ao and for
// light that bounces it goes on: in the mean of five scenes that has less error than an end there,
// though walls that end just outside of the picture make a room too dark. For light from outside,
// of a map that is not the same from everywhere, neither holds: a corner, a lawn and a room that is
// open in front have less error with open borders, a street and a court with surfaces that go on.
// The mean ao of the frame did not tell them apart. So half of the light comes through.
//
// A sun is all or nothing, and there the frame does tell: a ray that leaves it meets about as much
// beyond it as rays meet in it, even where the border shows sky. Dense frames go on as streets and
// courts do, open ones as open ground.
//
//   sun past the border = min(1, A / 0.6),   A the mean ao of the frame's surfaces
//
// Where a panorama shows what stands there, all that it does not hide comes through.
//
// Relative RMSE of direct light against a path tracer before and after, and, where there is a sun,
// A and the share of it that has the least error. Alley, colonnade, court, close-up and stones are
// small scenes that were made to test the rule:
//
//   corner       0.41 0.27              foliage      0.21 0.19
//   room corner  0.18 0.09              spheres      0.046 0.044
//   alley        1.51 1.12  0.30  0.5   props        0.11 0.11  0.64  1
//   colonnade    0.88 0.91  0.32  0.8   still life   0.14 0.14  0.68  1
//   street       0.94 0.81  0.37  0.6   close-up     0.29 0.29  0.73  0.9
//   court        0.64 0.55  0.48  0.7   stones       0.11 0.11  0.78  1
//
// Bounce, which this light feeds: 0.50 to 0.49 in the mean of corner, foliage, props, spheres and
// street (corner 0.53 to 0.44, street 0.48 to 0.53), room corner 0.28 to 0.31.
#pragma once

#include "estimators/bitmask/march_scene.h"
#include "estimators/bitmask/slice_pattern.h"
#include "estimators/estimator.h"

namespace ssdo {

/// Share of the light of a map that comes through surfaces that may go on beyond the frame.
inline constexpr float kLightThroughBeyond = 0.5f;

/// The slices in which one pixel of each pattern looks for the mean ao of a frame: the same for
/// every quality and seed.
SlicePattern mean_ao_pattern(const Interleaving& layout, const Window& display);

/// Adds the ao of surfaces in some rows of a raster, 0..1 each, where surfaces go on beyond the
/// frame. `radius` in scene units, or infinity.
void add_ao(const MarchScene& scene, const Window& display, float radius, const Window& rows,
            AoSum& sum);

/// That of the receivers of a band.
void add_ao(const Scene& band, const Request& request, AoSum& sum);

/// Whether the mean counts for the light that is asked for.
bool needs_mean_ao(const Scene& scene, const Request& request);

/// Whether the overview around a band does not tell it well enough.
bool band_needs_mean_ao(const Scene& overview, const Request& request);

/// The mean of the whole raster, whatever its receivers are; 1 without surfaces.
float mean_ao(const MarchScene& scene, const Window& display, float radius);

/// Share of a sun's light, 0..1, that reaches a receiver past the frame's border where no surface
/// that goes on hides it. `mean_ao` is that of the frame.
float sun_past_beyond(float mean_ao);

/// Shares of the rays to a source, 0..1: of those that leave the frame and that nothing hides which
/// goes on beyond it, and of those that something does.
struct PassBeyond {
  float past = 1, through = 0;
};

/// Those of a source of which harmonics would hold the share `held`. From a quarter on, as of a
/// disc of 11 degrees, it is as sky; suns and what is between are less so. Relative error of direct
/// light of a room under two soft boxes: 0.141 if it is sky by `held` alone, 0.093 so.
PassBeyond pass_beyond(float sun_past, float held);

}  // namespace ssdo
