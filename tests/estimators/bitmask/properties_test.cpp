// SPDX-License-Identifier: Apache-2.0
//
// What must not matter: threads, crops, scale, the place of the display window; and what broken
// pixels may not do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#include "estimators/bitmask/request.h"
#include "parallel/tiles.h"

namespace ssdo::test::properties_test {
namespace {

const Window kWindow{0, 0, 131, 77};

Surface still_life() {
  return all_of(
      {floor_and_wall(), sphere({0.4, -0.7, 0.4}, 0.4), sphere({-0.6, -0.4, 0.25}, 0.25)});
}
Camera camera(double width = 3.2) {
  return tilted(camera_from_fov(2 * glm::degrees(std::atan(width / 10)), kWindow, 1), 50, 5,
                {0, -0.4, 0.2});
}

BitmaskRequest all_products(float radius = 0.5f) {
  return {.radius = radius,
          .products = {.ao = true, .direct = true, .bent = true},
          .slices = 3,
          .steps = 12,
          .bounces = 2};
}

template <class Value>
bool same_bits(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Pixels of which any product differs in any bit.
std::size_t count_differences(const Products& a, const Products& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.ao.size(); ++i) {
    count += !(same_bits(a.ao[i], b.ao[i]) && same_bits(a.direct[i], b.direct[i]) &&
               same_bits(a.bounce[i], b.bounce[i]) && same_bits(a.bent[i], b.bent[i]));
  }
  return count;
}

TEST(BitmaskProperties, AnyNumberOfThreadsGivesTheSameBits) {
  const Geometry g = geometry_of(still_life(), camera(), kWindow);
  const Solids solids = guess_solids(g);
  BitmaskRequest request = all_products();
  request.solids = &solids;
  std::vector<Products> outs;
  for (const int threads : {1, 2, 7}) {
    const ThreadLimit limit(threads);
    outs.push_back(run(g, request));
  }
  EXPECT_EQ(count_differences(outs[0], outs[1]), 0);
  EXPECT_EQ(count_differences(outs[0], outs[2]), 0);
}

/// The pixels of `g` in a smaller window.
Geometry crop(const Geometry& g, const Window& to) {
  Geometry out = g;
  out.window = to;
  out.surfaces = Surfaces(to.width(), to.height());
  for (int y = 0; y < to.height(); ++y) {
    for (int x = 0; x < to.width(); ++x)
      out.surfaces.set(x, y, g.surfaces(x + to.x0 - g.window.x0, y + to.y0 - g.window.y0));
  }
  return out;
}

/// Least distance of a point in camera space from the planes through the eye and the sides of the
/// middles of a window's outermost pixels.
double distance_to_sides(const Geometry& g, const glm::dvec3& p) {
  double least = HUGE_VAL;
  const auto side = [&](double f, double c, double edge, double across) {
    least = std::min(least, std::abs(f * across - (edge - c) * -p.z) / std::hypot(f, edge - c));
  };
  side(g.camera.fx, g.camera.cx, g.window.x0 + 0.5, p.x);
  side(g.camera.fx, g.camera.cx, g.window.x1 - 0.5, p.x);
  side(-g.camera.fy, g.camera.cy, g.window.y0 + 0.5, p.y);
  side(-g.camera.fy, g.camera.cy, g.window.y1 - 0.5, p.y);
  return least;
}

TEST(BitmaskProperties, ACropChangesNothingFartherThanTheRadiusFromItsEdge) {
  const Geometry whole = geometry_of(still_life(), camera(), kWindow);
  const float radius = 0.35f;
  BitmaskRequest request = all_products(radius);
  request.bounces = 0;  // each bounce reaches farther by the radius
  request.radiance = {};
  const Products full = run(whole, request);
  std::size_t same = 0, different = 0;
  for (const Window& window : {Window{17, 9, 111, 70}, {20, 8, 120, 77}, {3, 2, 98, 67}}) {
    const Geometry part = crop(whole, window);
    const Products cut = run(part, request);
    for (int y = 0; y < window.height(); ++y) {
      for (int x = 0; x < window.width(); ++x) {
        if (!part.is_surface(part.surfaces.index(x, y))) continue;
        const glm::dvec3 p(part.surfaces(x, y).position);
        if (distance_to_sides(part, p) <= radius * 1.001) continue;
        const int fx = x + window.x0, fy = y + window.y0;
        const bool equal = same_bits(cut.ao(x, y), full.ao(fx, fy)) &&
                           same_bits(cut.direct(x, y), full.direct(fx, fy)) &&
                           same_bits(cut.bent(x, y), full.bent(fx, fy));
        ++(equal ? same : different);
      }
    }
  }
  fmt::print("crops: {} pixels with the same bits, {} with others\n", same, different);
  EXPECT_EQ(different, 0);
  EXPECT_GT(same, 3000);
}

/// `g` in units 1 / `scale` as long.
Geometry scaled(Geometry g, float scale) {
  g.surfaces.change_each([scale](Surfel& s) {
    s.position *= scale;
    if (s.is_surface()) s.rounding *= scale;
  });
  if (g.camera.orthographic) g.camera.fx /= scale, g.camera.fy /= scale;
  return g;
}

TEST(BitmaskProperties, TheSceneMayBeMeasuredInAnyUnit) {
  for (const Camera& view :
       {camera(), tilted(camera_from_ortho_width(3.2, kWindow, 1), 50, 5, {0, -0.4, 0.2})}) {
    const Geometry g = geometry_of(still_life(), view, kWindow);
    const Products usual = run(g, {.radius = 0.5f, .slices = 3, .steps = 12});
    // Powers of two round nothing. Others move samples across the edges of sectors.
    for (const float scale : {1 / 1024.0f, 1024.0f, 1e-3f, 1e3f}) {
      const Products out =
          run(scaled(g, scale), {.radius = 0.5f * scale, .slices = 3, .steps = 12});
      std::size_t off = 0;
      double worst = 0, sum = 0;
      for (std::size_t i = 0; i < out.ao.size(); ++i) {
        const double error = std::abs(out.ao[i] - usual.ao[i]);
        off += error > 1e-4;
        worst = std::max(worst, error);
        sum += error / double(out.ao.size());
      }
      fmt::print(
          "scale {:g}, {}: {} of {} pixels off by more than 1e-4, at most {:.1e}, mean {:.1e}\n",
          scale, view.orthographic ? "ortho" : "persp", off, out.ao.size(), worst, sum);
      EXPECT_LT(sum, 1e-4) << scale;
      const bool exact = scale == 1024 || scale == 1 / 1024.0f;
      EXPECT_TRUE(!exact || off == 0) << scale;
    }
  }
}

TEST(BitmaskProperties, ACameraMayBeRolled) {
  const Surface scene =
      all_of({plane({}, {0, 0, 1}), sphere({0.3, 0, 0.5}, 0.5),
              cut(plane({0, 1.2, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; })});
  const Window wide{0, 0, 192, 108}, tall{0, 0, 108, 192};
  const glm::dvec3 eye(0.5, -3, 1.6), target(0, 0, 0.4), up(0, 0, 1);
  const Camera level = look_at(camera_from_fov(50, wide, 1), eye, target, up);
  Camera on_edge = camera_from_fov(50, tall, 1);
  on_edge.fx = level.fx, on_edge.fy = level.fy;
  const glm::dvec3 right = glm::cross(glm::normalize(target - eye), up);
  const Camera rolled = look_at(on_edge, eye, target, right);
  const auto mean_ao = [&](const Camera& camera, const Window& window) {
    const Geometry g = geometry_of(scene, camera, window);
    const Solids solids = guess_solids(g);
    const Products out = run(g, {.radius = kNoLimit, .slices = 8, .steps = 48, .solids = &solids});
    double sum = 0;
    for (const float ao : out.ao.pixels) sum += ao / double(out.ao.size());
    return sum;
  };
  const double one = mean_ao(level, wide), other = mean_ao(rolled, tall);
  fmt::print("mean ao: {:.4f} level, {:.4f} rolled by 90 degrees\n", one, other);
  EXPECT_LT(one, 0.9) << "something is hidden";
  EXPECT_NEAR(one, other, 0.004);
}

TEST(BitmaskProperties, ThePatternMovesWithTheDisplayWindow) {
  const Geometry g = geometry_of(still_life(), camera(), kWindow);
  const Products here = run(g, all_products());
  for (const auto& [dx, dy] : {std::pair{4, 8}, {-64, 400}, {5, 3}, {-6, -1}}) {
    Geometry moved = g;
    for (Window* w : {&moved.window, &moved.display})
      w->x0 += dx, w->x1 += dx, w->y0 += dy, w->y1 += dy;
    moved.camera.cx += dx, moved.camera.cy += dy;
    EXPECT_EQ(count_differences(here, run(moved, all_products())), 0) << dx << ", " << dy;
  }
}

TEST(BitmaskProperties, ThePatternGoesOnInOverscan) {
  // The display window begins a little after the frame, or whole patterns before it.
  const auto with_display_at = [](int offset) {
    Geometry g = geometry_of(still_life(), camera(), kWindow);
    g.display.x0 += offset, g.display.x1 += offset, g.display.y0 += offset, g.display.y1 += offset;
    return run(g, all_products());
  };
  EXPECT_EQ(count_differences(with_display_at(3), with_display_at(3 - 16)), 0);
  EXPECT_GT(count_differences(with_display_at(3), with_display_at(2)), 0);
}

void expect_sane(const Products& out) {
  std::size_t bad = 0;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    bad += !(out.ao[i] >= 0 && out.ao[i] <= 1);
    for (int c = 0; c < 3; ++c) {
      bad += !std::isfinite(out.direct[i][c]) || !std::isfinite(out.bounce[i][c]) ||
             !std::isfinite(out.bent[i][c]);
    }
  }
  EXPECT_EQ(bad, 0);
}

TEST(BitmaskProperties, NothingThatComesInMakesANaN) {
  const float nan = std::nanf(""), inf = kNoLimit;
  const Geometry g = geometry_of(still_life(), camera(), kWindow);
  const glm::vec3 positions[] = {{nan, nan, nan},    {0, 0, nan},     {inf, 0, -1},
                                 {0, 0, -inf},       {0, 0, inf},     {1e30f, 0, -1e30f},
                                 {0, 0, 0},          {0, 0, -1e-40f}, {0, 0, 5},
                                 {3e38f, 3e38f, -1}, {0, 0, -1e-30f}};
  const glm::vec3 normals[] = {{0, 0, 0}, {nan, 0, 1}, {inf, 0, 0}, {0, 0, -1}, {1e-30f, 0, 0}};
  for (const float radius : {1e-6f, 0.5f, 1e6f, kNoLimit}) {
    for (const bool extend : {false, true}) {
      BitmaskRequest request = all_products(radius);
      request.extend = extend;
      for (const glm::vec3& position : positions) {
        Geometry broken = g;
        for (const int x : {0, 40, 41, 90, 130}) {
          const Surfel s = broken.surfaces(x, x % 77);
          broken.surfaces.set(x, x % 77, {position, s.normal, std::max(s.rounding, 0.0f)});
        }
        SCOPED_TRACE(fmt::format("position {} {} {}, radius {}", position.x, position.y, position.z,
                                 radius));
        expect_sane(run(broken, request));
      }
      for (const glm::vec3& normal : normals) {
        Geometry broken = g;
        for (const int x : {0, 40, 41, 90, 130})
          broken.surfaces.set(x, x % 77, {broken.surfaces(x, x % 77).position, normal, 1e-7f});
        SCOPED_TRACE(
            fmt::format("normal {} {} {}, radius {}", normal.x, normal.y, normal.z, radius));
        expect_sane(run(broken, request));
      }
    }
  }
}

TEST(BitmaskProperties, BackgroundIsOpenAndDark) {
  Geometry g = geometry_of(still_life(), camera(), kWindow);
  g.surfaces = Surfaces(kWindow.width(), kWindow.height());
  const Products out = run(g, all_products());
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    ASSERT_EQ(out.ao[i], 1);
    ASSERT_EQ(out.direct[i], glm::vec3(0));
    ASSERT_EQ(out.bounce[i], glm::vec3(0));
    ASSERT_EQ(out.bent[i], glm::vec3(0));
  }
  const Products ball =
      run(geometry_of(sphere({}, 0.5), tilted(camera_from_fov(40, kWindow, 1), 30), kWindow),
          all_products());
  EXPECT_EQ(ball.ao(0, 0), 1);
  EXPECT_EQ(ball.direct(0, 0), glm::vec3(0));
  EXPECT_NEAR(ball.ao(65, 38), 1, 1e-4) << "a sphere before nothing is not hidden by the nothing";
}

TEST(BitmaskProperties, FramesMayBeAsSmallAsAPixel) {
  for (const Window& window : {Window{0, 0, 1, 1},
                               {0, 0, 1, 50},
                               {0, 0, 50, 1},
                               {0, 0, 2, 3},
                               {7, -3, 8, 40},
                               {-5, 2, 60, 3}}) {
    for (const bool extend : {false, true}) {
      BitmaskRequest request = all_products(kNoLimit);
      request.extend = extend;
      const Products out =
          run(geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(20, window, 1), 40), window),
              request);
      expect_sane(out);
      for (const float ao : out.ao.pixels) EXPECT_NEAR(ao, 1, 1e-4) << window.width();
      expect_sane(
          run(geometry_of(floor_and_wall(), tilted(camera_from_fov(20, window, 1), 40), window),
              request));
    }
  }
}

TEST(BitmaskProperties, BelowAPixelTheRadiusReachesNothing) {
  // A pixel covers 0.024; the wall and its floor meet between two rows of pixels.
  const Products out = run(
      geometry_of(floor_and_wall(),
                  tilted(camera_from_ortho_width(3.2, kWindow, 1), 45, 6, {0, 0.017, 0}), kWindow),
      all_products(1e-3f));
  for (const float ao : out.ao.pixels) ASSERT_EQ(ao, 1);
  for (const glm::vec3& bounce : out.bounce.pixels) ASSERT_EQ(bounce, glm::vec3(0));
}

}  // namespace
}  // namespace ssdo::test::properties_test
