// SPDX-License-Identifier: Apache-2.0
#include "support/random_frame.h"

#include <type_traits>

namespace ssdo::test {
namespace {

/// A value of a product as methods before a filter make it.
float random_value(Random& random, ProductKind kind, float) {
  return between(random, kind == ProductKind::share ? 0.0f : -1.0f, 1);
}
glm::vec3 random_value(Random& random, ProductKind kind, const glm::vec3&) {
  const glm::vec3 v = vector_of(random, 1);
  return kind == ProductKind::direction ? glm::normalize(glm::vec3(0, 0, 1.5f) + v) : v;
}

}  // namespace

float between(Random& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

glm::vec3 vector_of(Random& random, float size) {
  const float x = between(random, -size, size), y = between(random, -size, size);
  return {x, y, between(random, -size, size)};
}

Geometry random_geometry(int width, int height, unsigned seed) {
  Random random(seed);
  Geometry g;
  g.window = g.display = {0, 0, width, height};
  g.surfaces = Surfaces(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (between(random, 0, 1) < 0.1f) continue;
      const int step = (x / 7 + y / 5) % 3;
      const glm::vec3 p = glm::vec3(0.1f * float(x), -0.1f * float(y), -5 - float(step)) +
                          vector_of(random, 0.01f),
                      n = glm::vec3(0.3f * float(step), 0, 1) + vector_of(random, 0.25f);
      g.surfaces.set(x, y, {p, glm::normalize(n), 1e-3f * between(random, 0, 1)});
    }
  }
  return g;
}

Products random_products(const Geometry& g, unsigned seed) {
  Random random(seed);
  Products products;
  for_each_plane(
      [&](const Product& product, auto& plane) {
        plane = std::decay_t<decltype(plane)>::like(g.surfaces);
        for (auto& value : plane.pixels) value = random_value(random, product.kind, value);
      },
      products);
  products.visibility.sources.resize(2);
  for_each_visibility(
      [&](auto& plane) {
        plane = std::decay_t<decltype(plane)>::like(g.surfaces);
        for (auto& value : plane.pixels) value = random_value(random, ProductKind::light, value);
      },
      products);
  return products;
}

double difference(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b); }

}  // namespace ssdo::test
