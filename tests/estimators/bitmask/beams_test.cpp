// SPDX-License-Identifier: Apache-2.0
//
// What is left out of the work for rays to sources changes nothing of what they find: the ways that
// squares of rays have free together, and the extents of surfaces that no ray meets.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "estimators/bitmask/border/beyond.h"
#include "estimators/bitmask/rays/find_source.h"
#include "estimators/bitmask/request.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo::test::beams_test {
namespace {

const Window kWindow{0, 0, 200, 120};

/// Things on a floor and above it, before a wall.
Surface things(int count) {
  std::mt19937 random(3);
  const auto between = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  };
  std::vector<Surface> surfaces = {
      plane({}, {0, 0, 1}),
      cut(plane({0, 2, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.x < 0.7; })};
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 middle(between(-2.5, 2.5), between(-1.5, 1.5), between(0, 1.2));
    const double size = std::pow(between(0.2, 0.6), 3);
    surfaces.push_back(
        k % 2 ? sphere(middle, size)
              : cut(plane(middle, {between(-1, 1), between(-1, 1), 1}),
                    [=](const glm::dvec3& p) { return glm::distance(p, middle) < size; }));
  }
  return all_of(surfaces);
}

/// The scene under suns and lamps, without what averages their rays.
struct LitThings {
  LitThings(const Camera& projection, int things_count)
      : camera(tilted(projection, 50)),
        geometry(geometry_of(things(things_count), camera, kWindow)),
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
        .visibility.sources;
  }

  Camera camera;
  Geometry geometry;
  Scene scene;
};

const Camera kCameras[] = {camera_from_fov(45, kWindow, 1), camera_from_ortho_width(5, kWindow, 1)};

/// Rays from what the camera sees, or from the sides that it does not see.
enum class Side { seen, unseen };

/// The share of a source that arrives in each pixel of `rows`; where rays go `together`, ways of
/// squares of them are shortened.
Plane<float> arrives(const MarchScene& scene, const Source& source, Side side, const Window& rows,
                     bool together) {
  const SlicePattern pattern = mean_ao_pattern(scene.layout, kWindow);
  const std::vector<DepthBounds> bounds = depth_bounds(scene);
  const March march{scene, pattern, kNoLimit, false};
  const auto points = points_of(source, 2, 0);
  SourceJob job{march, bounds, points, source, {}};
  job.together = together;
  SourceVisibility found = find_source(job, rows, {});
  if (side == Side::unseen) find_unseen_light(job, scene, rows, found);
  return Raster(scene).picture(std::move(side == Side::seen ? found.share : found.unseen), 1);
}

/// Squares begin at the first row that is asked for.
void expect_alike(const MarchScene& scene, const Source& source, Side side) {
  const Plane<float> alone = arrives(scene, source, side, kWindow, false);
  EXPECT_GT(std::ranges::count_if(alone.pixels, [](float share) { return share < 0.5f; }), 50)
      << "there is something to meet";
  for (int y0 = 0; y0 < 4; ++y0) {
    const Window rows{0, y0, kWindow.x1, kWindow.y1};
    const Plane<float> together = arrives(scene, source, side, rows, true);
    int differ = 0;
    for (int y = y0; y < rows.y1; ++y)
      for (int x = 0; x < rows.x1; ++x) differ += together(x, y) != alone(x, y);
    EXPECT_EQ(differ, 0) << "rows from " << y0;
  }
}

TEST(Beams, HideNothingOfWhatRaysMeet) {
  for (const Camera& camera : kCameras) {
    for (const int count : {20, 80, 250}) {  // only the first and the last thing on a way bound it
      const LitThings lit(camera, count);
      const MarchScene scene = make_march_scene(lit.geometry, lit.scene.solids);
      for (std::size_t k = 0; k < lit.scene.light.sources.size(); ++k) {
        SCOPED_TRACE(fmt::format("{} things, source {}", count, k));
        for (const Side side : {Side::seen, Side::unseen})
          expect_alike(scene, *lit.scene.light.sources[k], side);
      }
    }
  }
}

/// Mirrors ask for the extents of all surfaces that the border cuts.
TEST(BorderExtents, AreFoundWhereSourcesAreBehindThem) {
  for (const Camera& camera : kCameras) {
    const LitThings lit(camera, 25);
    const auto some = lit.shares(kWindow), all = lit.shares(kWindow, true);
    for (std::size_t k = 0; k < all.size(); ++k)
      EXPECT_EQ(some[k].pixels, all[k].pixels) << "source " << k;
  }
}

}  // namespace
}  // namespace ssdo::test::beams_test
