// SPDX-License-Identifier: Apache-2.0
//
// Shadows of lamps, as the tool makes them at standard quality with its filter, against rays in
// double to many points of the lamp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "estimators/bitmask/request.h"
#include "filters/light_visibility.h"
#include "filters/registry.h"
#include "scene/light/lamps/lamp.h"
#include "support/boxes.h"

namespace ssdo::test::lamp_shadows_test {
namespace {

const Window kWindow{0, 0, 480, 270};

Lamp ball(const glm::dvec3& at, double radius) {
  Lamp lamp;
  lamp.position = at, lamp.radius = radius;
  return lamp;
}

Scene scene_with(const Surface& surface, const Camera& camera, const Lamp& lamp) {
  const Geometry g = geometry_of(surface, camera, kWindow);
  Scene scene = scene_of(g, Environment::constant(glm::vec3(0)), 0.5f);
  scene.solids = guess_solids(g);
  scene.light.sources.push_back(make_source(lamp, {camera.rotation, camera.origin}, 1e-4));
  return scene;
}

Products lit(const Scene& scene, int bounces = 0) {
  Products out =
      bitmask_method().estimate(scene,
                                {.products = {.ao = true, .direct = true, .bounce = bounces > 0},
                                 .radius = kNoLimit,
                                 .bounces = bounces,
                                 .slices = 2,
                                 .steps = 16},
                                {});
  return filter_visibility(find_filter("geometry"), std::move(out), scene, 8);
}

/// The share of a ball's light that arrives at each pixel: as found, and by rays to a disc in its
/// place. -1 where the surface turns away from it.
struct Shadows {
  Plane<double> found, exact;

  Shadows(const Surface& surface, const Camera& camera, const Lamp& lamp, int rays = 24)
      : found(kWindow.width(), kWindow.height(), -1), exact(found) {
    const Scene scene = scene_with(surface, camera, lamp);
    const Products out = lit(scene);
    for (int y = 0; y < found.height; ++y) {
      for (int x = 0; x < found.width; ++x) {
        if (!surface(ray_through(camera, x + 0.5, y + 0.5))) continue;
        const Surfel& s = scene.geometry.surfaces(x, y);
        const float all = scene.light.unoccluded(s.position, s.normal).x;
        const Point p = point_at(surface, camera, kWindow, x, y);
        const glm::dvec3 way = lamp.position - p.position, to = glm::normalize(way);
        if (glm::dot(to, p.normal) < 0.1) continue;
        const glm::dvec3 t = glm::normalize(glm::cross(to, glm::dvec3(0.3, 0.5, 0.8))),
                         b = glm::cross(to, t);
        double open = 0;
        for (int i = 0; i < rays; ++i) {
          const double r = lamp.radius * std::sqrt((i + 0.5) / rays),
                       a = i * kPi * (3 - std::sqrt(5.0));
          const glm::dvec3 point = way + r * (std::cos(a) * t + std::sin(a) * b);
          open += is_open(surface, p, glm::normalize(point), glm::length(point));
        }
        found(x, y) = double(out.direct(x, y).x / all), exact(x, y) = open / rays;
      }
    }
  }

  /// The mean of what is found where this much arrives, and how many pixels that is.
  double mean_where(double arrives, int& count) const {
    double sum = 0;
    count = 0;
    for (std::size_t i = 0; i < exact.size(); ++i)
      if (exact[i] == arrives) sum += found[i], ++count;
    return sum / std::max(count, 1);
  }
  double leak() const {
    int count = 0;
    const double mean = mean_where(0, count);
    EXPECT_GT(count, 20) << "there is an umbra";
    return mean;
  }
  double open() const {
    int count = 0;
    const double mean = mean_where(1, count);
    EXPECT_GT(count, 1000);
    return mean;
  }
};

Camera from_above() {
  return look_at(camera_from_fov(50, kWindow, 1), {0, -8, 4}, {0, 0, 0.5}, {0, 0, 1});
}
Surface ground() { return plane({}, {0, 0, 1}); }

TEST(LampShadows, ThinPostsKeepTheirsUnderNearAndFarLamps) {
  const double pixel = 8.5 / from_above().fx, x = 0.5 * pixel, height = 2;
  const Camera camera =
      look_at(camera_from_fov(50, kWindow, 1), {x, -8, 4}, {x, 0, 0.5}, {0, 0, 1});
  const Surface scene = all_of({ground(), post(1.5 * pixel, height)});
  for (const glm::dvec3& to : {glm::dvec3(0.38, 0.92, 0.6), glm::dvec3(-1, -0.35, 0.62)}) {
    for (const double times : {1.0, 3.0, 10.0, 50.0}) {
      const glm::dvec3 way = times * height * glm::normalize(to);
      const Shadows s(scene, camera, ball(glm::dvec3(0, 0, 0.5 * height) + way, 0.008 * times));
      fmt::print("lamp {} heights away: {:.3f} leaks, {:.4f} of the open\n", times, s.leak(),
                 s.open());
      EXPECT_LT(s.leak(), 0.1) << times;
      EXPECT_GT(s.open(), 0.99) << times;
    }
  }
}

/// A ground of flat triangles with corners on a grid, up or down by `height`, which shades as if it
/// were level: a dense mesh with smooth normals.
Surface facets(double side, double height) {
  const auto corner = [=](double x, double y) {
    const auto mixed = std::uint32_t(int(x) * 73856093) ^ std::uint32_t(int(y) * 19349663);
    return height * (2 * double(mixed * 2654435769u >> 8) / double(1 << 24) - 1);
  };
  const auto height_at = [=](const glm::dvec3& at) {
    const double x = std::floor(at.x / side), y = std::floor(at.y / side), u = at.x / side - x,
                 v = at.y / side - y, diagonal = u + v < 1 ? corner(x, y) : corner(x + 1, y + 1),
                 along_x = u + v < 1 ? u : 1 - u, along_y = u + v < 1 ? v : 1 - v,
                 beside_x = u + v < 1 ? corner(x + 1, y) : corner(x, y + 1),
                 beside_y = u + v < 1 ? corner(x, y + 1) : corner(x + 1, y);
    return diagonal + along_x * (beside_x - diagonal) + along_y * (beside_y - diagonal);
  };
  return [=](const Ray& ray) -> std::optional<Hit> {
    std::optional<Hit> hit = ground()(ray);
    for (int k = 0; hit && k < 30; ++k) {
      const glm::dvec3 at = ray.origin + hit->distance * ray.direction;
      hit->distance += (height_at(at) - at.z) / ray.direction.z;
    }
    return hit;
  };
}

/// Under a lamp that grazes the facets, single pixels lost all light: a neighbour on the next facet
/// rises a little over a pixel's tangent plane, and what is so near is not filtered.
TEST(LampShadows, FacetsOfADenseMeshAreNotSpeckled) {
  const Scene scene = scene_with(facets(0.06, 0.002), from_above(), ball({-9, 3, 1}, 0.8));
  const Products out = lit(scene);
  const auto share = [&](int x, int y) {
    const Surfel& s = scene.geometry.surfaces(x, y);
    return out.direct(x, y).x / scene.light.unoccluded(s.position, s.normal).x;
  };
  int dark = 0;
  for (int y = 120; y < kWindow.height() - 8; ++y) {
    for (int x = 60; x < kWindow.width() - 60; ++x) {
      const float beside =
          std::min({share(x - 1, y), share(x + 1, y), share(x, y - 1), share(x, y + 1)});
      dark += share(x, y) < 0.25f * beside;
    }
  }
  fmt::print("{} dark pixels\n", dark);
  EXPECT_LT(dark, 40) << "442 if fronts that rise by less count too";
}

/// A room without its front wall.
Surface room() {
  return all_of({Box{{-3, -4, -1}, {3, 4, 0}}.surface(), Box{{-3, -4, 4}, {3, 4, 5}}.surface(),
                 Box{{-4, -4, -1}, {-3, 4, 5}}.surface(), Box{{3, -4, -1}, {4, 4, 5}}.surface(),
                 Box{{-4, 4, -1}, {4, 5, 5}}.surface()});
}

TEST(LampShadows, ALampBehindTheCameraLightsTheRoomThatItStandsIn) {
  const Surface scene = all_of({room(), Box{{-1.4, 0.5, 0}, {-0.2, 1.7, 2}}.surface()});
  const Camera camera =
      look_at(camera_from_fov(60, kWindow, 1), {0, -8, 2}, {0, 0, 1.8}, {0, 0, 1});
  const Shadows s(scene, camera, ball({2.5, -9, 2.5}, 0.02));
  fmt::print("lamp behind the camera: {:.4f} leaks, {:.4f} of the open\n", s.leak(), s.open());
  EXPECT_LT(s.leak(), 0.08) << "the box is taken to be as deep as it appears wide";
  EXPECT_GT(s.open(), 0.98);
}

/// The rays to the lamp pass the camera on its right, and the lamp stands on its left.
TEST(LampShadows, RaysGoPastTheCameraToALampBehindIt) {
  const Surface scene = all_of({ground(), plane({0, 6, 0}, {0, -1, 0}), post(0.06, 2)});
  const Camera camera =
      look_at(camera_from_fov(60, kWindow, 1), {-1.5, -6, 2}, {-1.5, 10, 1.8}, {0, 0, 1});
  const Shadows s(scene, camera, ball({-3, -40, 2.5}, 0.02));
  fmt::print("lamp far behind the camera: {:.4f} leaks, {:.4f} of the open\n", s.leak(), s.open());
  EXPECT_LT(s.leak(), 0.1);
  EXPECT_GT(s.open(), 0.98);
}

TEST(LampShadows, WhatStandsBehindALampHidesNothing) {
  const Surface scene = all_of({ground(), Box{{-3, 2, 0}, {3, 2.3, 3}}.surface()});
  const Shadows s(scene, from_above(), ball({0, 1.2, 1}, 0.05));
  EXPECT_GT(s.open(), 0.99);
}

TEST(LampShadows, LampsOfAnySizeAnywhereAreFinite) {
  const Surface scene = all_of({ground(), Box{{-1, -0.5, 0}, {0.6, 0.9, 1.2}}.surface()});
  // Half in the ground, around all that is seen, in a box, at the camera, less than a pixel near.
  const Lamp lamps[] = {ball({-2, -1, 0}, 0.3), ball({0, 0, 1}, 50), ball({0, 0.2, 0.6}, 0.2),
                        ball({0, -8, 4}, 0.1), ball({-2, -1, 1e-4}, 1e-3)};
  for (const Lamp& lamp : lamps) {
    const Scene lit_scene = scene_with(scene, from_above(), lamp);
    const Products out = lit(lit_scene, 2);
    float most = 0;
    for (std::size_t i = 0; i < out.direct.size(); ++i) {
      for (int c = 0; c < 3; ++c) {
        ASSERT_TRUE(std::isfinite(out.direct[i][c]) && std::isfinite(out.bounce[i][c]));
        ASSERT_GE(std::min(out.direct[i][c], out.bounce[i][c]), 0);
        most = std::max({most, out.direct[i][c], out.bounce[i][c]});
      }
    }
    EXPECT_LE(most, 1.001f) << "the radiance of the lamp";
  }
}

}  // namespace
}  // namespace ssdo::test::lamp_shadows_test
