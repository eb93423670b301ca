// SPDX-License-Identifier: Apache-2.0
//
// Shadows of wide sources against rays in double to every texel, and sources at the horizon.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "estimators/trace_request.h"
#include "scene/light/painted_map.h"

namespace ssdo::test::sources_test {
namespace {

/// A black map with one disc that gives a surface facing it an irradiance of about pi.
Environment lamp(const glm::vec3& middle, float radius) {
  const float sine = std::sin(glm::radians(radius));
  return paint(512, [&](const glm::vec3& d) {
    return glm::vec3(in_disc(d, middle, radius) ? 1 / (sine * sine) : 0.0f);
  });
}

/// Light of a map on a surface over pi: a ray to every texel that is not black.
double direct_by_rays(const Surface& scene, const Point& p, const Environment& map) {
  double sum = 0;
  for (int y = 0; y < map.map()->height; ++y) {
    for (int x = 0; x < map.map()->width; ++x) {
      const float radiance = (*map.map())(x, y).x;
      if (radiance == 0) continue;
      const glm::dvec3 d(map.texel_direction(x, y));
      const double cosine = glm::dot(p.normal, d);
      if (cosine > 0 && is_open(scene, p, d, kNoLimit))
        sum += cosine * map.texel_solid_angle(y) * radiance / kPi;
    }
  }
  return sum;
}

/// A plate hovers over a floor, seen from above: the frame knows all of both.
TEST(TraceSources, ThrowTheShadowThatRaysSee) {
  const double height = 1;
  const Surface plate = cut(plane({0, 0, height}, {0, 0, 1}), [=](const glm::dvec3& p) {
    return std::abs(p.x) < 1 && std::abs(p.y) < 1.2;
  });
  const Surface scene = all_of({plane({}, {0, 0, 1}), plate});  // the frame holds all of the plate
  const Window window{0, 0, 240, 120};
  const Camera camera = tilted(camera_from_ortho_width(6, window, 1), 0, 6, {-1.5, 0, 0});
  const Geometry g = geometry_of(scene, camera, window);
  const Solids solids = constant_thickness(g, 1e-3f);
  for (const float radius : {5.5f, 10.0f, 20.0f}) {
    const Environment map = lamp(direction_of(0, 40), radius);
    const Products out = run_trace(g, {.radius = kNoLimit,
                                       .products = {.ao = true, .direct = true},
                                       .environment = map,
                                       .solids = &solids});
    const Point open{{100, 100, 0}, {0, 0, 1}};
    const double whole = direct_by_rays(scene, open, map);
    // Umbra, penumbra and what has all of the light.
    std::array<double, 3> off{}, count{};
    for (int y = 1; y < window.height(); y += 6) {
      for (int x = 1; x < window.width(); x += 2) {
        const Point p = point_at(scene, camera, window, x, y);
        if (p.position.z > 0.5) continue;
        const double exact = direct_by_rays(scene, p, map) / whole;
        const std::size_t part = exact < 0.02 ? 0 : exact < 0.98 ? 1 : 2;
        off[part] += double(out.direct(x, y).x) / whole - exact, ++count[part];
      }
    }
    fmt::print("disc of {} degrees: umbra {:+.4f}, penumbra {:+.4f}, lit {:+.4f} off\n", radius,
               off[0] / count[0], off[1] / count[1], off[2] / count[2]);
    for (int part = 0; part < 3; ++part) {
      ASSERT_GT(count[part], 10) << radius << " " << part;
      EXPECT_NEAR(off[part] / count[part], 0, 0.01) << radius << " " << part;
    }
  }
}

TEST(TraceSources, SetOnAnOpenPlane) {
  const Surface floor = plane({}, {0, 0, 1});
  const Window window{0, 0, 32, 24};
  const Geometry g = geometry_of(floor, tilted(camera_from_fov(30, window, 1), 30), window);
  for (const float radius : {4.5f, 12.0f}) {
    for (const float part : {-1.5f, -0.8f, 0.0f, 0.5f, 0.9f, 1.5f}) {
      const Environment map = lamp(direction_of(40, part * radius), radius);
      const double exact = direct_by_rays(floor, {{}, {0, 0, 1}}, map);
      const Products out = run_trace(
          g, {.radius = kNoLimit, .products = {.ao = true, .direct = true}, .environment = map});
      double sum = 0;
      for (const glm::vec3& light : out.direct.pixels) sum += double(light.x);
      EXPECT_NEAR(sum / double(out.direct.size()), exact, 1e-3) << radius << " " << part;
    }
  }
}

}  // namespace
}  // namespace ssdo::test::sources_test
