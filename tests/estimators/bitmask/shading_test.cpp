// SPDX-License-Identifier: Apache-2.0
//
// Normal maps: light is weighed by the shading normal, what hides it is the surface.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "estimators/bitmask/request.h"
#include "support/scene_of.h"
#include "support/sun_of.h"

namespace ssdo::test::shading_test {
namespace {

const Window kWindow{0, 0, 160, 120};

/// A plane seen at 18 degrees under bumps of 20 degrees RMS that lean in all directions.
Geometry bumpy_plane() {
  const Camera camera = tilted(camera_from_fov(30, kWindow, 1), 72);
  Geometry g = geometry_of(plane({}, {0, 0, 1}), camera, kWindow);
  const glm::mat3 to_camera(camera.rotation);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const float u = 0.37f * float(x), v = 0.53f * float(y);
      const glm::vec3 slope(std::sin(u) + std::sin(0.7f * v + 1), std::sin(v) + std::sin(0.6f * u),
                            0);
      g.surfaces.set_normal(g.surfaces.index(x, y),
                            to_camera * glm::normalize(glm::vec3(0, 0, 1) + 0.26f * slope));
    }
  }
  return g;
}

/// Share of the hemisphere about a normal, weighed by the cosine, that is above a plane: half of
/// one plus the cosine between both.
double open_above(const glm::vec3& normal, const glm::vec3& plane) {
  return 0.5 * (1 + double(glm::dot(normal, plane)));
}

TEST(BitmaskShading, ABumpyPlaneIsHiddenByThePlaneAlone) {
  const Geometry g = bumpy_plane();
  const glm::vec3 up = g.world_to_camera * glm::vec3(0, 0, 1);
  const Products out = run(g, {.radius = kNoLimit, .slices = 8, .steps = 32});
  double mean = 0, exact = 0, squares = 0, away = 0, away_count = 0, count = 0;
  for (int y = 2; y < kWindow.height() - 2; ++y) {
    for (int x = 2; x < kWindow.width() - 2; ++x) {
      const Surfel& s = g.surfaces(x, y);
      const double expected = open_above(s.normal, up);
      const double off = out.ao(x, y) - expected;
      mean += out.ao(x, y), exact += expected, squares += off * off, count += 1;
      if (glm::dot(s.normal, -glm::normalize(s.position)) > 0) continue;
      away += off, away_count += 1;
    }
  }
  fmt::print("bumpy plane: ao {:.4f}, exactly {:.4f}, RMS {:.4f}; {:.0f} that lean away {:+.4f}\n",
             mean / count, exact / count, std::sqrt(squares / count), away_count,
             away / away_count);
  EXPECT_GT(away_count, 300);
  EXPECT_NEAR(mean / count, exact / count, 0.005);
  EXPECT_LT(std::sqrt(squares / count), 0.03);
  EXPECT_NEAR(away / away_count, 0, 0.05);
}

TEST(BitmaskShading, ItsSunIsSeenWhereverThePlaneSeesIt) {
  const Geometry g = bumpy_plane();
  auto map = std::make_shared<Plane<glm::vec3>>(256, 128, glm::vec3(0));
  (*map)(70, 40) = glm::vec3(8000);
  const Environment environment(map, {.up = UpAxis::z});
  const Light light = model_light(environment, g.world_to_camera);
  ASSERT_EQ(light.sources.size(), 1u);
  const glm::vec3 up = g.world_to_camera * glm::vec3(0, 0, 1);
  ASSERT_GT(glm::dot(up, sun_of(light).direction), 0.2f) << "the sun is above the plane";
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = environment,
                               .products = {.ao = true, .direct = true},
                               .slices = 2,
                               .steps = 16,
                               .extend = false});
  for (int y = 2; y < kWindow.height() - 2; ++y) {
    for (int x = 2; x < kWindow.width() - 2; ++x) {
      const double expected =
          std::max(0.0f, glm::dot(g.surfaces(x, y).normal, sun_of(light).direction)) *
          sun_of(light).irradiance.x;
      EXPECT_NEAR(out.direct(x, y).x, expected, 1e-3 * sun_of(light).irradiance.x) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace ssdo::test::shading_test
