// SPDX-License-Identifier: Apache-2.0
//
// A learned prior for what no picture shows. A method decides by rules whether directions are open
// or hidden about which the frame tells nothing; G of estimators/guessed.h is the share of such
// directions. A small network that was trained on made scenes (data/prior) says for each place how
// far to lean to either side, from the geometry of the pixel and the frame around it. Directions
// that are known stay as they are:
//
//   ao' = lo + (hi - lo) sigmoid(logit s + shift),   s = (ao - lo) / (hi - lo)
//   lo = max(ao - g, 0),   hi = min(ao + g, 1),   g = guessed_product(G, ao)
//
// With u = sigmoid(shift) the sigmoid above is s u / (s u + (1 - s) (1 - u)), which needs no
// exponentials in each pixel; u = 1/2 leaves ao as it is, and so does g = 0. s is held to
// 0.02..0.98, beyond which only a share of that can be gained.
//
// The network also gives the change m' - m of m, the cosine-weighted mean of V d over directions d,
// V the visibility. Here m is what light with directions uses, halfway between surfaces that go on
// beyond the border and surfaces that end there. Of a sky with the radiance c0 + c . d, irradiance
// over pi is c0 ao + c . m, so that its share of the unoccluded E changes by
//
//   (c0 (ao' - ao_half) + c . (m' - m)) / E,   ao_half = ao + opens / 2
//
// c0 and c are the first two bands of a sky. Light with directions takes a part of this change, see
// kPartOfSky. Over families of made scenes that the training never
// saw, the error of light is 0.58 of that by rules with ao' alone, and 0.54 with moments. The bent
// normal leans as m does: mean of V d = bent |m| + m' - m, |m| that of a cone with ao_half. Its
// mean error there falls from 10 degrees to 8 (things on a plane), and from 25 to 21 (courts).
//
// Of the sky's light that a rough surface mirrors, the march tells the share that comes along
// guessed rays, and which part s of that the rules let through. That part becomes the sigmoid above
// of s. A linear function of the direction from ao' and m' was three times as wrong.
//
// What is found to be hidden, beyond what the rules hide, sends the mean radiance L of what the
// frame shows, and what is found to be open sends nothing:
//
//   bounce' = bounce (1 - ao') / (1 - ao) if ao' > ao, else bounce + (ao - ao') L
//
// with senders lit by ao'. Error of one bounce in a white world in the unseen families: 0.81 of the
// mean by rules, 0.59 so; with the factor mean of albedo ao' / albedo ao for all senders 0.61, with
// lit senders alone 0.67.
//
// All of it is found on a coarse grid (prior/prior_grid.h). Values are interpolated between the
// four squares around a pixel, by how far these show its surface (scene/same_surface.h).
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "estimators/estimator.h"
#include "prior/inputs.h"
#include "prior/prior_grid.h"

namespace ssdo {

/// Width in pixels of the border around a part on whose values the prior of the part depends,
/// beside the means of the display window.
inline constexpr int kPriorReach = 48;

/// s is held to kLeastShare..1 - kLeastShare.
inline constexpr float kLeastShare = 0.02f;

/// The part of its change that the sky's light takes, and the share of a sun that comes past the
/// border: in scenes that were built by others than those that trained it (data/blender/proof.py),
/// direct light by the prior alone is little better than by rules, and four times as wrong in one
/// of them; with half of the change of the sky one is worse by 8 %, with a quarter none.
inline constexpr float kPartOfSky = 0.25f, kPartOfSun = 0.5f;

/// The part of its change that ao takes within a radius: kPartWithinRadius, and more with one that
/// is many times as large as the frame at its median depth; all of it without a radius. Of the same
/// scenes, one that shows a set is worse by a tenth within a radius if all is taken.
inline constexpr float kPartWithinRadius = 0.5f;
float part_of_ao(const Geometry& geometry, float radius);

/// What the prior says, by square.
struct PriorField {
  PriorGrid grid;
  Plane<float> visibility_bias;        ///< u - 1/2; 0: as the rules say
  Plane<float> change;                 ///< ao' - ao
  Plane<float> offscreen_sun;          ///< share of a sun, see by_pixel()
  Plane<float> open_border_gain;       ///< how much more is open if surfaces end at the border
  std::array<Plane<float>, 3> moment;  ///< x, y, z in camera space of m' - m
  Plane<float> spread;                 ///< expected |error| of ao'
  float part;            ///< the part of `visibility_bias` that ao takes; see part_of_ao()
  PriorContext context;  ///< of the frame
};

/// Selects the model, with a known direction `up`, unit, in camera space, or without; `radius` is
/// in scene units, or infinity.
struct PriorSettings {
  std::optional<glm::vec3> up;
  float radius;
  unsigned seed;
  const PriorContext* of_frame = nullptr;  ///< where the scene is a band of a frame
};

/// Looks at the pixels of `question.part`.
PriorField find_prior(const PriorQuestion& question, const PriorSettings& asked);

/// The field interpolated between squares, by pixel. The share of a sun that comes past the border
/// is 1 - (1 - r)^2 where nothing shown hides the sun; r = ao' / ao with open borders is the open
/// share of the directions that nothing shown hides. Error of the visibility of a sun in seven
/// families of made scenes that the training never saw, over that with offscreen_sun_visibility():
/// 0.98, in the worst of them 1.04. With 1 - (1 - r)^1.5 it is 0.96 (1.08), but a lit floor in an
/// open set has 0.89 of its sun, for 0.95. The answer lies between that and `offscreen_sun`, as
/// PriorQuestion has it.
LearnedVisibility by_pixel(const PriorField& field, const Geometry& geometry, float offscreen_sun);

/// For Request: answers, and keeps in `field` what the prior said.
AskPrior ask_prior(const PriorSettings& asked, std::optional<PriorField>& field);

/// Changes ao, the shares of the sky and the bounce after the filter, before light is made of them.
void apply_prior(const PriorField& field, const Scene& scene, Products& products);

/// Changes bent, where it was made, and makes `guessed` of the expected error, where that is
/// wanted; both after light was made.
void finish_with_prior(const PriorField& field, const Scene& scene, bool wants_guessed,
                       Products& products);

/// One line: what it is, and what it was trained on.
std::string describe_prior(bool up_is_known);

}  // namespace ssdo
