// SPDX-License-Identifier: Apache-2.0
//
// What a frame alone suggests: things are 0.85 times as thick as they are wide, and surfaces go on
// behind.
#include "scene/solids/solids.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <stdexcept>

#include "math/pixel_grid.h"
#include "scene/normals/normals.h"
#include "scene/solids/connections.h"
#include "scene/solids/plain_guess.h"
#include "scene/solids/width_of_run.h"
#include "support/analytic_scene.h"
#include "support/boxes.h"

namespace ssdo::test::solids_test {
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

glm::dvec3 world(const Geometry& g, int x, int y) {
  return glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces(x, y).position) +
         g.camera.origin;
}

bool shows_card(const Geometry& g, std::size_t i) {
  return std::abs(g.surfaces[i].position.z + 5) < 1e-4;
}

TEST(Solids, AreRefusedWithMoreLayersThanThereIsRoomFor) {
  Solids solids;
  solids.behind.assign(kMostLayers - 1, SolidLayer(1, 1, Provenance::guessed));
  EXPECT_NO_THROW(check_layers(solids));
  solids.behind.emplace_back(1, 1, Provenance::guessed);
  EXPECT_THROW(check_layers(solids), std::logic_error);
}

TEST(Solids, OfAPlaneAreEndlessAndOfOneLayer) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = geometry_of(leaning_wall(), view(orthographic), kWindow);
    const Solids solids = guess_solids(g);
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
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
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      if (!shows_card(g, i)) {
        EXPECT_TRUE(std::isinf(solids.thickness[i])) << "the wall has no end in this frame";
        continue;
      }
      // Diagonal runs cut corners off. A view ray that heads for the right side, whose place is
      // known to half a pixel, leaves through it.
      const glm::vec3 p = g.surfaces[i].position;
      const bool corner = std::abs(p.y) > 0.9 - 0.8;
      const double all = kDepthOfWidth * 0.8, slope = orthographic ? 0.0 : double(p.x) / 5;
      const auto leaves = [&](double px) {
        return slope > 0 ? std::min(all, (0.7 - double(p.x) + px * pixel) / slope) : all;
      };
      if (!corner) {
        EXPECT_GE(solids.thickness[i], leaves(-0.51) - 1.01 * pixel);
      }
      EXPECT_LE(solids.thickness[i], leaves(0.51) * std::hypot(1, slope) + 1.01 * pixel);
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
  const std::size_t of_post = g.surfaces.index(int(g.camera.cx + 0.55 / pixel), 45),
                    of_near_post = g.surfaces.index(int(g.camera.cx), 45);
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
    EXPECT_EQ(solids.provenance(0, 0), Provenance::seen);
    EXPECT_EQ(solids.provenance(1, 0), Provenance::guessed);
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      const Solid second = solids.at(1, i);
      ASSERT_EQ(second.exists(), shows_card(g, i));
      if (!second.exists()) continue;
      ASSERT_GE(second.sender, 0);
      EXPECT_FALSE(shows_card(g, std::size_t(second.sender)));
      EXPECT_TRUE(std::isinf(second.thickness)) << "as thick as where it is seen";
      const glm::vec3 found = point_behind(g, i, second.distance);
      EXPECT_LT(glm::distance(found, wall.surfaces[i].position), 1e-4);
    }
  }
}

TEST(Solids, AreThoseOfTheRunsThroughEachPixel) {
  // Lines beside each other are walked together, 64 at a time.
  const Window window{0, 0, 150, 97};
  const Surface scene = all_of({leaning_wall(), card(-0.9, 0.3, 0.9), card(1.4, 0.5, 0.4),
                                sphere({0.2, 0.3, 1.5}, 0.5), sphere({1.2, -0.6, 2}, 0.3)});
  for (const bool orthographic : {false, true}) {
    Geometry g = geometry_of(scene, view(orthographic), window);
    for (int i = 0; i < 40; ++i) g.surfaces.set(20 + i, 70 + i % 7, {});  // nothing
    const Solids solids = guess_solids(g);
    const Plane<unsigned char> connections = find_connections(g);
    const PlainGuess plain(g, connections);
    int behind = 0, thin = 0;
    for (int y = 0; y < window.height(); ++y) {
      for (int x = 0; x < window.width(); ++x) {
        if (!g.surfaces(x, y).is_surface()) continue;
        const Behind expected = plain_behind(g, plain, {x, y});
        const float thickness = plain.thickness({x, y});
        const std::size_t i = g.surfaces.index(x, y);
        if (thickness < INFINITY)
          ASSERT_NEAR(solids.thickness[i], thickness, 1e-3f * thickness) << x << ", " << y;
        else
          ASSERT_EQ(solids.thickness[i], thickness) << x << ", " << y;
        ASSERT_EQ(solids.at(1, i).distance, expected.distance) << x << ", " << y;
        ASSERT_EQ(solids.at(1, i).sender, expected.sender) << x << ", " << y;
        behind += expected.sender >= 0, thin += thickness < INFINITY;
      }
    }
    EXPECT_GT(behind, 500);
    EXPECT_GT(thin, 500);
  }
}

/// Two legs of a table, one of which passes by the other at the distance of a pixel: rows that show
/// ground between them alternate with others. A side of each is seen nearly edge-on.
TEST(Solids, OfAStraightLegAreOfOneThicknessAlongIt) {
  const Window window{0, 0, 120, 106};
  const Box near_leg{{1, -0.6, 0}, {1.1, -0.5, 1}}, far_leg{{1, 0.5, 0}, {1.1, 0.6, 1}};
  const Surface scene = all_of({plane({}, {0, 0, 1}), near_leg.surface(), far_leg.surface()});
  const Geometry g = geometry_of(
      scene,
      look_at(camera_from_fov(5, window, 1), {1.505, -4.5, 2.2}, {1.05, 0, 0.45}, {0.02, 0, 1}),
      window);
  const Solids solids = guess_solids(g);
  float least = INFINITY, most = 0, before = 0, step = 1;
  int beside_ground = 0, beside_leg = 0;
  const int foot = 102;  // from where on the leg and the ground are one surface
  for (int y = 0; y < foot; ++y) {
    // The front of the far leg: its first pixel, and the one behind its last.
    int x = 0;
    while (x < window.width() && !(std::abs(world(g, x, y).y - 0.5) < 1e-4)) ++x;
    int last = x;
    while (last < window.width() && std::abs(world(g, last, y).y - 0.5) < 1e-4) ++last;
    if (x == 0 || last - x < 10) continue;
    (world(g, x - 1, y).z < 1e-4 ? beside_ground : beside_leg) += 1;
    float thickness = 0;
    for (int k = x; k < last; ++k)
      thickness += solids.thickness[g.surfaces.index(k, y)] / float(last - x);
    least = std::min(least, thickness), most = std::max(most, thickness);
    if (before > 0) step = std::max({step, thickness / before, before / thickness});
    before = thickness;
  }
  fmt::print("{} rows beside the ground, {} beside the leg: {:.4f} to {:.4f} thick\n",
             beside_ground, beside_leg, least, most);
  EXPECT_GT(beside_ground, 10);
  EXPECT_GT(beside_leg, 10);
  EXPECT_LT(step, 1.07) << "from a row to the next";
  EXPECT_GT(least, 0.09);
  EXPECT_LT(most, 0.12);
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
  const std::size_t on_cut = band.surfaces.index(480, 345),
                    on_other = band.surfaces.index(480, 130);
  EXPECT_NEAR(of_whole.thickness[on_cut], kDepthOfWidth * 0.8, 0.02);
  EXPECT_NEAR(of_band.thickness[on_cut], of_whole.thickness[on_cut], 0.1);
  EXPECT_GT(guess_solids(band).thickness[on_cut], 1.1 * of_whole.thickness[on_cut]);
  EXPECT_LT(of_whole.thickness[on_other], 0.05) << "its lower side would be seen";
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
  const std::size_t middle = g.surfaces.index(60, 45);
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
}  // namespace ssdo::test::solids_test
