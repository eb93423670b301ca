// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "estimators/bitmask.h"
#include "scene/light/light.h"
#include "scene/solids/solids.h"
#include "support/analytic_scene.h"
#include "support/scene_of.h"

namespace ssdo::test {

constexpr float kNoLimit = std::numeric_limits<float>::infinity();
constexpr double kPi = glm::pi<double>();

/// What a test asks of method bitmask. The defaults have converged: any 4 x 4 pixels of the pattern
/// have 192 slices together, evenly spread, and steps visit every pixel within a few hundred. What
/// is left is the pixel itself: an edge is seen half a pixel late, so closed forms need a radius of
/// many pixels.
struct BitmaskRequest {
  float radius = 1;
  Environment environment = Environment::constant(glm::vec3(1));
  ProductSet products = {.ao = true};
  int slices = 12, steps = 2048;
  const Solids* solids = nullptr;
  bool extend = true;
  float albedo = 0.8f;
  int bounces = 0;
  Plane<glm::vec3> radiance = {};
  Window receivers = {};
  unsigned seed = 0;
};

inline Products run(const Geometry& geometry, const BitmaskRequest& request) {
  Scene scene = scene_of(geometry, request.environment, request.albedo);
  scene.senders.radiance = request.radiance;
  if (request.solids) scene.solids = *request.solids;
  ProductSet products = request.products;
  products.bounce = request.bounces > 0;
  return bitmask_method().estimate(scene,
                                   {.products = products,
                                    .radius = request.radius,
                                    .bounces = request.bounces,
                                    .seed = request.seed,
                                    .slices = request.slices,
                                    .steps = request.steps,
                                    .extend_offscreen = request.extend,
                                    .receivers = request.receivers},
                                   {});
}

/// The same frame cut from a wider one: its middle still looks from the same eye at the same
/// target, along a ray that leaves the optical axis at these slopes. (1, 0) is 45 degrees.
inline Camera off_axis(Camera camera, const Window& window, const glm::dvec2& slope) {
  camera.cx = 0.5 * (window.x0 + window.x1) - camera.fx * slope.x;
  camera.cy = 0.5 * (window.y0 + window.y1) + camera.fy * slope.y;
  // The rotation that takes the axis to the ray (Rodrigues).
  const glm::dvec3 axis(0, 0, -1), ray = glm::normalize(glm::dvec3(slope, -1)),
                                   v = glm::cross(axis, ray);
  const glm::dmat3 cross(0, v.z, -v.y, -v.z, 0, v.x, v.y, -v.x, 0);
  camera.rotation =
      (glm::dmat3(1) + cross + cross * cross / (1 + glm::dot(axis, ray))) * camera.rotation;
  return camera;
}

/// A floor that ends at the foot of an endless wall, which faces the cameras of `tilted`.
inline Surface floor_and_wall() {
  return all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 0; }),
                 cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; })});
}

/// A point of a surface, in world space.
struct Point {
  glm::dvec3 position, normal;
};

/// What a pixel shows, in double.
inline Point point_at(const Surface& scene, const Camera& camera, const Window& window, int x,
                      int y) {
  const Ray ray = ray_through(camera, window.x0 + x + 0.5, window.y0 + y + 0.5);
  const Hit hit = scene(ray).value();
  const bool away = glm::dot(hit.normal, ray.direction) > 0;
  return {ray.origin + hit.distance * ray.direction, away ? -hit.normal : hit.normal};
}

/// The square of 2 `half` pixels around the middle of a frame that begins at (0, 0).
inline Window middle_square(const Window& window, int half = 2) {
  const int x = window.width() / 2, y = window.height() / 2;
  return {x - half, y - half, x + half, y + half};
}

/// Mean of `value(x, y)` over that square. With an even `half` the slices of its pixels are evenly
/// spread.
template <class Value>
auto middle(const Window& window, const Value& value, int half = 2) {
  const Window square = middle_square(window, half);
  auto sum = value(square.x0, square.y0) * 0.0;
  for (int y = square.y0; y < square.y1; ++y) {
    for (int x = square.x0; x < square.x1; ++x) sum += value(x, y) / (4.0 * half * half);
  }
  return sum;
}

/// Of a plane over `receivers`, what the pixel (x, y) of their frame has.
template <class T>
T at_pixel(const Plane<T>& plane, const Window& receivers, int x, int y) {
  return plane(x - receivers.x0, y - receivers.y0);
}

/// Calls `visit(direction)` for `count` directions with the density of the cosine: a Fibonacci
/// spiral on the disc, lifted to the hemisphere.
template <class Visit>
void for_each_cosine_direction(const glm::dvec3& normal, int count, const Visit& visit) {
  const glm::dvec3 side = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 t = glm::normalize(glm::cross(side, normal)), b = glm::cross(normal, t);
  for (int i = 0; i < count; ++i) {
    const double r2 = (i + 0.5) / count, azimuth = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(r2);
    visit(r * std::cos(azimuth) * t + r * std::sin(azimuth) * b + std::sqrt(1 - r2) * normal);
  }
}

/// Whether a ray from `p` meets nothing within the radius.
inline bool is_open(const Surface& scene, const Point& p, const glm::dvec3& direction,
                    double radius) {
  const auto hit = scene({p.position + 1e-7 * p.normal, direction});
  return !hit || hit->distance > radius;
}

/// The definition of ao by rays.
inline double ao_by_rays(const Surface& scene, const Point& p, double radius, int rays = 1 << 16) {
  int open = 0;
  for_each_cosine_direction(p.normal, rays,
                            [&](const glm::dvec3& d) { open += is_open(scene, p, d, radius); });
  return double(open) / rays;
}

/// Share of the unit disc on one side of a line at distance c from its middle. What a wall hides
/// within R is just that in the disc below the hemisphere (Nusselt), c = x / R: a direction whose
/// foot is (u, v) meets the wall at distance x / u.
inline double disc_segment(double c) {
  return c >= 1 ? 0 : (std::acos(c) - c * std::sqrt(1 - c * c)) / kPi;
}

}  // namespace ssdo::test
