// SPDX-License-Identifier: Apache-2.0
//
// What a frame alone suggests: things are as thick as they are wide, and surfaces go on behind.
#include "scene/solids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "support/analytic_scene.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 120, 90};

/// Looks along -z from z = 6: camera space is the world's, 6 higher.
Camera view(bool orthographic) {
  return look_at(
      orthographic ? camera_from_ortho_width(6, kWindow, 1) : camera_from_fov(53, kWindow, 1),
      {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
}

/// The part of the plane z = 1 with |x - x0| < a and |y| < b.
Surface card(double x0, double a, double b) {
  return cut(plane({0, 0, 1}, {0, 0, 1}),
             [=](const glm::dvec3& p) { return std::abs(p.x - x0) < a && std::abs(p.y) < b; });
}

/// A plane that leans by 20 degrees, from 1.5 to 3 units behind z = 1.
Surface leaning_wall() {
  const double t = 0.349;
  return plane({0, 0, -1.3}, {std::sin(t), 0, std::cos(t)});
}

bool shows_card(const Geometry& g, std::size_t i) {
  return std::abs(g.surfel[i].position.z + 5) < 1e-4;
}

TEST(Solids, AreRefusedWithMoreLayersThanThereIsRoomFor) {
  Solids solids;
  solids.behind.assign(kMostLayers - 1, SolidLayer(1, 1, Origin::guessed));
  EXPECT_NO_THROW(check_layers(solids));
  solids.behind.emplace_back(1, 1, Origin::guessed);
  EXPECT_THROW(check_layers(solids), std::logic_error);
}

TEST(Solids, OfAPlaneAreEndlessAndOfOneLayer) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = geometry_of(leaning_wall(), view(orthographic), kWindow);
    const Solids solids = guess_solids(g);
    for (std::size_t i = 0; i < g.surfel.size(); ++i) {
      ASSERT_TRUE(std::isinf(solids.thickness[i]));
      for (int k = 1; k < solids.layers(); ++k) ASSERT_FALSE(solids.at(k, i).exists());
    }
  }
}

TEST(Solids, AreAsThickAsTheirLeastWidth) {
  for (const bool orthographic : {false, true}) {
    const Geometry g =
        geometry_of(all_of({leaning_wall(), card(0.3, 0.4, 0.9)}), view(orthographic), kWindow);
    const Solids solids = guess_solids(g);
    const double pixel = (orthographic ? 1.0 : 5.0) / g.camera.fx;
    int pixels = 0;
    for (std::size_t i = 0; i < g.surfel.size(); ++i) {
      if (!shows_card(g, i)) {
        EXPECT_TRUE(std::isinf(solids.thickness[i])) << "the wall has no end in this frame";
        continue;
      }
      // Diagonal runs cut corners off.
      const bool corner = std::abs(g.surfel[i].position.y) > 0.9 - 0.8;
      if (!corner) {
        EXPECT_NEAR(solids.thickness[i], 0.8, 1.01 * pixel);
      }
      EXPECT_LE(solids.thickness[i], 0.8 + 1.01 * pixel);
      ++pixels;
    }
    EXPECT_NEAR(pixels * pixel * pixel, 0.8 * 1.8, 0.1);
  }
}

TEST(Solids, CountThreeTimesWhatIsSeenOfThemBesideSomethingNearer) {
  // A post, from the upper end of the picture to the lower one, whose left side is behind another.
  const double seen = 0.5;
  const Surface near_post =
      cut(plane({0, 0, 2}, {0, 0, 1}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.3; });
  const Surface post = cut(plane({0, 0, 1}, {0, 0, 1}),
                           [=](const glm::dvec3& p) { return p.x > -0.2 && p.x < 0.3 + seen; });
  const Geometry g = geometry_of(all_of({leaning_wall(), near_post, post}), view(true), kWindow);
  const Solids solids = guess_solids(g);
  const double pixel = 1 / g.camera.fx;
  const std::size_t of_post = g.surfel.index(int(g.camera.cx + 0.55 / pixel), 45),
                    of_near_post = g.surfel.index(int(g.camera.cx), 45);
  EXPECT_NEAR(solids.thickness[of_post], 3 * seen, 3.01 * pixel);
  EXPECT_NEAR(solids.thickness[of_near_post], 0.6, 1.01 * pixel);
}

TEST(Solids, BehindACardAreTheTangentPlaneThatReachesIt) {
  for (const bool orthographic : {false, true}) {
    const Geometry g =
        geometry_of(all_of({leaning_wall(), card(0.3, 0.4, 0.9)}), view(orthographic), kWindow);
    const Geometry wall = geometry_of(leaning_wall(), view(orthographic), kWindow);
    const Solids solids = guess_solids(g);
    ASSERT_EQ(solids.layers(), 2);
    EXPECT_EQ(solids.origin(0, 0), Origin::seen);
    EXPECT_EQ(solids.origin(1, 0), Origin::guessed);
    for (std::size_t i = 0; i < g.surfel.size(); ++i) {
      const Solid second = solids.at(1, i);
      ASSERT_EQ(second.exists(), shows_card(g, i));
      if (!second.exists()) continue;
      ASSERT_GE(second.sender, 0);
      EXPECT_FALSE(shows_card(g, std::size_t(second.sender)));
      EXPECT_TRUE(std::isinf(second.thickness)) << "as thick as where it is seen";
      const glm::vec3 found = point_behind(g, i, second.distance);
      EXPECT_LT(glm::distance(found, wall.surfel[i].position), 1e-4);
    }
  }
}

TEST(Solids, BehindThingsAreAsThickAsWhereTheyAreSeen) {
  const Geometry g =
      geometry_of(all_of({leaning_wall(), card(0.3, 0.4, 0.9)}), view(false), kWindow);
  Solids solids = guess_solids(g);
  std::size_t hidden = 0;
  while (!solids.at(1, hidden).exists()) ++hidden;
  float& seen = solids.thickness[std::size_t(solids.at(1, hidden).sender)];
  seen = 0.5f;
  EXPECT_EQ(solids.at(1, hidden).thickness, 0.5f);
  solids.separate_thicknesses();
  seen = 0.25f;
  EXPECT_EQ(solids.at(1, hidden).thickness, 0.5f) << "one of its own";
}

TEST(Solids, AreOfOneLayerBeforeTheBackground) {
  // Nothing is farther than the card: where it ends is background.
  const Geometry g = geometry_of(card(0, 0.4, 0.9), view(false), kWindow);
  const Solids solids = guess_solids(g);
  const std::size_t middle = g.surfel.index(60, 45);
  EXPECT_NEAR(solids.thickness[middle], 0.8, 1.01 * 5 / g.camera.fx);
  EXPECT_FALSE(solids.at(1, middle).exists());
}

TEST(Solids, OfConstantThicknessHaveOneLayer) {
  const Geometry g = geometry_of(card(0, 0.4, 0.9), view(false), kWindow);
  const Solids solids = constant_thickness(g, 0.25f);
  EXPECT_EQ(solids.layers(), 1);
  EXPECT_EQ(solids.at(0, 7).thickness, 0.25f);
  EXPECT_EQ(solids.at(0, 7).distance, 0);
  EXPECT_EQ(solids.at(0, 7).sender, 7);
  EXPECT_TRUE(std::isinf(Solids{}.at(0, 7).thickness)) << "endless where nothing is known";
}

}  // namespace
}  // namespace ssdo::test
