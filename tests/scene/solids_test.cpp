// SPDX-License-Identifier: Apache-2.0
//
// What a frame alone suggests: things are 0.85 times as thick as they are wide, and surfaces go on
// behind.
#include "scene/solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "math/pixel_grid.h"
#include "scene/connections.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
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

TEST(Solids, AreAsThickAsTheirLeastWidthSuggests) {
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
        EXPECT_NEAR(solids.thickness[i], kDepthOfWidth * 0.8, 1.01 * pixel);
      }
      EXPECT_LE(solids.thickness[i], kDepthOfWidth * 0.8 + 1.01 * pixel);
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
  EXPECT_NEAR(solids.thickness[of_post], kDepthOfWidth * 3 * seen, 3.01 * pixel);
  EXPECT_NEAR(solids.thickness[of_near_post], kDepthOfWidth * 0.6, 1.01 * pixel);
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

/// What the runs through one pixel say, run by run and end by end, each looked for anew.
struct PlainGuess {
  float thickness = INFINITY, distance = INFINITY;
  int sender = -1;
};

PlainGuess plain_guess(const Geometry& g, const Plane<unsigned char>& connections, int x, int y) {
  const PixelFootprint footprint(g.camera);
  const Surfel& here = g.surfel(x, y);
  PlainGuess guess;
  float nearest_px = INFINITY;
  for (std::size_t k = 0; k < kDirections.size(); ++k) {
    const auto [dx, dy] = kDirections[k];
    const float step_px = dx != 0 && dy != 0 ? 1.41421356f : 1.0f;
    const auto at = [&, dx = dx, dy = dy](int i) {
      return surface_at(g.surfel, x + i * dx, y + i * dy);
    };
    const auto joined = [&, dx = dx, dy = dy](int i) {
      return connections(x + i * dx, y + i * dy) >> k & 1;
    };
    int first = 0, last = 0;
    while (at(first - 1) && joined(first - 1)) --first;
    while (joined(last)) ++last;
    int unknown_ends = 0;
    for (const int beyond : {first - 1, last + 1}) {
      const int bx = x + beyond * dx, by = y + beyond * dy;
      const Surfel *end = at(beyond < 0 ? first : last), *other = at(beyond);
      const bool outside = bx < 0 || by < 0 || bx >= g.surfel.width || by >= g.surfel.height;
      if (outside || (other && other->position.z > end->position.z)) ++unknown_ends;
      if (!other || other->position.z > end->position.z) continue;
      const float away_px = float(beyond < 0 ? -beyond : beyond) * step_px;
      const glm::vec3 along = -direction_to_viewer(here.position, g.camera.orthographic);
      const float distance =
          glm::dot(other->normal, other->position - here.position) / glm::dot(other->normal, along);
      if (!(distance > 0 && distance < INFINITY) || away_px >= nearest_px) continue;
      nearest_px = away_px;
      guess.distance = distance, guess.sender = int(g.surfel.index(bx, by));
    }
    if (unknown_ends == 2) continue;
    const Surfel &a = *at(first), &b = *at(last);
    const float width =
        glm::distance(a.position, b.position) +
        0.5f * step_px * (footprint.at(-a.position.z) + footprint.at(-b.position.z));
    guess.thickness =
        std::min(guess.thickness, kDepthOfWidth * (width * (unknown_ends == 1 ? 3.0f : 1.0f)));
  }
  return guess;
}

TEST(Solids, AreThoseOfTheRunsThroughEachPixel) {
  // Lines beside each other are walked together, 64 at a time.
  const Window window{0, 0, 150, 97};
  const Surface scene = all_of({leaning_wall(), card(-0.9, 0.3, 0.9), card(1.4, 0.5, 0.4),
                                sphere({0.2, 0.3, 1.5}, 0.5), sphere({1.2, -0.6, 2}, 0.3)});
  for (const bool orthographic : {false, true}) {
    Geometry g = geometry_of(scene, view(orthographic), window);
    for (int i = 0; i < 40; ++i) g.surfel(20 + i, 70 + i % 7) = {};  // nothing
    const Solids solids = guess_solids(g);
    const Plane<unsigned char> connections = find_connections(g);
    int behind = 0, thin = 0;
    for (int y = 0; y < window.height(); ++y) {
      for (int x = 0; x < window.width(); ++x) {
        if (!g.surfel(x, y).is_surface()) continue;
        const PlainGuess expected = plain_guess(g, connections, x, y);
        const std::size_t i = g.surfel.index(x, y);
        ASSERT_EQ(solids.thickness[i], expected.thickness) << x << ", " << y;
        ASSERT_EQ(solids.at(1, i).distance, expected.distance) << x << ", " << y;
        ASSERT_EQ(solids.at(1, i).sender, expected.sender) << x << ", " << y;
        behind += expected.sender >= 0, thin += expected.thickness < INFINITY;
      }
    }
    EXPECT_GT(behind, 500);
    EXPECT_GT(thin, 500);
  }
}

/// Two cards, of which some rows of the frame cut one: the overview knows how tall that is.
TEST(Solids, OfSomeRowsOfAFrameAreThoseOfTheFrame) {
  const Window frame{0, 0, 960, 720}, rows{0, 0, 960, 360};
  const Surface scene = all_of(
      {leaning_wall(), card(0, 1.4, 0.4), cut(plane({0, 0, 1}, {0, 0, 1}), [](const glm::dvec3& p) {
         return std::abs(p.x) < 0.3 && std::abs(p.y - 1.2) < 0.3;
       })});
  const Camera camera = look_at(camera_from_fov(53, frame, 1), {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
  const PixelGrid grid{.stride = kOverviewStride};
  const Geometry small = geometry_of(scene, to_grid(camera, grid), grid.of(frame)),
                 whole = geometry_of(scene, camera, frame);
  Geometry band = geometry_of(scene, camera, rows);
  band.display = frame, band.part_of = frame;
  const Solids of_small = guess_solids(small), of_whole = guess_solids(whole),
               of_band = guess_solids(band, SolidsOfOverview{small, of_small.thickness});
  const std::size_t on_cut = band.surfel.index(480, 345), on_other = band.surfel.index(480, 130);
  EXPECT_NEAR(of_whole.thickness[on_cut], kDepthOfWidth * 0.8, 0.02);
  EXPECT_NEAR(of_band.thickness[on_cut], of_whole.thickness[on_cut], 0.1);
  EXPECT_GT(guess_solids(band).thickness[on_cut], 1.1 * of_whole.thickness[on_cut]);
  EXPECT_NEAR(of_whole.thickness[on_other], kDepthOfWidth * 0.6, 0.02);
  EXPECT_EQ(of_band.thickness[on_other], of_whole.thickness[on_other]);
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
  EXPECT_NEAR(solids.thickness[middle], kDepthOfWidth * 0.8, 1.01 * 5 / g.camera.fx);
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
