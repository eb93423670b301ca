// SPDX-License-Identifier: Apache-2.0
//
// How much of what a receiver sees rests on guesses. A method guesses what stands where no picture
// looks: behind what the frame shows, and beyond its border. Rays with the density of the cosine
// are followed until they meet a surface that a picture shows, or the radius ends. A ray is guessed
// if it meets none and has passed a place that no picture shows: the method could then only guess
// whether the ray is open or hidden.
//
// A guess costs little where its answer is plain. So the product weighs the share of guesses by how
// far the hemisphere is from being all open or all hidden:
//
//   guessed = G sqrt(0.99 4 ao (1 - ao) + 0.01 G^4),   G = 1/n sum of w over the guessed of n rays
//
// 4 ao (1 - ao) is the variance of the visibility of single rays over its greatest. That ao is
// itself a guess: where nothing is known, 0.1 is left of the weight. w is 1, and less behind
// things, where most rays are hidden and methods take them to be.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
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

/// w behind things. With 1, the rank correlation of the product with the error of ao in 120 made
/// scenes is 0.25 without a radius and 0.73 at a large one, with 1/2 it is 0.35 and 0.70, and with
/// less it falls at the large radius and hardly rises without one.
inline constexpr float kGuessBehindThings = 0.5f;

/// The rays of so many pixels in a row and in a column together cover the hemisphere.
inline constexpr int kGuessedPattern = 8;

/// G of the pixels of `part`, 0..1; 0 where there is no surface. Pixels are numbered from the first
/// of the geometry's window. `radius` in scene units, or infinity. filter_visibility() makes the
/// product from it.
Plane<float> guessed_shares(const Scene& scene, const Window& part, float radius, unsigned seed,
                            const Progress& progress);

/// G of single pixels, by one ray each: pixel numbers of the geometry by place in a grid whose
/// squares of kGuessedPattern x kGuessedPattern places, counted from `first`, together cover the
/// hemisphere. 0 where the number is kNoPixel.
inline constexpr std::int32_t kNoPixel = -1;
Plane<float> guessed_shares(const Scene& scene, const Plane<std::int32_t>& pixels,
                            const glm::ivec2& first, float radius, unsigned seed);

/// Tests single rays.
class GuessedRays {
 public:
  GuessedRays(const Scene& scene, float radius);
  ~GuessedRays();

  /// Whether a ray from a pixel of the geometry is guessed, the k-th of a pattern: others look at
  /// other places along their way.
  bool is_guessed(std::size_t pixel, const glm::vec3& to, int k) const;

 private:
  std::unique_ptr<const class RayFollower> rays_;
};

/// The product, of G and ao where noise is filtered out of both.
inline float guessed_product(float g, float ao) {
  return g * std::sqrt(0.99f * 4 * ao * (1 - ao) + 0.01f * g * g * g * g);
}

/// The share of guesses among all rays of a frame, by where; w is 1.
struct GuessedMean {
  float all = 0;
  std::array<float, kUnseenPlaces.size()> at{};  ///< by Unseen; their sum is all
};

/// From a few of the pixels of the display window: the same for every seed.
GuessedMean mean_guessed(const Scene& scene, float radius);

}  // namespace ssdo
