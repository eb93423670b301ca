// SPDX-License-Identifier: Apache-2.0
//
// Cube maps were lit as lat-long ones: direct light was off by half.
#include "io/pictures/cube_map.h"

#include <ImfEnvmap.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>

#include "scene/light/environment.h"

namespace ssdo::test::cube_map_test {
namespace {

constexpr int kFace = 24;

Imath::Box2i window() { return Imath::Box2i({0, 0}, {kFace - 1, 6 * kFace - 1}); }

/// Calls visit(x, y, point on the cube of edge 2) for every texel, by OpenEXR's own geometry.
template <class Visit>
void for_each_texel(const Visit& visit) {
  for (int face = 0; face < 6; ++face) {
    for (int v = 0; v < kFace; ++v) {
      for (int u = 0; u < kFace; ++u) {
        const auto which = Imf::CubeMapFace(face);
        const Imath::V2f in_face{float(u), float(v)};
        const Imath::V2f at = Imf::CubeMap::pixelPosition(which, window(), in_face);
        const Imath::V3f p = Imf::CubeMap::direction(which, window(), in_face);
        visit(int(std::lround(at.x)), int(std::lround(at.y)), glm::vec3(p.x, p.y, p.z));
      }
    }
  }
}

Plane<glm::vec3> black() { return Plane<glm::vec3>(kFace, 6 * kFace); }

Environment around(const Plane<glm::vec3>& cube) {
  return Environment(std::make_shared<const Plane<glm::vec3>>(lat_long_of_cube(cube)), {});
}

/// A point of a face is linear in its texels, so that looking it up between them is exact.
TEST(CubeMap, EveryDirectionStaysInItsPlace) {
  Plane<glm::vec3> cube = black();
  for_each_texel([&](int x, int y, const glm::vec3& p) { cube(x, y) = p; });
  const Environment light = around(cube);
  const Plane<glm::vec3>& map = *light.map();
  ASSERT_EQ(map.width, 2 * map.height);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      ASSERT_GT(glm::dot(glm::normalize(map(x, y)), light.texel_direction(x, y)),
                std::cos(glm::radians(0.5f)))
          << x << " " << y;
    }
  }
}

TEST(CubeMap, LightIsKept) {
  const Plane<glm::vec3> grey(kFace, 6 * kFace, glm::vec3(1));
  for (const glm::vec3& texel : lat_long_of_cube(grey).pixels) ASSERT_NEAR(texel.x, 1, 1e-5);
  int tried = 0;
  for_each_texel([&](int x, int y, const glm::vec3& p) {
    const float edge = 1 - 3.0f / kFace, second = p.x * p.x + p.y * p.y + p.z * p.z - 1;
    const int far_out = (std::abs(p.x) > edge) + (std::abs(p.y) > edge) + (std::abs(p.z) > edge);
    if ((x * 5 + y * 3) % 97 != 0 || far_out > 1) return;  // some, away from the edges
    Plane<glm::vec3> cube = black();
    cube(x, y) = glm::vec3(1000);
    // A texel's solid angle on a cube of edge 2, whose border texels lie on the edges.
    const double across = 2.0 / (kFace - 1), omega = across * across / std::pow(1 + second, 1.5);
    const double power = around(cube).mean().x * 4 * M_PI;
    EXPECT_NEAR(power / (1000 * omega), 1, 0.01) << x << " " << y;
    ++tried;
  });
  EXPECT_GT(tried, 12);
}

TEST(CubeMap, AFaceMayHaveOneTexel) {
  Plane<glm::vec3> cube(1, 6);
  cube(0, 2) = glm::vec3(6);  // +Y, a sixth of all directions
  EXPECT_NEAR(around(cube).mean().x, 1, 0.01);
  EXPECT_NEAR(around(cube).radiance({0, 1, 0}).x, 6, 1e-4);
}

}  // namespace
}  // namespace ssdo::test::cube_map_test
