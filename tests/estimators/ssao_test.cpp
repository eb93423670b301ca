// SPDX-License-Identifier: Apache-2.0
#include "estimators/ssao.h"

#include <gtest/gtest.h>

#include "estimators/view_space/point_method_request.h"
#include "estimators/view_space/slow_point_kernel.h"

namespace ssdo::test::ssao_test {
namespace {

const Window kWindow{0, 0, 96, 72};

/// The formula, sample by sample, in double.
double slow_ssao(const Geometry& g, int x, int y, double radius, double bias, int samples,
                 unsigned seed) {
  const Surfel& s = g.surfaces(x, y);
  if (!s.is_surface()) return 1;
  const glm::dvec3 p(s.position), n(s.normal);
  const int column = (x + g.window.x0 - g.display.x0) & 3,
            row = (y + g.window.y0 - g.display.y0) & 3;
  const glm::dvec3 random(frame_noise(seed)[std::size_t(row * 4 + column)]);
  const glm::dvec3 tangent = glm::normalize(random - n * glm::dot(random, n));
  const glm::dmat3 frame(tangent, glm::cross(n, tangent), n);
  double occlusion = 0;
  for (const glm::dvec3& v : slow_point_kernel(samples, 0.1, true, seed)) {
    const glm::dvec3 point = p + radius * (frame * v);
    double z;
    if (!depth_at(g, point, z) || !(z >= point.z + bias * radius + s.rounding)) continue;
    occlusion += slow_smoothstep(0, 1, radius / std::abs(p.z - z));
  }
  return 1 - occlusion / samples;
}

TEST(Ssao, IsTheSlowEvaluation) {
  for (const Camera& projection :
       {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(room_with_a_ball(), tilted(projection, 55), kWindow);
    for (const double bias : {0.05, 0.0}) {
      const Products out = run(
          ssao_method(), g, {.radius = 0.8f, .set = {"bias=" + std::to_string(bias)}, .seed = 5});
      expect_close(out.ao, [&](int x, int y) { return slow_ssao(g, x, y, 0.8f, bias, 64, 5); });
    }
  }
}

TEST(Ssao, AnOpenPlaneThatFacesTheViewerReadsOne) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, 0), kWindow);
    for (const float ao : run(ssao_method(), g, {}).ao.pixels) EXPECT_EQ(ao, 1);
  }
}

TEST(Ssao, TheFootOfAWallIsHalfHidden) {
  const Surface corner = all_of({plane({}, {0, 0, 1}), plane({0, 0, 0}, {0, -1, 0})});
  // From 45 degrees: floor and wall look alike. The radius is 120 pixels, since most points lie
  // within a tenth of it.
  const Window window{0, 0, 400, 400};
  const Geometry g = geometry_of(corner, tilted(camera_from_fov(4, window, 1), 45), window);
  const Products out = run(ssao_method(), g, {.radius = 0.125f, .set = {"bias=0", "samples=256"}});
  double sum = 0;
  // The lowest row of the wall and the highest of the floor.
  for (const int y : {199, 200}) {
    for (int x = 198; x < 202; ++x) sum += out.ao(x, y) / 8;
  }
  EXPECT_NEAR(sum, 0.5, 0.05);
}

TEST(Ssao, TheRangeCheckKeepsAHaloAway) {
  const auto darkest_behind = [](double depth) {
    const Geometry g = geometry_of(disc_before_a_plane(depth),
                                   tilted(camera_from_fov(40, kWindow, 1), 0), kWindow);
    const Products out = run(ssao_method(), g, {.radius = 0.5f});
    float least = 1;
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      if (g.surfaces[i].position.z < -6.1f) least = std::min(least, out.ao[i]);
    }
    return least;
  };
  // smoothstep(0, 1, 0.5 / 20) of what is hidden.
  EXPECT_GT(darkest_behind(20), 0.998);
  EXPECT_LT(darkest_behind(20), 1);
  EXPECT_LT(darkest_behind(0.4), 0.8);
}

TEST(Ssao, DirectIsAoTimesConstantLight) {
  const Geometry g =
      geometry_of(room_with_a_ball(), tilted(camera_from_fov(50, kWindow, 1), 55), kWindow);
  const glm::vec3 color(0.5f, 1, 3);
  const Products out =
      run(ssao_method(), g, {.direct = true, .environment = Environment::constant(color)});
  for (std::size_t i = 0; i < out.ao.size(); ++i) EXPECT_EQ(out.direct[i], out.ao[i] * color);
}

}  // namespace
}  // namespace ssdo::test::ssao_test
