// SPDX-License-Identifier: Apache-2.0
//
// Method trace against closed forms and against rays in double, and its properties.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#include "estimators/trace_request.h"
#include "parallel/tiles.h"

namespace ssdo::test::trace_test {
namespace {

const Window kWindow{0, 0, 96, 72};
const Window kFine{0, 0, 240, 200};

Geometry ground_seen_at(double tilt, bool orthographic) {
  const Camera camera =
      orthographic ? camera_from_ortho_width(2, kWindow, 1) : camera_from_fov(20, kWindow, 1);
  return geometry_of(plane({}, {0, 0, 1}), tilted(camera, tilt), kWindow);
}

TEST(Trace, AnOpenPlaneReadsOneAtEveryTilt) {
  for (const bool orthographic : {false, true}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0, 89.0, 89.9}) {
      const Geometry g = ground_seen_at(tilt, orthographic);
      for (const float radius : {0.5f, kNoLimit}) {
        const Products out =
            run_trace(g, {.radius = radius, .products = {.ao = true, .bent = true}});
        double worst = 1, off = 0;
        for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
          if (!g.is_surface(i)) continue;
          worst = std::min(worst, double(out.ao[i]));
          off = std::max(off, double(glm::distance(out.bent[i], g.surfaces[i].normal)));
        }
        EXPECT_GE(worst, 1 - 1e-4) << "tilt " << tilt << ", orthographic " << orthographic;
        EXPECT_LE(off, 1e-5) << "tilt " << tilt;
      }
    }
  }
}

/// As a file stores it with half precision: the ground is a staircase.
TEST(Trace, AnOpenPlaneOfHalfFloatsReadsOne) {
  Geometry g = ground_seen_at(50, false);
  g.surfaces.change_each([](Surfel& s) {
    for (int c = 0; c < 3; ++c) {
      int exponent;
      std::frexp(s.position[c], &exponent);
      const float step = std::ldexp(1.0f, exponent - 11);
      s.position[c] = std::round(s.position[c] / step) * step;
    }
    s.rounding = glm::length(s.position) / 2048;
  });
  const Products out = run_trace(g, {});
  double sum = 0;
  for (const float ao : out.ao.pixels) sum += ao;
  EXPECT_GE(sum / double(out.ao.size()), 0.998);
}

using Formula = std::function<double(const glm::dvec3&)>;

double mean_error(const Surface& scene, const Camera& camera, const Window& window,
                  const TraceRequest& request, const Formula& formula) {
  const Products out = run_trace(geometry_of(scene, camera, window), request);
  return middle(
      window,
      [&](int x, int y) {
        return out.ao(x, y) - formula(point_at(scene, camera, window, x, y).position);
      },
      8);
}

TEST(Trace, BesideAWall) {
  const Formula wall = [](const glm::dvec3& p) { return 1 - disc_segment(-p.y); };
  const Window window{0, 0, 480, 400};
  for (const double x : {0.06, 0.6}) {
    const glm::dvec3 at(0, -x, 0);
    const TraceRequest request{.samples = 48};
    EXPECT_NEAR(
        mean_error(floor_and_wall(), tilted(camera_from_ortho_width(2.4, window, 1), 30, 6, at),
                   window, request, wall),
        0, 3e-3)
        << "orthographic, x " << x;
    EXPECT_NEAR(mean_error(floor_and_wall(), tilted(camera_from_fov(30, window, 1), 50, 4.5, at),
                           window, request, wall),
                0, 3e-3)
        << "perspective, x " << x;
  }
}

/// The last row of the floor before the wall has the foot of the wall within a pixel.
TEST(Trace, AtTheFootOfAWallHalfIsHidden) {
  const Camera camera = tilted(camera_from_ortho_width(2.4, kFine, 1), 45);
  const Geometry g = geometry_of(floor_and_wall(), camera, kFine);
  const Products out = run_trace(g, {});
  double sum = 0, count = 0;
  for (int x = 80; x < 160; ++x) {
    for (int y = 1; y < kFine.height(); ++y) {
      const Point above = point_at(floor_and_wall(), camera, kFine, x, y - 1),
                  here = point_at(floor_and_wall(), camera, kFine, x, y);
      if (above.normal.z > 0.5 || here.normal.z < 0.5) continue;
      const double expected = 1 - disc_segment(-here.position.y);
      EXPECT_NEAR(expected, 0.5, 0.02);
      sum += out.ao(x, y) - expected;
      ++count;
    }
  }
  ASSERT_EQ(count, 80);
  EXPECT_NEAR(sum / count, 0, 4e-3);
}

TEST(Trace, ASphereOnAPlane) {
  const double r = 0.4;
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0, 0, r}, r)});
  // Share of the cosine that a sphere hides which does not cut the horizon: h cos / d^2.
  const Formula formula = [=](const glm::dvec3& p) {
    const double d2 = glm::dot(p, p) + r * r - 2 * p.z * r;
    return 1 - r * r / d2 * (r / std::sqrt(d2));
  };
  for (const double away : {0.8, 1.2}) {
    // Before the sphere, whose seen half hides nearly all that the whole hides.
    const glm::dvec3 at(0, -away, 0);
    const Camera camera = tilted(camera_from_fov(30, kFine, 1), 40, 5, at);
    EXPECT_NEAR(mean_error(scene, camera, kFine, {.radius = kNoLimit}, formula), 0, 4e-3) << away;
  }
}

/// What is open of a square pit is what a view of its bottom sees: four walls of one depth.
TEST(Trace, AtTheBottomOfAPit) {
  const double half = 0.5, depth = 0.4;
  const auto inside = [=](const glm::dvec3& p) {
    return std::abs(p.x) < half + 1e-9 && std::abs(p.y) < half + 1e-9;
  };
  const auto wall = [=](const glm::dvec3& n) {
    return cut(plane(-half * n, n),
               [=](const glm::dvec3& p) { return inside(p) && p.z < 1e-9 && p.z > -depth - 1e-9; });
  };
  const Surface scene =
      all_of({cut(plane({}, {0, 0, 1}), [=](const glm::dvec3& p) { return !inside(p); }),
              cut(plane({0, 0, -depth}, {0, 0, 1}), inside), wall({1, 0, 0}), wall({-1, 0, 0}),
              wall({0, 1, 0}), wall({0, -1, 0})});
  const Camera camera = tilted(camera_from_fov(24, kFine, 1), 0, 5, {0, 0, -depth});
  const Formula by_rays = [&](const glm::dvec3& p) {
    return ao_by_rays(scene, {p, {0, 0, 1}}, HUGE_VAL, 1 << 11);
  };
  const TraceRequest request{.radius = kNoLimit};
  EXPECT_NEAR(mean_error(scene, camera, kFine, request, by_rays), 0, 5e-3);
}

/// A strip before a wall that it does not touch, as long as the frame is high: points of the wall
/// beside it see past its back.
TEST(Trace, AThinThingHidesWhatIsInItsThickness) {
  const double half = 0.1, gap = 1;
  const auto in_strip = [=](const glm::dvec3& p) {
    return std::abs(p.x) < half + 1e-9 && std::abs(p.y) < 1;
  };
  const Surface strip = cut(plane({0, 0, gap}, {0, 0, 1}), in_strip);
  const Surface scene = all_of({plane({}, {0, 0, 1}), strip});
  const Camera camera = tilted(camera_from_ortho_width(2.4, kFine, 1), 0, 6, {0.5, 0, 0});
  const Geometry g = geometry_of(scene, camera, kFine);
  double before = 1;
  for (const double thickness : {1e-4, 0.2, 0.5}) {
    const Solids solids = constant_thickness(g, float(thickness));
    const Products out = run_trace(g, {.radius = kNoLimit, .solids = &solids});
    const double found = middle(
        kFine, [&](int x, int y) { return double(out.ao(x, y)); }, 8);
    const Surface bar = all_of({strip, cut(plane({0, 0, gap - thickness}, {0, 0, 1}), in_strip),
                                cut(plane({half, 0, 0}, {1, 0, 0}), [=](const glm::dvec3& p) {
                                  return in_strip(p) && p.z < gap && p.z > gap - thickness;
                                })});
    const double expected = ao_by_rays(bar, {{0.5, 0, 0}, {0, 0, 1}}, HUGE_VAL, 1 << 14);
    EXPECT_NEAR(found, expected, 4e-3) << "thickness " << thickness;
    EXPECT_LT(expected, before - 0.01);
    before = expected;
  }
}

Surface still_life() {
  return all_of(
      {floor_and_wall(), sphere({0.4, -0.7, 0.4}, 0.4), sphere({-0.6, -0.4, 0.25}, 0.25)});
}
const Window kStill{0, 0, 131, 77};
Camera still_camera() { return tilted(camera_from_fov(36, kStill, 1), 50, 5, {0, -0.4, 0.2}); }
TraceRequest all_products() {
  return {.radius = 1.5f,
          .products = {.ao = true, .direct = true, .bent = true, .error = true},
          .samples = 16,
          .bounces = 2};
}

template <class Value>
bool same_bits(const Plane<Value>& a, const Plane<Value>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.size() * sizeof(Value)) == 0;
}

bool same_bits(const Products& a, const Products& b) {
  return same_bits(a.ao, b.ao) && same_bits(a.direct, b.direct) && same_bits(a.bounce, b.bounce) &&
         same_bits(a.bent, b.bent) && same_bits(a.error, b.error);
}

Environment gradient_sky() {
  const auto map = std::make_shared<Plane<glm::vec3>>(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      // A sky that falls off to the ground, redder to one side, with a sun.
      const float up = 1 - float(y) / 32;
      (*map)(x, y) = up * glm::vec3(0.4f + 0.3f * std::sin(float(x) / 10), 0.5f, 0.8f);
      if (x == 20 && y == 8) (*map)(x, y) = glm::vec3(300, 280, 250);
    }
  }
  return {map, {.up = UpAxis::z}};
}

TEST(Trace, AnyNumberOfThreadsGivesTheSameBits) {
  const Geometry g = geometry_of(still_life(), still_camera(), kStill);
  const Solids solids = guess_solids(g);
  TraceRequest request = all_products();
  request.solids = &solids;
  request.environment = gradient_sky();
  std::vector<Products> outs;
  for (const int threads : {1, 2, 7, 7}) {
    const ThreadLimit limit(threads);
    outs.push_back(run_trace(g, request));
  }
  for (const Products& out : outs) EXPECT_TRUE(same_bits(out, outs[0]));
}

TEST(Trace, AConstantLightGivesItsShare) {
  const Geometry g = geometry_of(still_life(), still_camera(), kStill);
  TraceRequest request = all_products();
  request.environment = Environment::constant({2, 0.5f, 3});
  const Products out = run_trace(g, request);
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const glm::vec3 expected = g.is_surface(i) ? out.ao[i] * glm::vec3(2, 0.5f, 3) : glm::vec3(0);
    ASSERT_LE(glm::distance(out.direct[i], expected), 1e-5f);
  }
}

/// In a closed room of albedo a whose walls all send light, each bounce multiplies by a: here by
/// what is hidden, since a frame's room is open to the viewer.
TEST(Trace, TheFurnace) {
  const Geometry g = geometry_of(still_life(), still_camera(), kStill);
  TraceRequest request = all_products();
  request.albedo = 1;
  request.bounces = 8;
  request.products.error = false;
  request.radius = 1e6f;
  request.samples = 64;
  // With white surfaces all that is not seen of the light comes by bounces: direct + bounce tends
  // to 1 from below, and one more bounce never takes light away.
  glm::vec3 before(0);
  for (const int bounces : {1, 2, 8}) {
    request.bounces = bounces;
    const Products out = run_trace(g, request);
    glm::dvec3 sum(0);
    double count = 0;
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      if (!g.is_surface(i)) continue;
      const glm::vec3 all = out.direct[i] + out.bounce[i];
      ASSERT_LE(all.x, 1 + 1e-4f);
      sum += all;
      ++count;
    }
    const glm::vec3 mean(sum / count);
    EXPECT_GT(mean.x, before.x);
    before = mean;
  }
  EXPECT_NEAR(before.x, 1, 0.01);
}

/// The definitions of direct and bounce by rays in double, on a floor before a wall that is bright.
TEST(Trace, DirectAndBounceByRays) {
  const Environment sky = gradient_sky();
  const Camera camera = tilted(camera_from_fov(30, kFine, 1), 45, 4.5, {0, -0.4, 0});
  const Geometry g = geometry_of(floor_and_wall(), camera, kFine);
  const Products out = run_trace(g, {.radius = 1,
                                     .products = {.ao = true, .direct = true},
                                     .samples = 256,
                                     .environment = sky,
                                     .albedo = 0.5f,
                                     .bounces = 1});
  const auto direct_at = [&](const Point& p, int rays) {
    glm::dvec3 sum(0);
    for_each_cosine_direction(p.normal, rays, [&](const glm::dvec3& d) {
      if (is_open(floor_and_wall(), p, d, 1)) sum += glm::dvec3(sky.radiance(glm::vec3(d)));
    });
    return sum / double(rays);
  };
  glm::dvec3 direct(0), bounce(0);
  const int half = 2;
  for (int y = -half; y < half; ++y) {
    for (int x = -half; x < half; ++x) {
      const int px = 120 + 4 * x, py = 100 + 4 * y;
      const Point p = point_at(floor_and_wall(), camera, kFine, px, py);
      glm::dvec3 arriving(0);
      for_each_cosine_direction(p.normal, 1 << 8, [&](const glm::dvec3& d) {
        const auto hit = floor_and_wall()({p.position + 1e-7 * p.normal, d});
        if (!hit || hit->distance > 1) return;
        arriving += direct_at({p.position + hit->distance * d, hit->normal}, 1 << 8);
      });
      direct += (glm::dvec3(out.direct(px, py)) - direct_at(p, 1 << 17)) / 16.0;
      bounce += (glm::dvec3(out.bounce(px, py)) - 0.5 * arriving / double(1 << 8)) / 16.0;
    }
  }
  fmt::print("direct off by {:+.4f} {:+.4f} {:+.4f}, bounce by {:+.4f} {:+.4f} {:+.4f}\n", direct.x,
             direct.y, direct.z, bounce.x, bounce.y, bounce.z);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(direct[c], 0, 0.01);
    EXPECT_NEAR(bounce[c], 0, 0.01);
  }
}

/// The error of a pixel is what many runs with other seeds spread by; parts of one sequence are
/// more even together than the estimate knows.
TEST(Trace, TheErrorIsThatOfTheNoise) {
  const Geometry g = geometry_of(still_life(), still_camera(), kStill);
  TraceRequest request = all_products();
  request.bounces = 1;
  request.samples = 64;
  const Products few = run_trace(g, request);
  request.samples = 1024;
  const Products many = run_trace(g, request);
  double said = 0, found = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const double difference =
        few.direct[i].x + few.bounce[i].x - many.direct[i].x - many.bounce[i].x;
    found += difference * difference;
    said += few.error[i] * few.error[i];
  }
  const double ratio = std::sqrt(said / found);
  fmt::print("error said / found {:.2f}\n", ratio);
  EXPECT_GT(ratio, 1);
  EXPECT_LT(ratio, 2);
}

TEST(Trace, BrokenPixelsBreakNoOthers) {
  Geometry g = geometry_of(still_life(), still_camera(), kStill);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  int k = 0;
  for (const float bad : {nan, INFINITY, -INFINITY, 1e30f, 1e-40f}) {
    for (std::size_t c = 0; c < 3; ++c) {
      g.surfaces.position[c](20 + 7 * k, 20) = bad;
      g.surfaces.normal[c](20 + 7 * k++, 40) = bad;
    }
  }
  const Solids solids = guess_solids(g);
  TraceRequest request = all_products();
  request.solids = &solids;
  request.environment = gradient_sky();
  request.albedo = INFINITY;
  const Products out = run_trace(g, request);
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    ASSERT_TRUE(out.ao[i] >= 0 && out.ao[i] <= 1) << i;
    for (const Plane<glm::vec3>* plane : {&out.direct, &out.bounce, &out.bent}) {
      const glm::vec3& v = (*plane)[i];
      ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) << i;
    }
    ASSERT_TRUE(std::isfinite(out.error[i])) << i;
  }
}

TEST(Trace, FramesOfNothingAndOfOnePixel) {
  Geometry nothing;
  nothing.window = nothing.display = {0, 0, 5, 4};
  nothing.surfaces = Surfaces(5, 4);
  const Products out = run_trace(nothing, all_products());
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    EXPECT_EQ(out.ao[i], 1);
    EXPECT_EQ(out.direct[i], glm::vec3(0));
  }
  for (const Window& window : {Window{0, 0, 1, 1}, {0, 0, 1, 9}, {0, 0, 9, 1}}) {
    const Geometry g =
        geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(30, window, 1), 30), window);
    const Products one = run_trace(g, all_products());
    for (const float ao : one.ao.pixels) EXPECT_EQ(ao, 1);
  }
}

}  // namespace
}  // namespace ssdo::test::trace_test
