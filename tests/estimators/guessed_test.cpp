// SPDX-License-Identifier: Apache-2.0
#include "estimators/guessed.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/matrix.hpp>

#include "estimators/bitmask/request.h"
#include "math/sampling.h"
#include "math/sobol.h"
#include "scene/other_views/remove_objects.h"
#include "support/boxes.h"

namespace ssdo::test::guessed_test {
namespace {

const Window kWindow{0, 0, 160, 120};
constexpr float kPixel = 0.05f;

/// Looks straight down from above; pixels are kPixel wide.
Camera from_above() {
  return look_at(camera_from_ortho_width(kPixel * kWindow.width(), kWindow, 1), {0, 0, 5}, {},
                 {0, 1, 0});
}

Scene seen_from_above(const Surface& surface) {
  return scene_of(geometry_of(surface, from_above(), kWindow));
}

Plane<float> shares(const Scene& scene, float radius) {
  return guessed_shares(scene, {0, 0, kWindow.width(), kWindow.height()}, radius, 0, {});
}

/// Mean down eight columns from one on, which together have all directions, far from their ends.
double mean_of_columns(const Plane<float>& plane, int x) {
  double sum = 0;
  for (int y = 28; y < 92; ++y)
    for (int k = 0; k < 8; ++k) sum += double(plane(x + k, y)) / (64 * 8);
  return sum;
}

/// The same of a function of the column.
template <class Value>
double mean_of_columns(int x, const Value& value) {
  double sum = 0;
  for (int k = 0; k < 8; ++k) sum += value(x + k) / 8;
  return sum;
}

TEST(Guessed, RaysOverTheBorderAreThoseOfADiscSegment) {
  const float radius = 20 * kPixel;
  const Scene scene = seen_from_above(plane({}, {0, 0, 1}));
  const Plane<float> guessed = shares(scene, radius);
  for (const int x : {0, 4, 9, 14, 25, 80}) {
    const double exact =
        mean_of_columns(x, [](int column) { return disc_segment((column + 0.5) / 20); });
    fmt::print("from column {}: {:.3f}, exact {:.3f}\n", x, mean_of_columns(guessed, x), exact);
    EXPECT_NEAR(mean_of_columns(guessed, x), exact, 0.04);
    EXPECT_NEAR(mean_of_columns(guessed, kWindow.width() - 8 - x), exact, 0.04);
  }
  const GuessedMean mean = mean_guessed(scene, radius);
  const auto at = [&](Unseen place) { return mean.at[std::size_t(place)]; };
  EXPECT_NEAR(at(Unseen::left), at(Unseen::right), 0.005);
  EXPECT_NEAR(at(Unseen::top), at(Unseen::bottom), 0.005);
  EXPECT_GT(at(Unseen::left), 0.005);
  EXPECT_EQ(at(Unseen::behind_things), 0);
}

/// On a plane, a ray is guessed where it passes the border within the radius.
TEST(Guessed, SingleRaysAreGuessedWhereTheyPassTheBorder) {
  const float radius = 20 * kPixel;
  const Scene scene = seen_from_above(plane({}, {0, 0, 1}));
  const GuessedRays rays(scene, radius);
  constexpr int kY = 60;
  int guessed = 0, count = 0;
  for (const int x : {2, 8, 16, 40}) {
    for (int k = 0; k < 256; ++k) {
      const glm::vec3 to = cosine_direction(glm::mat3(1), sobol_point(std::uint32_t(k), 7));
      const float beyond = -to.x * radius - (float(x) + 0.5f) * kPixel;
      if (std::abs(beyond) < 1.5f * kPixel) continue;  // the end of the way
      EXPECT_EQ(rays.is_guessed(scene.geometry.surfaces.index(x, kY), to, k), beyond > 0)
          << "from column " << x << " to " << to.x;
      guessed += beyond > 0, ++count;
    }
  }
  EXPECT_GT(guessed, count / 10);
  EXPECT_LT(guessed, count / 2);
}

TEST(Guessed, NothingBehindASkyIsGuessed) {
  const Scene scene = seen_from_above(cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 3 && std::abs(p.y) < 2;
  }));
  const Plane<float> guessed = shares(scene, kNoLimit);
  for (const float share : guessed.pixels) EXPECT_EQ(share, 0);
  EXPECT_EQ(mean_guessed(scene, kNoLimit).all, 0);
}

/// A slab floats over the ground: rays from beside it that pass below its edge are lost.
TEST(Guessed, WhatPassesBelowASlab) {
  constexpr double kEdge = 0.5, kHeight = 0.6, kRadius = 1.2;
  const Scene scene = seen_from_above(
      all_of({plane({}, {0, 0, 1}), cut(plane({0, 0, kHeight}, {0, 0, 1}),
                                        [](const glm::dvec3& p) { return p.x > kEdge; })}));
  const Plane<float> guessed = shares(scene, kRadius);
  for (const int from : {68, 76, 80}) {
    const double exact = mean_of_columns(from, [](int column) {
      const double x = (column + 0.5 - kWindow.width() / 2) * double(kPixel);
      int below = 0;
      constexpr int kCount = 1 << 14;
      for_each_cosine_direction({0, 0, 1}, kCount, [&](const glm::dvec3& d) {
        const double length = (kEdge - x) / d.x;
        below += d.x > 0 && length < kRadius && length * d.z < kHeight;
      });
      return double(kGuessBehindThings) * below / kCount;
    });
    fmt::print("from column {}: {:.3f}, exact {:.3f}\n", from, mean_of_columns(guessed, from),
               exact);
    EXPECT_NEAR(mean_of_columns(guessed, from), exact, 0.02);
  }
  EXPECT_GT(mean_guessed(scene, kRadius).at[std::size_t(Unseen::behind_things)], 0.01);
}

TEST(Guessed, MeasuredSolidsAreKnown) {
  Scene scene = seen_from_above(
      all_of({plane({}, {0, 0, 1}),
              cut(plane({0, 0, 0.6}, {0, 0, 1}), [](const glm::dvec3& p) { return p.x > 0.5; })}));
  scene.solids = constant_thickness(scene.geometry, 0.8f);
  const int beside = kWindow.width() / 2;
  EXPECT_GT(mean_of_columns(shares(scene, 1), beside), 0.1) << "as thick as somebody said";
  scene.solids.end = Plane<Provenance>(kWindow.width(), kWindow.height(), Provenance::measured);
  EXPECT_EQ(mean_of_columns(shares(scene, 1), beside), 0) << "down to the ground";
  for (float& thickness : scene.solids.thickness.pixels) thickness = 0.1f;
  EXPECT_GT(mean_of_columns(shares(scene, 1), beside), 0.05)
      << "what is below the slab is not seen";
}

TEST(Guessed, SurfacesThatAreSeenAreKnown) {
  const Camera camera = tilted(camera_from_fov(60, kWindow, 1), 40);
  const Scene scene = scene_of(geometry_of(floor_and_wall(), camera, kWindow));
  const Plane<float> guessed = shares(scene, 0.5);
  EXPECT_LT(middle(
                kWindow, [&](int x, int y) { return double(guessed(x, y)); }, 16),
            0.01);
}

/// Of what casts nothing, the side that is seen is in no ray's way, and no picture shows the rest.
TEST(Guessed, WhatIsTakenOutIsNotMet) {
  const Surface floor = plane({}, {0, 0, 1}), ball = sphere({0, 0, 1}, 1);
  const Camera by = look_at(camera_from_fov(50, kWindow, 1), {0, -6, 4}, {}, {0, 0, 1});
  Scene seen = scene_of(geometry_of(all_of({floor, ball}), by, kWindow));
  const Geometry open = geometry_of(floor, by, kWindow);
  Plane<float> coverage(kWindow.width(), kWindow.height(), 0.0f);
  for (std::size_t i = 0; i < coverage.size(); ++i)
    coverage[i] = seen.geometry.surfaces[i].position != open.surfaces[i].position ? 1.0f : 0.0f;
  Scene hole = scene_of(seen.geometry);
  hole.caster_surfaces = remove_objects(hole.geometry, coverage, {}, {});
  const Plane<float> with = shares(seen, 3), without = shares(hole, 3);
  // The floor before the ball looks up at the side that is seen; the ball itself looks at the
  // floor.
  double before = 0, after = 0, count = 0;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const glm::dvec3 p =
        glm::transpose(by.rotation) * glm::dvec3(open.surfaces[i].position) + by.origin;
    if (coverage[i] > 0 || std::abs(p.x) > 0.5 || p.y < -1.5 || p.y > -0.6) continue;
    before += double(with[i]), after += double(without[i]), count += 1;
  }
  ASSERT_GT(count, 100);
  fmt::print("before the ball: {:.3f}, taken out {:.3f}\n", before / count, after / count);
  EXPECT_GT(after, before + 0.05 * count);
}

TEST(Guessed, CountsByHowOpenItsAnswerIs) {
  for (const float ao : {0.0f, 0.3f, 1.0f}) EXPECT_EQ(guessed_product(0, ao), 0);
  EXPECT_FLOAT_EQ(guessed_product(1, 0.5f), 1);
  EXPECT_NEAR(guessed_product(0.5f, 0.5f), 0.5, 0.003);
  EXPECT_NEAR(guessed_product(0.5f, 0.1f), 0.5 * 0.6, 0.003);
  EXPECT_FLOAT_EQ(guessed_product(0.5f, 0.1f), guessed_product(0.5f, 0.9f));
  EXPECT_FLOAT_EQ(guessed_product(1, 1), 0.1f) << "all is taken to be open";
  EXPECT_FLOAT_EQ(guessed_product(1, 0), 0.1f);
}

}  // namespace
}  // namespace ssdo::test::guessed_test
