// SPDX-License-Identifier: Apache-2.0
//
// What is exact: an open plane, and light that is the same from everywhere.
#include "estimators/bitmask.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"

namespace ssdo::test::bitmask_test {
namespace {

struct View {
  const char* name;
  Camera projection;
  Window window, display;
};

std::vector<View> views() {
  const Window usual{0, 0, 96, 72}, odd{0, 0, 61, 37}, wide{0, 0, 96, 32};
  const Window inside{21, 13, 64, 50}, beyond{-9, -6, 111, 79}, moved{1003, -517, 1090, -450};
  Camera shifted = camera_from_fov(60, usual, 1);
  shifted.cx = -60;
  return {{"perspective", camera_from_fov(60, usual, 1), usual, usual},
          {"wide, 60 degrees off the axis", camera_from_fov(120, wide, 1), wide, wide},
          {"off-centre", shifted, usual, usual},
          {"narrow", camera_from_fov(1, usual, 1), usual, usual},
          {"odd size", camera_from_fov(60, odd, 1), odd, odd},
          {"data inside display", camera_from_fov(60, usual, 1), inside, usual},
          {"data beyond display", camera_from_fov(60, usual, 1), beyond, usual},
          {"display elsewhere", camera_from_fov(60, moved, 1), moved, moved},
          {"pixel aspect 2", camera_from_fov(60, usual, 2), usual, usual},
          {"orthographic", camera_from_ortho_width(6, usual, 1), usual, usual},
          {"orthographic, odd size", camera_from_ortho_width(6, odd, 1), odd, odd},
          {"orthographic, pixel aspect 2", camera_from_ortho_width(6, usual, 2), usual, usual}};
}

/// Largest distance from 1.
double worst(const Products& out) {
  double worst = 0;
  for (const float ao : out.ao.pixels) {
    worst = std::isfinite(ao) ? std::max(worst, std::abs(ao - 1.0)) : HUGE_VAL;
  }
  return worst;
}

TEST(Bitmask, AnOpenPlaneReadsOneAtEveryTilt) {
  for (const View& view : views()) {
    double error = 0;
    for (const double tilt : {0.0, 30.0, 60.0, 80.0, 85.0, 89.0, 89.9}) {
      // Far enough away that a view of one degree sees a piece as large as the others.
      const double distance = view.projection.fx > 1000 ? 300 : 6;
      Geometry g =
          geometry_of(plane({}, {0, 0, 1}), tilted(view.projection, tilt, distance), view.window);
      g.display = view.display;
      for (const int slices : {2, 3, 8}) {
        for (const float radius : {0.3f, 2.0f, kNoLimit}) {
          const double here = worst(run(g, {.radius = radius, .slices = slices, .steps = 16}));
          EXPECT_LT(here, 1e-4) << view.name << ", tilt " << tilt << ", " << slices
                                << " slices, radius " << radius;
          error = std::max(error, here);
        }
      }
    }
    fmt::print("open plane, {}: off by {:.1e}\n", view.name, error);
  }
}

TEST(Bitmask, AnOpenPlaneReadsOneWhateverWayItTurns) {
  // 45 degrees off the axis to every side, the plane turned about the view ray as well.
  const Window window{0, 0, 64, 48};
  double error = 0;
  for (int turn = 0; turn < 8; ++turn) {
    const double a = turn * kPi / 4 + 0.2;
    for (const double tilt : {10.0, 50.0, 80.0, 88.0}) {
      const Camera camera = off_axis(tilted(camera_from_fov(30, window, 1), tilt), window,
                                     {std::cos(a), std::sin(a)});
      const double here =
          worst(run(geometry_of(plane({}, {0, 0, 1}), camera, window), {.slices = 2, .steps = 16}));
      EXPECT_LT(here, 1e-4) << "turn " << turn << ", tilt " << tilt;
      error = std::max(error, here);
    }
  }
  fmt::print("open plane, 45 degrees off the axis: off by {:.1e}\n", error);
}

TEST(Bitmask, AnOpenPlaneReadsOneWhereverInItsPixelsPIs) {
  const Window window{0, 0, 64, 48};
  const Surface ground = plane({}, {0, 0, 1});
  for (const Camera& projection :
       {camera_from_fov(50, window, 1), camera_from_ortho_width(6, window, 1)}) {
    const Camera camera = tilted(projection, 75);
    Geometry g = geometry_of(ground, camera, window);
    for (int y = 0; y < window.height(); ++y) {
      for (int x = 0; x < window.width(); ++x) {
        const double aside = 0.4 * std::sin(7.0 * x + y), down = 0.4 * std::cos(x + 5.0 * y);
        const Ray ray = ray_through(camera, x + 0.5 + aside, y + 0.5 + down);
        const auto hit = ground(ray);
        if (!hit || !g.is_surface(g.surfaces.index(x, y))) continue;
        const glm::dvec3 p = camera.to_camera(ray.origin + hit->distance * ray.direction);
        g.surfaces.set_position(g.surfaces.index(x, y), glm::vec3(p));
      }
    }
    EXPECT_LT(worst(run(g, {.slices = 2, .steps = 16})), 1e-4) << projection.orthographic;
  }
}

TEST(Bitmask, ConstantLightIsThatColourTimesAo) {
  const Window window{0, 0, 96, 72};
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.6}, 0.6)});
  const glm::vec3 color(0.25f, 1, 8);
  double error = 0, occluded = 0;
  for (const Camera& projection :
       {camera_from_fov(40, window, 1), camera_from_ortho_width(5, window, 1)}) {
    const Products out = run(geometry_of(scene, tilted(projection, 50), window),
                             {.environment = Environment::constant(color),
                              .products = {.ao = true, .direct = true},
                              .slices = 3,
                              .steps = 12});
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      occluded += 1 - out.ao[i];
      for (int c = 0; c < 3; ++c)
        error = std::max(error, std::abs(out.direct[i][c] / color[c] - double(out.ao[i])));
    }
  }
  fmt::print("constant light: direct off by {:.1e} of the light\n", error);
  EXPECT_LT(error, 1e-5);
  EXPECT_GT(occluded, 100) << "the sphere hides something";
}

TEST(Bitmask, AMapOfOneColourIsConstantLight) {
  const Window window{0, 0, 96, 72};
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.6}, 0.6)});
  const glm::vec3 color(0.25f, 1, 8);
  const auto map = std::make_shared<Plane<glm::vec3>>(64, 32, color);
  const Products out = run(geometry_of(scene, tilted(camera_from_fov(40, window, 1), 50), window),
                           {.environment = Environment(map, {}),
                            .products = {.ao = true, .direct = true},
                            .slices = 3,
                            .steps = 12});
  double error = 0;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      error = std::max(error, std::abs(out.direct[i][c] / color[c] - double(out.ao[i])));
  }
  fmt::print("map of one colour: direct off by {:.1e} of the light\n", error);
  EXPECT_LT(error, 1e-5);
}

}  // namespace
}  // namespace ssdo::test::bitmask_test
