// SPDX-License-Identifier: Apache-2.0
//
// Uneven frames with noise in every product, for filters whose vector loops are held to slow ones.
#pragma once

#include <glm/geometric.hpp>
#include <random>

#include "estimators/estimator.h"

namespace ssdo::test {

using Random = std::mt19937;

float between(Random& random, float low, float high);

glm::vec3 vector_of(Random& random, float size);

/// Uneven surfaces with steps between them, a tenth of them missing.
Geometry random_geometry(int width, int height, unsigned seed);

/// All products, with values on the background too, and the shares of a sky and two suns.
Products random_products(const Geometry& g, unsigned seed);

double difference(const glm::dvec3& a, const glm::dvec3& b);

struct Size {
  int width, height;
};
inline const Size kSizes[] = {{1, 1},   {1, 9},   {3, 2},  {5, 70},
                              {16, 16}, {17, 33}, {67, 5}, {131, 65}};

}  // namespace ssdo::test
