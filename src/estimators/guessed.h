// SPDX-License-Identifier: Apache-2.0
//
// How much of what a receiver sees rests on guesses. A method guesses what stands where no picture
// looks: behind what the frame shows, and beyond its border. Rays with the density of the cosine
// are followed until they meet a surface that a picture shows, or the radius ends. A ray is
// guessed if it meets none and has passed a place that no picture shows; whether the method took
// it for open or for hidden is then its guess.
#pragma once

#include <array>
#include <string_view>

#include "estimators/estimator.h"
#include "scene/scene.h"

namespace ssdo {

/// Where no picture looks.
enum class Unseen { left, right, top, bottom, behind_camera, behind_things };

/// A row for each Unseen, in their order.
struct UnseenPlace {
  std::string_view name;
  std::string_view remedy;  ///< what to render against it
};
inline constexpr std::array<UnseenPlace, 6> kUnseenPlaces = {
    {{"left", "overscan"},
     {"right", "overscan"},
     {"top", "overscan"},
     {"bottom", "overscan"},
     {"behind the camera", "a panorama"},
     {"behind things", "views from other sides"}}};

/// The share of each pixel's hemisphere that is guessed, weighed by the cosine, 0..1; 0 where there
/// is no surface. Of the pixels of `part`, which are numbered from the first of the geometry's
/// window. `radius` in scene units, or infinity.
Plane<float> guessed_shares(const Scene& scene, const Window& part, float radius, unsigned seed,
                            const Progress& progress);

/// The mean of these over a frame.
struct GuessedMean {
  float all = 0;
  std::array<float, kUnseenPlaces.size()> at{};  ///< by Unseen; their sum is all
};

/// From a few of the pixels of the display window: the same for every seed.
GuessedMean mean_guessed(const Scene& scene, float radius);

}  // namespace ssdo
