// SPDX-License-Identifier: Apache-2.0
#include "estimators/gtao.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "estimators/obscurance_request.h"
#include "parallel/planes.h"

namespace ssdo::test::gtao_test {
namespace {

const Window kWindow{0, 0, 96, 72};

double arc(double h, double n) {
  return 0.25 * (-std::cos(2 * h - n) + std::cos(n) + 2 * h * std::sin(n));
}

/// The method in double, step by step as seed 002 prints it, for one pixel.
struct SlowGtao {
  const Geometry& g;
  double radius;
  int slices = 2, steps = 2;
  double thickness = 1;
  unsigned seed = 0;

  double ao = 1;
  glm::dvec3 bent = glm::dvec3(0);  ///< not unit
  bool doubtful = false;            ///< whether rounding may have moved a step

  double horizon(const glm::dvec3& p, const glm::dvec3& v, const Surfel& s, int x, int y,
                 double h) {
    double cosine = -1;
    bool above = false;
    double falloff = 1;
    if (x >= 0 && y >= 0 && x < g.window.width() && y < g.window.height() &&
        g.surfaces(x, y).is_surface()) {
      const glm::dvec3 to = g.camera.unproject({x + g.window.x0 + 0.5, y + g.window.y0 + 0.5},
                                               -double(g.surfaces(x, y).position.z)) -
                            p;
      const double d = glm::length(to), up = glm::dot(to, glm::dvec3(s.normal));
      cosine = glm::dot(to, v) / d;
      const double flat = double(s.rounding) + 0.001 * d;
      above = up > flat;
      doubtful |= std::abs(up - flat) < 1e-5 * (1 + d);
      falloff = std::min(2 * d * d / (radius * radius), 1.0);
    }
    if (cosine > h) return above ? glm::mix(cosine, h, falloff) : h;
    return glm::mix(cosine, h, thickness);
  }

  /// Integral of the directions from h1 to h2, with the weight of ao; (along v, across it).
  static glm::dvec2 moment(double h1, double h2, double n) {
    glm::dvec2 sum(0);
    const int parts = 64;
    for (int i = 0; i < parts; ++i) {
      const double h = h1 + (h2 - h1) * (i + 0.5) / parts;
      sum += std::cos(h - n) * std::abs(std::sin(h)) * glm::dvec2(std::cos(h), std::sin(h));
    }
    return sum * ((h2 - h1) / parts);
  }

  void look_from(int x, int y) {
    doubtful = false, ao = 0, bent = glm::dvec3(0);
    double ao_if_open = 0;
    glm::dvec3 bent_if_open(0);
    const Surfel& s = g.surfaces(x, y);
    const glm::dvec3 p(s.position), normal(s.normal);
    const glm::dvec3 v = g.camera.orthographic ? glm::dvec3(0, 0, 1) : glm::normalize(-p);
    const int column = x + g.window.x0 - g.display.x0, row = y + g.window.y0 - g.display.y0;
    // What engines add to a frame: the last of their six turns is none, and the seed begins there.
    constexpr double kTurns[] = {60, 300, 180, 240, 120, 0}, kOffsets[] = {0, 0.5, 0.25, 0.75};
    const auto part = [](double number) { return number - std::floor(number); };
    const double turn =
                     part(((((column + row) & 3) << 2) + (column & 3)) / 16.0 +
                          kTurns[(seed + 5) % 6] / 360 + part(seed / 24 * 0.7548776662466927) / 6),
                 first = part(((row - column) & 3) / 4.0 + kOffsets[seed / 6 % 4] +
                              part(seed / 24 * 0.5698402909980532) / 4);
    const double half = g.camera.fy * radius / (g.camera.orthographic ? 1 : -p.z) / 2;
    const double step = std::max(std::min(half, 512.0), double(steps)) / (steps + 1);
    for (int i = 0; i < slices; ++i) {
      const double angle = (i + turn) * glm::pi<double>() / slices;
      const glm::dvec3 direction(std::cos(angle), std::sin(angle), 0);
      double h[2] = {-1, -1};
      for (int j = 0; j < steps; ++j) {
        const double r = std::max(step * (j + first), 1.0 + j);
        const double dx = direction.x * r * g.camera.fx / g.camera.fy, dy = -direction.y * r;
        for (const double number : {dx, dy})
          doubtful |= std::abs(number - std::floor(number) - 0.5) < 1e-3;
        const int ox = int(std::lround(dx)), oy = int(std::lround(dy));
        h[0] = horizon(p, v, s, x + ox, y + oy, h[0]);
        h[1] = horizon(p, v, s, x - ox, y - oy, h[1]);
      }
      const glm::dvec3 plane = glm::normalize(glm::cross(direction, v)),
                       tangent = glm::cross(v, plane),
                       projected = normal - plane * glm::dot(normal, plane);
      const double length = glm::length(projected),
                   cos_n = std::clamp(glm::dot(projected / length, v), -1.0, 1.0),
                   sign = glm::dot(projected, tangent) < 0 ? -1 : 1, n = -sign * std::acos(cos_n);
      const double right_angle = glm::half_pi<double>();
      const double h1 = n + std::max(-std::acos(h[0]) - n, -right_angle),
                   h2 = n + std::min(std::acos(h[1]) - n, right_angle);
      const auto add = [&](double from, double to, double& sum, glm::dvec3& directions) {
        sum += length * (arc(from, n) + arc(to, n)) / slices;
        const glm::dvec2 lean = moment(from, 0, n) + moment(0, to, n);
        directions += length / slices * (v * lean.x - tangent * lean.y);
      };
      add(h1, h2, ao, bent);
      add(n - right_angle, n + right_angle, ao_if_open, bent_if_open);
    }
    bent += ao / ao_if_open * (2.0 / 3 * normal - bent_if_open);
    ao = std::clamp(ao, 0.0, 1.0);
  }
};

Products estimate(const Geometry& g, float radius, const std::vector<std::string>& set = {},
                  const Environment& sky = Environment::constant(glm::vec3(1)), unsigned seed = 0) {
  return gtao_method().estimate(scene_of(g, sky),
                                {.products = {.ao = true, .direct = true, .bent = true},
                                 .radius = radius,
                                 .seed = seed,
                                 .parameters = resolve_parameters(gtao_method(), set)},
                                {});
}

/// Compares pixels of which no step is doubtful; gives the least ao.
double expect_the_slow_result(const Geometry& g, SlowGtao slow, const Products& out) {
  double least = 1;
  int compared = 0;
  for (int y = 0; y < out.ao.height; ++y) {
    for (int x = 0; x < out.ao.width; ++x) {
      if (!g.is_surface(out.ao.index(x, y))) continue;
      slow.look_from(x, y);
      if (slow.doubtful) continue;
      EXPECT_NEAR(out.ao(x, y), slow.ao, 2e-4) << x << "," << y;
      const glm::dvec3 bent = glm::normalize(slow.bent);
      if (slow.ao > 0.05) {
        EXPECT_LT(glm::length(glm::dvec3(out.bent(x, y)) - bent), 2e-3) << x << "," << y;
      }
      least = std::min(least, slow.ao), ++compared;
    }
  }
  EXPECT_GT(compared, int(out.ao.size() / 3));
  return least;
}

Geometry room(const Camera& projection, const Window& window = kWindow) {
  return geometry_of(still_life(), look_at(projection, {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
                     window);
}

TEST(Gtao, IsTheSeedsMethodStepByStep) {
  for (const bool orthographic : {false, true}) {
    for (const double aspect : {1.0, 2.0}) {
      const Geometry g = room(orthographic ? camera_from_ortho_width(4, kWindow, aspect)
                                           : camera_from_fov(50, kWindow, aspect));
      for (const double radius : {0.5, 2.0}) {
        SCOPED_TRACE(testing::Message() << orthographic << " " << aspect << " " << radius);
        EXPECT_LT(expect_the_slow_result(g, {g, radius}, estimate(g, float(radius))), 0.6);
      }
    }
  }
}

TEST(Gtao, ItsParametersAreThoseOfTheMethod) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1), kWindow);
  expect_the_slow_result(g, {g, 1.5, 3, 7, 0.6},
                         estimate(g, 1.5f, {"slices=3", "steps=7", "thickness=0.6"}));
}

TEST(Gtao, SeedsTurnAndShiftItsPatternAsFramesOfEnginesDo) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1), kWindow);
  const Environment white = Environment::constant(glm::vec3(1));
  for (const unsigned seed : {1u, 9u, 1001u}) {
    SCOPED_TRACE(seed);
    SlowGtao slow{g, 1.5};
    slow.seed = seed;
    expect_the_slow_result(g, slow, estimate(g, 1.5f, {}, white, seed));
  }
}

TEST(Gtao, AnOpenPlaneDoesNotHideItself) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
      const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow);
      const Products out = estimate(g, 1), many = estimate(g, 1, {"slices=32"});
      for (std::size_t i = 0; i < out.ao.size(); ++i) {
        if (!g.is_surface(i)) continue;
        // Slices even on the screen are not even around rays that leave aslant.
        EXPECT_NEAR(many.ao[i], 1, g.camera.orthographic ? 0.005 : 0.03) << tilt;
        if (tilt == 0 && g.camera.orthographic) {
          EXPECT_NEAR(out.ao[i], 1, 1e-5);
        }
        // Of two slices the mean of |n_p| (cos n + n sin n) is off by itself.
        if (tilt <= 30) {
          EXPECT_GT(out.ao[i], 0.9) << tilt;
        }
      }
    }
  }
}

/// Also from an elevation of 10 degrees, and with so few slices that they do not say it themselves.
TEST(Gtao, TheBentNormalOfAnOpenPlaneIsItsNormal) {
  for (const Camera& projection :
       {camera_from_fov(20, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 70.0, 79.0}) {
      const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow);
      for (const char* slices : {"slices=1", "slices=2", "slices=7"}) {
        const Products out = estimate(g, 1, {slices});
        for (std::size_t i = 0; i < out.bent.size(); ++i) {
          if (!g.is_surface(i)) continue;
          ASSERT_LT(glm::distance(out.bent[i], g.surfaces[i].normal), 1e-4)
              << tilt << " " << slices;
        }
      }
    }
  }
}

TEST(Gtao, TheFootOfAWallSeesTheSkyThatTheWallLeaves) {
  const Window window{0, 0, 240, 96};
  const Surface scene =
      all_of({plane({}, {0, 0, 1}), cut(plane({0, 1, 0}, {0, -1, 0}),
                                        [](const glm::dvec3& p) { return p.z > 0 && p.z < 1; })});
  const Geometry g = geometry_of(
      cut(scene, [](const glm::dvec3& p) { return p.y <= 1; }),
      look_at(camera_from_ortho_width(12, window, 1), {0, -10, 10}, {0, 0.4, 0}, {0, 0, 1}),
      window);
  // A step for every pixel, and a falloff of 1 % at most.
  const Products out = estimate(g, 25.6f, {"slices=16", "steps=256"});
  int compared = 0;
  for (int y = 2; y < 94; ++y) {
    const Surfel& s = g.surfaces(120, y);
    const glm::dvec3 p =
        g.camera.origin + glm::transpose(g.camera.rotation) * glm::dvec3(s.position);
    if (!s.is_surface() || p.z > 1e-3 || p.y < -1 || p.y > 0.8) continue;
    const double to_wall = 1 - p.y, expected = 0.5 + 0.5 * to_wall / std::hypot(to_wall, 1.0);
    EXPECT_NEAR(out.ao(120, y), expected, 0.03) << "at " << p.y;
    // Of directions above the wall's edge, (y, z) is the integral of (cos, sin) sin.
    const double edge = std::atan2(1, to_wall), aside = -0.5 * std::sin(edge) * std::sin(edge),
                 up = 0.5 * (glm::pi<double>() - edge) + 0.25 * std::sin(2 * edge);
    const glm::dvec3 bent = glm::transpose(g.camera.rotation) * glm::dvec3(out.bent(120, y));
    EXPECT_NEAR(std::atan2(bent.y, bent.z), std::atan2(aside, up), 0.03) << "at " << p.y;
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

TEST(Gtao, ADistantForegroundDoesNotOcclude) {
  const Surface strip =
      cut(plane({0, 0, 4}, {0, 0, 1}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.1; });
  const Camera camera = tilted(camera_from_fov(60, kWindow, 1), 0);
  const Geometry alone = geometry_of(plane({}, {0, 0, 1}), camera, kWindow),
                 g = geometry_of(all_of({plane({}, {0, 0, 1}), strip}), camera, kWindow);
  const auto most_hidden = [&](float radius) {
    const Products with = estimate(g, radius), without = estimate(alone, radius);
    float most = 0;
    for (std::size_t i = 0; i < with.ao.size(); ++i) {
      if (g.surfaces[i].position.z < -5) most = std::max(most, without.ao[i] - with.ao[i]);
    }
    return most;
  };
  EXPECT_LT(most_hidden(1), 1e-5f);
  EXPECT_GT(most_hidden(12), 0.05f) << "within the radius it would";
}

TEST(Gtao, DirectIsTheLightOfTheBentNormalTimesAo) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1), kWindow);
  const Products out = estimate(g, 1, {}, Environment::constant(glm::vec3(1, 2, 3)));
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    const glm::vec3 expected = g.is_surface(i) ? out.ao[i] * glm::vec3(1, 2, 3) : glm::vec3(0);
    EXPECT_LT(glm::length(out.direct[i] - expected), 1e-6f);
    EXPECT_NEAR(glm::length(out.bent[i]), g.is_surface(i) ? 1 : 0, 1e-5);
  }
}

Products with_albedo(const Geometry& g, const Plane<glm::vec3>& albedo, double multi_bounce) {
  ParameterValues parameters = resolve_parameters(gtao_method(), {});
  parameters["multi-bounce"] = multi_bounce;
  Scene scene = scene_of(g, Environment::constant(glm::vec3(1, 2, 4)));
  scene.senders.albedo = in_half(albedo);
  return gtao_method().estimate(
      scene, {.products = {.ao = true, .direct = true}, .radius = 2, .parameters = parameters}, {});
}

TEST(Gtao, MultiBounceIsTheFitOfTheReceiversAlbedo) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1));
  const glm::dvec3 rho(0.875, 0.5, 0.125);  // exact in half numbers
  Plane<glm::vec3> albedo(kWindow.width(), kWindow.height(), glm::vec3(rho));
  const Products plain = with_albedo(g, albedo, 0), many = with_albedo(g, albedo, 1);
  EXPECT_EQ(plain.ao.pixels, many.ao.pixels);
  double most = 0;
  for (std::size_t i = 0; i < many.ao.size(); ++i) {
    if (!g.is_surface(i)) {
      EXPECT_EQ(many.direct[i], glm::vec3(0));
      continue;
    }
    const double x = many.ao[i];
    for (int c = 0; c < 3; ++c) {
      const double fit = x * (x * x * (2.0404 * rho[c] - 0.3324) + x * (-4.7951 * rho[c] + 0.6417) +
                              2.7552 * rho[c] + 0.6903);
      EXPECT_NEAR(many.direct[i][c], (1 << c) * std::max(x, fit), 1e-5);
      EXPECT_GE(many.direct[i][c], plain.direct[i][c]);
      most = std::max(most, fit - x);
    }
  }
  EXPECT_GT(most, 0.1);
}

TEST(Gtao, OddAlbedosStayWithinTheFit) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1));
  for (const float odd : {NAN, INFINITY, -INFINITY, 1e38f, -3.0f}) {
    Plane<glm::vec3> albedo(kWindow.width(), kWindow.height(), glm::vec3(odd));
    for (const glm::vec3& light : with_albedo(g, albedo, 1).direct.pixels)
      EXPECT_TRUE(light.x >= 0 && light.x <= 1.001f) << light.x;
  }
}

TEST(Gtao, VectorsAndThreadsChangeNothing) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1), kWindow);
  const auto ao = [&] { return estimate(g, 2).ao; };
  expect_the_same_from_every_isa(ao);
  expect_the_same_from_any_threads(ao);
}

TEST(Gtao, NothingThatComesInMakesANaN) {
  const Geometry g = broken_geometry();
  for (const float radius : {1e-30f, 1e-6f, 1.0f, 1e6f, 1e30f}) {
    SCOPED_TRACE(radius);
    for (const std::vector<std::string>& set :
         {std::vector<std::string>{}, {"thickness=0", "slices=1", "steps=1"}}) {
      const Products out = estimate(g, radius, set);
      expect_usable(out);
      for (const glm::vec3& bent : out.bent.pixels)
        EXPECT_TRUE(std::isfinite(bent.x) && std::isfinite(bent.y) && std::isfinite(bent.z));
    }
  }
}

}  // namespace
}  // namespace ssdo::test::gtao_test
