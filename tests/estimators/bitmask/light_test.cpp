// SPDX-License-Identifier: Apache-2.0
//
// Light from directions: band-limited environments against sums over rays, and bent normals.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "estimators/bitmask/closed_form.h"
#include "math/spherical_harmonics.h"

namespace ssdo::test::light_test {
namespace {

/// Bands 0 to 2, different in every channel and nowhere dark.
glm::vec3 sky_radiance(const glm::vec3& d) {
  const auto basis = sh_basis(d);
  const float red[] = {4, 0.6f, 0.9f, -0.5f, 0.3f, 0.2f, 0.4f, -0.3f, 0.3f},
              green[] = {4, -0.8f, 0.5f, 0.4f, 0, 0.5f, -0.4f, 0.2f, 0.1f},
              blue[] = {4, 0.3f, -0.9f, 0.9f, -0.2f, 0, 0.2f, 0.5f, -0.4f};
  glm::vec3 sum(0);
  for (std::size_t i = 0; i < 9; ++i) sum += basis[i] * glm::vec3(red[i], green[i], blue[i]);
  return sum;
}

Environment sky() {
  const auto map = std::make_shared<Plane<glm::vec3>>(256, 128);
  const Environment directions(map, {.up = UpAxis::z});
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) {
      (*map)(x, y) = sky_radiance(directions.texel_direction(x, y));
      for (int c = 0; c < 3; ++c) EXPECT_GT((*map)(x, y)[c], 0);
    }
  }
  return {map, {.up = UpAxis::z}};
}

/// The definition of direct by rays: the mean of what the map shows where nothing hides it.
glm::dvec3 direct_by_rays(const Surface& scene, const Point& p, double radius,
                          const Environment& environment, int rays = 1 << 15) {
  glm::dvec3 sum(0);
  for_each_cosine_direction(p.normal, rays, [&](const glm::dvec3& d) {
    if (is_open(scene, p, d, radius)) sum += glm::dvec3(environment.radiance(glm::vec3(d)));
  });
  return sum / double(rays);
}

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

TEST(BitmaskLight, TheModelKeepsABandLimitedSky) {
  const Light model = model_light(sky(), glm::mat3(1));
  EXPECT_TRUE(model.sources.empty());
  EXPECT_GE(model.order, 2);
}

TEST(BitmaskLight, AnOpenPlaneHasTheWholeIrradiance) {
  const Window window{0, 0, 96, 72};
  const Environment environment = sky();
  const Surface scene = plane({}, {0, 0, 1});
  double error = 0;
  const glm::dvec3 expected =
      direct_by_rays(scene, {{0, 0, 0}, {0, 0, 1}}, kNoLimit, environment, 1 << 18);
  for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
    for (const Camera& projection :
         {camera_from_fov(60, window, 1), camera_from_ortho_width(6, window, 1)}) {
      const Geometry g = geometry_of(scene, tilted(projection, tilt), window);
      const Products out = run(g, {.environment = environment,
                                   .products = {.ao = true, .direct = true},
                                   .slices = 2,
                                   .steps = 12});
      for (std::size_t i = 0; i < out.direct.size(); ++i) {
        if (g.is_surface(i))
          error = std::max(error, largest(glm::dvec3(out.direct[i]) / expected - 1.0));
      }
    }
  }
  fmt::print("open plane under a sky of two bands: direct off by {:.1e}\n", error);
  EXPECT_LT(error, 1e-3);
}

/// Relative error of direct in the middle of a frame, on average over a square of 1/30 its width.
glm::dvec3 error_of_direct(const Surface& scene, const Camera& camera, const Window& window,
                           const Environment& environment) {
  const int half = window.width() / 60;
  const Window receivers = middle_square(window, half);
  const Products out =
      run(geometry_of(scene, camera, window), {.environment = environment,
                                               .products = {.ao = true, .direct = true},
                                               .receivers = receivers});
  return middle(
      window,
      [&](int x, int y) {
        const Point p = point_at(scene, camera, window, x, y);
        return glm::dvec3(at_pixel(out.direct, receivers, x, y)) /
                   direct_by_rays(scene, p, 1, environment, 1 << 13) -
               1.0;
      },
      half);
}

TEST(BitmaskLight, BesideAWallItIsTheSumOverOpenDirections) {
  const Environment environment = sky();
  const Surface scene = floor_and_wall();
  for (const double x : {0.2, 0.6}) {
    for (const Camera& projection :
         {camera_from_ortho_width(2.4, kFineWindow, 1), camera_from_fov(30, kFineWindow, 1)}) {
      const Camera camera = tilted(projection, 45, 4.5, {0, -x, 0});
      const glm::dvec3 fine = error_of_direct(scene, camera, kFineWindow, environment),
                       coarse =
                           error_of_direct(scene, halved(camera), halved(kFineWindow), environment),
                       limit = 2.0 * fine - coarse;
      fmt::print(
          "direct, x/R {}, {}: relative error {:+.1e}, {:+.1e}, {:+.1e}; limit {:+.1e}, "
          "{:+.1e}, {:+.1e}\n",
          x, projection.orthographic ? "ortho" : "persp", fine.x, fine.y, fine.z, limit.x, limit.y,
          limit.z);
      EXPECT_LT(largest(limit), 3e-3) << x;
    }
  }
}

TEST(BitmaskLight, ABandAlongTheHorizonIsHiddenByWhatIsLow) {
  const Window window{0, 0, 96, 64};
  const Surface scene =
      all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.45}, 0.45), sphere({1.3, -0.4, 0.3}, 0.3)});
  const Camera camera = tilted(camera_from_fov(35, window, 1), 55);
  const Geometry g = geometry_of(scene, camera, window);
  const Solids solids = guess_solids(g);
  for (const int rows : {2, 4}) {
    auto map = std::make_shared<Plane<glm::vec3>>(128, 64, glm::vec3(0.02f));
    for (int y = 32 - rows; y < 32; ++y)
      for (int x = 0; x < 128; ++x) (*map)(x, y) = glm::vec3(3);
    const Environment environment(map, {.up = UpAxis::z});
    const Products out = run(g, {.radius = kNoLimit,
                                 .environment = environment,
                                 .products = {.ao = true, .direct = true},
                                 .slices = 32,
                                 .steps = 32,
                                 .solids = &solids});
    double sum = 0, off = 0, squares = 0, count = 0;
    for (int y = 1; y < window.height(); y += 4) {
      for (int x = 2; x < window.width(); x += 6) {
        const Point p = point_at(scene, camera, window, x, y);
        double light = 0;
        for (int v = 0; v < 64; ++v) {
          for (int u = 0; u < 128; ++u) {
            const glm::dvec3 d(environment.texel_direction(u, v));
            const double cosine = glm::dot(d, p.normal);
            if (cosine <= 0 || scene({p.position + 1e-6 * p.normal, d})) continue;
            light += cosine * double((*map)(u, v).x * environment.texel_solid_angle(v)) / kPi;
          }
        }
        const double error = double(out.direct(x, y).x) - light;
        sum += light, off += error, squares += error * error, count += 1;
      }
    }
    fmt::print("a band of {:.1f} degrees at the horizon: direct off by {:+.3f}, RMSE {:.3f}\n",
               rows * 180 / 64.0, off / sum, std::sqrt(squares / count) * count / sum);
    EXPECT_LT(std::abs(off / sum), 0.03) << rows;
    EXPECT_LT(std::sqrt(squares / count) * count / sum, 0.12) << rows;
  }
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

TEST(BitmaskLight, TheBentNormalOfAnOpenSurfaceIsItsNormal) {
  const Window window{0, 0, 96, 72};
  for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
    for (const int slices : {2, 3, 16}) {
      for (const Camera& projection :
           {camera_from_fov(60, window, 1), camera_from_ortho_width(6, window, 1)}) {
        const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), window);
        const Products out =
            run(g, {.products = {.ao = true, .bent = true}, .slices = slices, .steps = 12});
        double error = 0;
        for (std::size_t i = 0; i < out.bent.size(); ++i)
          error = std::max(error, double(glm::length(out.bent[i] - g.surfaces[i].normal)));
        fmt::print("bent normal, open, {}, tilt {:<2}, {:>2} slices: off by {:.1e}\n",
                   projection.orthographic ? "ortho" : "persp", tilt, slices, error);
        EXPECT_LT(error, 1e-3) << tilt << ", " << slices;
      }
    }
  }
}

/// How far from the normal the mean open direction leans beside a wall: the moments of the disc
/// without a segment, (2/3) (1 - c^2)^(3/2) away from the wall and 2 pi / 3 -
/// pi/2 (2/3 - c + c^3/3) along the normal. atan(2 / pi) at the foot.
double lean_beside_wall(double c) {
  const double away = 2 / 3.0 * std::pow(1 - c * c, 1.5),
               along = 2 * kPi / 3 - kPi / 2 * (2 / 3.0 - c + c * c * c / 3);
  return std::atan(away / along);
}

TEST(BitmaskLight, TheBentNormalLeansAwayFromAWall) {
  EXPECT_NEAR(lean_beside_wall(0), std::atan(2 / kPi), 1e-12);
  const Surface scene = floor_and_wall();
  for (const double x : {0.1, 0.3, 0.7}) {
    const Camera camera = tilted(camera_from_fov(30, kFineWindow, 1), 45, 4.5, {0, -x, 0});
    const Window receivers = middle_square(kFineWindow);
    const Products out = run(geometry_of(scene, camera, kFineWindow),
                             {.products = {.ao = true, .bent = true}, .receivers = receivers});
    const glm::dvec3 mean = middle(kFineWindow, [&](int px, int py) {
      return glm::transpose(camera.rotation) * glm::dvec3(at_pixel(out.bent, receivers, px, py));
    });
    const auto point = [&](int px, int py) { return point_at(scene, camera, kFineWindow, px, py); };
    const glm::dvec3 expected = middle(kFineWindow, [&](int px, int py) {
      const double lean = lean_beside_wall(-point(px, py).position.y);
      return glm::dvec3(0, -std::sin(lean), std::cos(lean));
    });
    glm::dvec3 by_rays(0);
    const Point p{{0, -x, 0}, {0, 0, 1}};
    for_each_cosine_direction(p.normal, 1 << 16, [&](const glm::dvec3& d) {
      if (is_open(scene, p, d, 1)) by_rays += d;
    });
    fmt::print(
        "bent normal, x/R {}: expected {:.2f}, by rays {:.2f} degrees from N, off by {:.3f}\n", x,
        degrees_between(expected, p.normal), degrees_between(by_rays, p.normal),
        degrees_between(mean, expected));
    EXPECT_LT(degrees_between(by_rays, expected), 0.05);
    EXPECT_LT(degrees_between(mean, expected), 0.2);
  }
}

}  // namespace
}  // namespace ssdo::test::light_test
