// SPDX-License-Identifier: Apache-2.0
//
// What is left out of the work for rays to sources changes nothing of what they find: the ways that
// squares of rays have free together, and the extents of surfaces that no ray meets.
#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "estimators/bitmask/request.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 200, 120};

/// Things on a floor and above it, before a wall.
Surface things() {
  std::mt19937 random(3);
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  };
  std::vector<Surface> surfaces = {
      plane({}, {0, 0, 1}),
      cut(plane({0, 2, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.x < 0.7; })};
  for (int k = 0; k < 25; ++k) {
    const glm::dvec3 middle(between(-2.5, 2.5), between(-1.5, 1.5), between(0, 1.2));
    const double size = between(0.01, 0.25);
    surfaces.push_back(k % 2 ? sphere(middle, size)
                             : cut(plane(middle, {0.3, -0.4, 1}), [=](const glm::dvec3& p) {
                                 return glm::distance(p, middle) < size;
                               }));
  }
  return all_of(surfaces);
}

/// The scene under suns and lamps, without what averages their rays.
struct LitThings {
  explicit LitThings(const Camera& projection)
      : camera(tilted(projection, 50)),
        geometry(geometry_of(things(), camera, kWindow)),
        scene(scene_of(geometry, Environment::constant(glm::vec3(0.1f)), 0.5f)) {
    scene.solids = guess_solids(geometry);
    const auto add = [&](Lamp lamp, const glm::dvec3& position, const glm::dvec3& backwards) {
      lamp.position = position;
      lamp.axes[2] = glm::normalize(backwards);
      lamp.axes[0] = glm::normalize(glm::cross(glm::dvec3(0.1, 1, 0.2), lamp.axes[2]));
      lamp.axes[1] = glm::cross(lamp.axes[2], lamp.axes[0]);
      scene.light.sources.push_back(make_source(lamp, {camera.rotation, camera.origin}, 0.01));
    };
    Lamp sun, wide_sun, ball, panel, spot;
    sun.type = wide_sun.type = LampType::distant, sun.angle = 2, wide_sun.angle = 20;
    ball.radius = 0.2;
    panel.type = LampType::rect, panel.width = 2;
    spot.type = LampType::disk, spot.radius = 0.1;
    add(sun, {}, {0.6, -0.5, 0.7}), add(wide_sun, {}, {-0.8, 0.4, 0.3});
    add(ball, {0.2, 0.1, 0.7}, {0, 0, 1}), add(panel, {-2, -3, 3}, {-0.3, -1, 1});
    add(spot, {3, 4, 2}, {1, 1, 1});
  }

  std::vector<Plane<float>> shares(const Window& receivers, bool reflects = false) const {
    return bitmask_method()
        .estimate(scene,
                  {.products = {.ao = true, .direct = true, .reflection = reflects},
                   .radius = kNoLimit,
                   .parameters = {{"roughness", 0.5}},
                   .slices = 2,
                   .steps = 4,
                   .extend_offscreen = true,
                   .receivers = receivers},
                  {})
        .shares.suns;
  }

  Camera camera;
  Geometry geometry;
  Scene scene;
};

const Camera kCameras[] = {camera_from_fov(45, kWindow, 1), camera_from_ortho_width(5, kWindow, 1)};

/// Squares begin at the first row that is asked for.
TEST(Beams, HideNothingOfWhatRaysMeet) {
  for (const Camera& camera : kCameras) {
    const LitThings lit(camera);
    const auto all = lit.shares(kWindow);
    for (int y0 = 1; y0 < 4; ++y0) {
      const Window rows{0, y0, kWindow.x1, kWindow.y1};
      const auto some = lit.shares(rows);
      ASSERT_EQ(some.size(), all.size());
      for (std::size_t k = 0; k < all.size(); ++k) {
        int differ = 0;
        for (int y = y0; y < rows.y1; ++y)
          for (int x = 0; x < rows.x1; ++x) differ += at_pixel(some[k], rows, x, y) != all[k](x, y);
        EXPECT_EQ(differ, 0) << "source " << k << ", rows from " << y0;
      }
    }
  }
}

/// Mirrors ask for the extents of all surfaces that the border cuts.
TEST(BorderExtents, AreFoundWhereSourcesAreBehindThem) {
  for (const Camera& camera : kCameras) {
    const LitThings lit(camera);
    const auto some = lit.shares(kWindow), all = lit.shares(kWindow, true);
    for (std::size_t k = 0; k < all.size(); ++k)
      EXPECT_EQ(some[k].pixels, all[k].pixels) << "source " << k;
  }
}

}  // namespace
}  // namespace ssdo::test
