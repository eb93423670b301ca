// SPDX-License-Identifier: Apache-2.0
//
// What is likely to hide a source beyond the frame, and what is not.
#include "estimators/bitmask/beyond.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "estimators/bitmask/rays/border_extents.h"
#include "estimators/bitmask/request.h"

namespace ssdo::test {
namespace {

/// Black but for one texel, z up.
Environment sun_at(int column, int row) {
  auto map = std::make_shared<Plane<glm::vec3>>(64, 32, glm::vec3(0));
  (*map)(column, row) = glm::vec3(1000);
  EnvironmentFrame frame;
  frame.up = UpAxis::z;
  return Environment(map, frame);
}

/// A wall across x = `x`, which faces the y axis.
Surface wall(double x, double height, double y0, double y1) {
  return cut(plane({x, 0, 0}, {x > 0 ? -1 : 1, 0, 0}),
             [=](const glm::dvec3& p) { return p.z > 0 && p.z < height && p.y > y0 && p.y < y1; });
}

struct View {
  Surface scene;
  Camera camera;
  Window window;

  Geometry geometry() const { return geometry_of(scene, camera, window); }
};

/// From the y axis along it, down by so much in 6 metres, with so many pixels of overscan.
View along_y(const Surface& scene, double eye_y, double down, int overscan = 0) {
  const Window display{0, 0, 96, 64};
  return {
      scene,
      look_at(camera_from_fov(45, display, 1), {0, eye_y, 2}, {0, eye_y + 6, 2 - down}, {0, 0, 1}),
      {-overscan, -overscan, 96 + overscan, 64 + overscan}};
}

/// The mean share of a sun on the floor within a metre of x = 0 and from y0 to y1.
double on_floor(const View& view, const Environment& environment, double y0, double y1) {
  const Geometry g = view.geometry();
  const Solids solids = guess_solids(g);
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = environment,
                               .products = {.ao = true, .direct = true},
                               .slices = 1,
                               .steps = 16,
                               .solids = &solids});
  const Light light = model_light(environment, g.world_to_camera);
  double sum = 0, pixels = 0;
  for (int y = 0; y < view.window.height(); ++y) {
    for (int x = 0; x < view.window.width(); ++x) {
      if (!g.is_surface(g.surfel.index(x, y))) continue;
      const Point p = point_at(view.scene, view.camera, view.window, x, y);
      if (p.position.z > 1e-6 || std::abs(p.position.x) > 1) continue;
      if (p.position.y < y0 || p.position.y > y1) continue;
      const glm::vec3 normal = g.world_to_camera * glm::vec3(p.normal);
      sum += double(out.direct(x, y).x / light.unoccluded({}, normal).x), pixels += 1;
    }
  }
  EXPECT_GT(pixels, 50);
  return sum / pixels;
}

constexpr int kFromLeft = 0, kFromBehindLeft = 52, kRow30 = 10, kRow45 = 7;

TEST(BitmaskBeyond, TheSkyComesThroughByHalfAndASunDoesNot) {
  EXPECT_FLOAT_EQ(pass_beyond(1, 0).through, 0);
  EXPECT_FLOAT_EQ(pass_beyond(1, 0.125f).through, 0.25f);
  EXPECT_FLOAT_EQ(pass_beyond(0.5f, 0).past, 0.5f);
  EXPECT_FLOAT_EQ(pass_beyond(0.5f, 1).through, 0.5f);
  EXPECT_FLOAT_EQ(pass_beyond(0.5f, 1).past, 1);
}

/// What a frame of these scenes tells, seen level or from above.
Openness openness_of(const Surface& scene, double looks_down_by, const Window& receivers = {}) {
  const Window window{0, 0, 96, 64};
  const Camera camera = look_at(camera_from_fov(60, window, 1), {0, 0, 1.6},
                                {0, 5, 1.6 - 5 * looks_down_by}, {0, 0, 1});
  const Geometry g = geometry_of(scene, camera, window);
  const MarchScene march_scene = make_march_scene(g, guess_solids(g), receivers);
  Openness sum;
  add_openness(march_scene, window, g.world_to_camera * glm::vec3(0, 0, 1), kNoLimit,
               march_scene.raster(), sum);
  return sum;
}

TEST(BitmaskBeyond, OnlyAClosedPlaceDimsASun) {
  const Surface floor = plane({}, {0, 0, 1}), back = plane({0, 6, 0}, {0, -1, 0});
  const Surface left = plane({-2.5, 0, 0}, {1, 0, 0}), right = plane({2.5, 0, 0}, {-1, 0, 0}),
                room = all_of({floor, left, right, back, plane({0, 0, 2.6}, {0, 0, -1})}),
                low = all_of({floor, cut(back, [](const glm::dvec3&p) { return p.z < 2.4; })});
  const double in_room = double(sun_past_beyond(openness_of(room, 0)));
  fmt::print("a sun in a room: {:.3f}\n", in_room);
  EXPECT_LT(in_room, 0.1);
  EXPECT_EQ(sun_past_beyond(openness_of(floor, 0)), 1);
  EXPECT_GT(sun_past_beyond(openness_of(low, 0)), 0.95f) << "there is sky over the wall";
  EXPECT_EQ(sun_past_beyond(openness_of(room, 1)), 1)
      << "nothing of the walls is above the horizon";
  EXPECT_EQ(sun_past_beyond(Openness{}), 1) << "no surfaces";
  // Walls alone, and sky over them: W / (W + 10 S) of 1 - (A / 0.6)^2 is lost.
  Openness dense{.ao = 20, .surfaces = 100, .walls = 1, .above = 50, .pixels = 100};
  EXPECT_NEAR(sun_past_beyond(dense), 0.1111, 1e-4);
  dense.sky = 0.5;
  EXPECT_NEAR(sun_past_beyond(dense), 0.8519, 1e-4);
  // The frame decides, not who asks.
  EXPECT_EQ(sun_past_beyond(openness_of(room, 0, {10, 20, 30, 40})), float(in_room));
}

TEST(BitmaskBeyond, AWallThatTheBorderShowsDoesNotHideASunAboveIt) {
  // Two metres high and 3.6 metres aside, under a sun of 45 degrees.
  const Surface scene = all_of({plane({}, {0, 0, 1}), wall(-3.6, 2, -3, 6)});
  double before = 1;
  for (const int overscan : {0, 8, 12, 16, 24, 32, 48}) {
    const double share =
        on_floor(along_y(scene, -6, 1.7, overscan), sun_at(kFromLeft, kRow45), -3, 1);
    fmt::print("{} px of overscan: {:.3f} of the sun\n", overscan, share);
    EXPECT_GT(share, 0.9) << overscan;
    EXPECT_NEAR(share, before, 0.05) << overscan;
    before = share;
  }
}

TEST(BitmaskBeyond, TheFrontOfAStreetGoesOn) {
  // Behind the camera too, whose frame cuts the houses at the top.
  const Surface street =
      all_of({plane({}, {0, 0, 1}), wall(-5, 12, -60, 60), wall(5, 12, -60, 60)});
  const double share = on_floor(along_y(street, 0, 0), sun_at(kFromBehindLeft, kRow30), 8, 25);
  fmt::print("in a street: {:.3f} of the sun\n", share);
  EXPECT_LT(share, 0.35);
}

TEST(BitmaskBeyond, AHillHidesNothingFromItself) {
  const Surface hill = sphere({0, 0, -20}, 20);
  const Window window{0, 0, 96, 64};
  const Camera camera = look_at(camera_from_fov(45, window, 1), {0, -6, 2.5}, {0, 0, 0}, {0, 0, 1});
  const Geometry g = geometry_of(hill, camera, window);
  const Solids solids = guess_solids(g);
  const Environment environment = sun_at(kFromLeft, kRow30);
  Scene scene = scene_of(g, environment, 0.8f);
  scene.solids = solids;
  const Products out =
      bitmask_method().estimate(scene,
                                {.products = {.ao = true, .direct = true, .reflection = true},
                                 .radius = kNoLimit,
                                 .parameters = {{"roughness", 0.5}},
                                 .slices = 2,
                                 .steps = 16},
                                {});
  const Light light = model_light(environment, g.world_to_camera);
  double least_sun = 1, least_reflection = 1;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    if (!g.is_surface(i)) continue;
    const float all = light.unoccluded({}, g.surfel[i].normal).x;
    least_sun = std::min(least_sun, double(out.direct[i].x / all));
    least_reflection = std::min(least_reflection, double(out.reflection[i]));
  }
  fmt::print("on a hill at least {:.3f} of the sun, reflection {:.3f}\n", least_sun,
             least_reflection);
  EXPECT_GT(least_sun, 0.97);
  EXPECT_GT(least_reflection, 0.9);
}

TEST(BitmaskBeyond, ExtentsAreThoseThatTheFrameShows) {
  const View view = along_y(all_of({plane({}, {0, 0, 1}), wall(-3.6, 2, -3, 6)}), -6, 1.7, 40);
  const Geometry g = view.geometry();
  const MarchScene scene = make_march_scene(g, guess_solids(g));
  const CutSurfaces cut =
      find_cut_surfaces(scene, g.world_to_camera * glm::vec3(0, 0, 1), kNoLimit);
  int found = 0;
  double nearest = 6;  // of the wall in the frame; the camera looks down, so lower rows show more
  for (int y = view.window.height() - 1; y >= 0; --y) {
    if (!g.is_surface(g.surfel.index(0, y))) continue;
    const Point p = point_at(view.scene, view.camera, view.window, 0, y);
    if (p.position.x > -3.5 || p.normal.z > 0.5) continue;
    const BorderExtent& e = cut.extents[std::size_t(scene.border.in_column(false, y))];
    nearest = std::min(nearest, p.position.y);
    // To the end of the wall, which is to the right, and to its top.
    EXPECT_NEAR(e.seen[0], 6 - p.position.y, 0.3) << y;
    EXPECT_NEAR(e.seen[1], p.position.y - nearest, 0.3) << y;
    EXPECT_NEAR(e.seen[2], 2 - p.position.z, 0.15) << y;
    ++found;
  }
  EXPECT_GT(found, 5);
}

}  // namespace
}  // namespace ssdo::test
