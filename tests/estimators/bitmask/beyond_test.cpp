// SPDX-License-Identifier: Apache-2.0
//
// What is likely to hide a source beyond the frame, and what is not.
#include "estimators/bitmask/border/beyond.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "estimators/bitmask/border/border_extents.h"
#include "estimators/bitmask/request.h"
#include "scene/light/distant_source.h"
#include "support/point_source.h"
#include "support/sun_of.h"

namespace ssdo::test::beyond_test {
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
      if (!g.is_surface(g.surfaces.index(x, y))) continue;
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
  const auto pass = [](float past, float sh_fraction) {
    DistantSource sun;
    sun.sh_fraction = sh_fraction;
    return offscreen_visibility(past, sun);
  };
  EXPECT_FLOAT_EQ(pass(1, 0).blocked, 0);
  EXPECT_FLOAT_EQ(pass(1, 0.125f).blocked, 0.25f);
  EXPECT_FLOAT_EQ(pass(0.5f, 0).unblocked, 0.5f);
  EXPECT_FLOAT_EQ(pass(0.5f, 1).blocked, 0.5f);
  EXPECT_FLOAT_EQ(pass(0.5f, 1).unblocked, 1);
}

TEST(BitmaskBeyond, APlaceThatIsClosedAgainstTheSkyIsOpenToALamp) {
  const OffscreenVisibility pass = offscreen_visibility(0.2f, PointSource(glm::vec3(0, 1, 2)));
  EXPECT_FLOAT_EQ(pass.unblocked, 1);
  EXPECT_FLOAT_EQ(pass.blocked, 0);
}

/// What a frame of these scenes tells, seen level or from above.
Enclosure enclosure_of(const Surface& scene, double looks_down_by, const Window& receivers = {}) {
  const Window window{0, 0, 96, 64};
  const Camera camera = look_at(camera_from_fov(60, window, 1), {0, 0, 1.6},
                                {0, 5, 1.6 - 5 * looks_down_by}, {0, 0, 1});
  const Geometry g = geometry_of(scene, camera, window);
  const MarchScene march_scene = make_march_scene(g, guess_solids(g), receivers);
  Enclosure sum;
  add_enclosure(march_scene, window, g.world_to_camera * glm::vec3(0, 0, 1), kNoLimit,
                march_scene.raster(), sum);
  return sum;
}

TEST(BitmaskBeyond, OnlyAClosedPlaceDimsASun) {
  const Surface floor = plane({}, {0, 0, 1}), back = plane({0, 6, 0}, {0, -1, 0});
  const Surface left = plane({-2.5, 0, 0}, {1, 0, 0}), right = plane({2.5, 0, 0}, {-1, 0, 0}),
                room = all_of({floor, left, right, back, plane({0, 0, 2.6}, {0, 0, -1})}),
                low = all_of({floor, cut(back, [](const glm::dvec3&p) { return p.z < 2.4; })});
  const double in_room = double(offscreen_sun_visibility(enclosure_of(room, 0)));
  fmt::print("a sun in a room: {:.3f}\n", in_room);
  EXPECT_LT(in_room, 0.1);
  EXPECT_EQ(offscreen_sun_visibility(enclosure_of(floor, 0)), 1);
  EXPECT_GT(offscreen_sun_visibility(enclosure_of(low, 0)), 0.95f) << "there is sky over the wall";
  EXPECT_EQ(offscreen_sun_visibility(enclosure_of(room, 1)), 1)
      << "nothing of the walls is above the horizon";
  EXPECT_EQ(offscreen_sun_visibility(Enclosure{}), 1) << "no surfaces";
  // Walls alone, and sky over them: W / (W + 10 S) of 1 - (A / 0.6)^2 is lost.
  Enclosure dense{.ao = 20, .surfaces = 100, .walls = 1, .above = 50, .pixels = 100};
  EXPECT_NEAR(offscreen_sun_visibility(dense), 0.1111, 1e-4);
  dense.sky = 0.5;
  EXPECT_NEAR(offscreen_sun_visibility(dense), 0.8519, 1e-4);
  // The frame decides, not who asks.
  EXPECT_EQ(offscreen_sun_visibility(enclosure_of(room, 0, {10, 20, 30, 40})), float(in_room));
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
    const float all = light.unoccluded({}, g.surfaces[i].normal).x;
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
    if (!g.is_surface(g.surfaces.index(0, y))) continue;
    const Point p = point_at(view.scene, view.camera, view.window, 0, y);
    if (p.position.x > -3.5 || p.normal.z > 0.5) continue;
    const BorderExtent& e = cut.extents[std::size_t(scene.border.in_column(false, y))];
    nearest = std::min(nearest, p.position.y);
    // To the end of the wall, which is to the right, and to its top.
    EXPECT_NEAR(e.seen[0], 6 - p.position.y, 0.3) << y;
    EXPECT_NEAR(e.seen[1], p.position.y - nearest, 0.3) << y;
    EXPECT_NEAR(e.seen[2], 2 - p.position.z, 0.15) << y;
    // From its topmost pixel, no walk upward meets the wall again.
    if (2 - p.position.z > 0.1) {
      EXPECT_LT(e.most[2], 0.1) << "the frame shows the top in row " << y;
    }
    ++found;
  }
  EXPECT_GT(found, 5);
}

constexpr Window kWide{0, 0, 96, 64};

/// From the origin along y, `width` wide; z up.
Camera level_ortho(double width, double back = 0, const Window& window = kWide) {
  return look_at(camera_from_ortho_width(width, window, 1), {0, -back, 0}, {0, 1, 0}, {0, 0, 1});
}

/// A part of the plane y = `y`, which faces the camera.
template <class Within>
Surface front(double y, const Within& within) {
  return cut(plane({0, y, 0}, {0, -1, 0}), [=](const glm::dvec3& p) { return within(p.x, p.z); });
}

/// Those of the pixels at the left border, from top to bottom.
std::vector<BorderExtent> extents_at_left(const Geometry& g, float radius = kNoLimit) {
  const MarchScene scene = make_march_scene(g, guess_solids(g));
  const CutSurfaces cut = find_cut_surfaces(scene, g.world_to_camera * glm::vec3(0, 0, 1), radius);
  std::vector<BorderExtent> extents;
  for (int y = 0; y < g.surfaces.height; ++y)
    extents.push_back(cut.extents[std::size_t(scene.border.in_column(false, y))]);
  return extents;
}

void expect_same_extents(const std::vector<BorderExtent>& a, const std::vector<BorderExtent>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t y = 0; y < a.size(); ++y) {
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(a[y].seen[k], b[y].seen[k], 1e-3) << y << " " << k;
      EXPECT_NEAR(a[y].most[k], b[y].most[k], 1e-3) << y << " " << k;
    }
  }
}

/// An orthographic camera may stand anywhere on its axis.
TEST(BitmaskBeyond, ExtentsDoNotDependOnWhereAnOrthographicCameraStands) {
  const Surface scene =
      all_of({front(8, [](double x, double) { return x < 2; }),
              front(6, [](double x, double) { return x > -3.4 && x < -2.4; })});  // hides a part
  const auto extents = [&](double back) {
    return extents_at_left(geometry_of(scene, level_ortho(8, back), kWide));
  };
  expect_same_extents(extents(0), extents(40));
}

/// Of large frames, walks skip pixels far away, but not next to the border.
TEST(BitmaskBeyond, ExtentsAreSeenToThePixel) {
  const Window window{0, 0, 1920, 24};
  const double pixel = 40.0 / 1920;
  const Surface scene = front(8, [&](double x, double) { return x < -20 + 8 * pixel; });
  const std::vector<BorderExtent> extents =
      extents_at_left(geometry_of(scene, level_ortho(40, 0, window), window));
  for (std::size_t y = 0; y < extents.size(); ++y) {
    EXPECT_NEAR(extents[y].seen[0], 7 * pixel, 0.1 * pixel);
    // Three rows share their walks; each has its own way to the top and the bottom.
    EXPECT_NEAR(extents[y].seen[2], double(y) * pixel, 0.1 * pixel);
    EXPECT_NEAR(extents[y].seen[3], double(window.height() - 1 - int(y)) * pixel, 0.1 * pixel);
  }
}

/// The lower part of a wall ends, the upper part goes on behind what stands before it. Where one
/// becomes longer than the other, the end that is seen does not vanish at once.
TEST(BitmaskBeyond, AnEndIsNotLostToALongerRun) {
  const double pixel = 8.0 / 96;
  float before = 0;
  for (int longer = -12; longer <= 12; ++longer) {
    const double upper = (0.25 + longer) * pixel, lower = 0.25 * pixel;
    const Surface scene =
        all_of({front(8, [=](double x, double z) { return z > 0 || x < lower; }),
                front(6, [=](double x, double z) { return z > 0 && x > upper; })});
    const float most = extents_at_left(geometry_of(scene, level_ortho(8), kWide))[31].most[0];
    if (longer > -12) {
      EXPECT_NEAR(most / before, 1, 0.25) << longer;
    }
    before = most;
  }
}

/// The row of a street goes on past a gap, and does not past a wide one. As the gap grows by a
/// pixel it is neither lost at once nor kept: walks take steps of several pixels.
TEST(BitmaskBeyond, AGapEndsARowLittleByLittle) {
  const double pixel = 8.0 / 96;
  std::vector<float> seen;
  for (int gap = 0; gap <= 24; ++gap) {
    const double from = -8.25 * pixel, to = from + gap * pixel;
    const Surface scene = front(8, [=](double x, double) { return x < from || x > to; });
    seen.push_back(extents_at_left(geometry_of(scene, level_ortho(8), kWide))[31].seen[0]);
  }
  const float whole = seen.front(), first = seen.back();
  EXPECT_NEAR(whole, 95 * pixel, 2 * pixel);
  EXPECT_NEAR(first, 39 * pixel, 2 * pixel);
  for (std::size_t gap = 1; gap < seen.size(); ++gap)
    EXPECT_LT(std::abs(seen[gap] - seen[gap - 1]), 0.6f * (whole - first)) << gap;
}

/// A radius that the whole scene is within changes nothing. The top of this wall is nine pixels
/// below the border, so that it is not quite known to end there.
TEST(BitmaskBeyond, AnEndAtTheTopIsGradedWithARadiusToo) {
  const double pixel = 8.0 / 96;
  const Surface scene = front(8, [=](double x, double z) { return x < 2 && z < 23.25 * pixel; });
  const Geometry g = geometry_of(scene, level_ortho(8), kWide);
  const std::vector<BorderExtent> extents = extents_at_left(g);
  EXPECT_GT(extents[40].most[2], 0.2);
  expect_same_extents(extents, extents_at_left(g, 100));
}

/// Broken pixels are no sky: they end nothing, and do not make a place open.
TEST(BitmaskBeyond, BrokenPixelsTellNothing) {
  const Surface scene = front(8, [](double x, double z) { return x < 2 && z < 1; });
  Geometry g = geometry_of(scene, level_ortho(8), kWide);
  const std::vector<BorderExtent> known = extents_at_left(g);
  g.surfaces.change_each([](Surfel& s) {
    if (!s.is_surface()) s.rounding = Surfel::kBroken;
  });
  const std::vector<BorderExtent> extents = extents_at_left(g);
  EXPECT_NEAR(extents[40].seen[2], known[40].seen[2], 1e-3);
  EXPECT_GT(extents[40].most[2], 10 * known[40].most[2]);

  const MarchScene march_scene = make_march_scene(g, guess_solids(g));
  Enclosure sum;
  add_enclosure(march_scene, kWide, {0, 1, 0}, kNoLimit, march_scene.raster(), sum);
  EXPECT_GT(sum.surfaces, 0);
  EXPECT_EQ(sum.pixels, sum.surfaces);
  EXPECT_EQ(sum.sky, 0);
}

}  // namespace
}  // namespace ssdo::test::beyond_test
