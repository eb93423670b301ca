// SPDX-License-Identifier: Apache-2.0
//
// A learned prior for what no picture shows. A method takes directions that nothing in the frame
// decides for open or hidden by rules; how many they are, G of estimators/guessed.h says. A small
// network that was trained on made scenes (data/prior) says for each place how far to lean to
// either side, from the geometry of the pixel and the frame around it. Directions that are known
// stay as they are:
//
//   ao' = lo + (hi - lo) sigmoid(logit s + shift),   s = (ao - lo) / (hi - lo)
//   lo = max(ao - g, 0),   hi = min(ao + g, 1),   g = guessed_product(G, ao)
//
// With u = sigmoid(shift) the sigmoid above is s u / (s u + (1 - s) (1 - u)), which needs no
// exponentials in each pixel; u = 1/2 leaves ao as it is, and so does g = 0. s is held to
// 0.02..0.98, beyond which only a share of that can be gained.
//
// All of it is found on a coarse grid (prior/squares.h). G and u are interpolated between the four
// squares around a pixel, by how far these show its surface (scene/same_surface.h).
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>

#include "estimators/estimator.h"
#include "prior/squares.h"

namespace ssdo {

/// Pixels around a part whose values the prior of its pixels depends on, beside the means of the
/// display window.
inline constexpr int kPriorReach = 48;

/// What the prior says, by square.
struct PriorField {
  Squares squares;
  Plane<float> lean;  ///< u; 1/2: as the rules say
};

/// `found` are the products of a method before any filter, over the whole geometry: ao, open_ao and
/// bent are read, in the receivers of the request. `up` unit, in camera space; where it is not
/// known, a model that was trained without it is used.
PriorField find_prior(const Scene& scene, const Request& request, const Products& found,
                      const std::optional<glm::vec3>& up);

/// Changes ao after the filter, before light is made of it where that comes from everywhere alike.
/// The shares of a sky with directions are left as they are: scaled with ao, direct light has 0.56
/// of its error in families of made scenes that the training never saw, but 1.07 times its error,
/// and up to 1.7 times, in five path-traced frames.
void apply_prior(const PriorField& field, const Geometry& geometry, Products& products);

/// One line: what it is, and what it was trained on.
std::string describe_prior(bool up_is_known);

}  // namespace ssdo
