// SPDX-License-Identifier: Apache-2.0
//
// The solids of a frame as triangles, and whose surface rays meet.
#include "estimators/trace/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "estimators/trace/ray_scene.h"
#include "support/analytic_scene.h"
#include "support/crop.h"

namespace ssdo::test::height_field_test {
namespace {

const Window kWindow{0, 0, 64, 48};
constexpr std::size_t kPixels = 64 * 48, kCells = 63 * 47;

Camera view(bool orthographic) {
  return look_at(
      orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(40, kWindow, 1),
      {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
}

Surface wall() { return plane({}, {0, 0, 1}); }

/// A square of 1.2 x 1.2 at z = 1.
Surface card() {
  return cut(plane({0, 0, 1}, {0, 0, 1}),
             [](const glm::dvec3& p) { return std::abs(p.x) < 0.6 && std::abs(p.y) < 0.6; });
}

Geometry card_before_wall(bool orthographic) {
  return geometry_of(all_of({wall(), card()}), view(orthographic), kWindow);
}

TEST(HeightField, OfAnEndlessPlaneIsOneSheetOfFronts) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = geometry_of(wall(), view(orthographic), kWindow);
    const HeightField field = build_height_field(g, {});
    EXPECT_EQ(field.sheets.triangles.size(), 2 * kCells);
    EXPECT_EQ(field.sheets.corners.size(), kPixels) << "no backs";
    for (std::size_t i = 0; i < kPixels; ++i) {
      const glm::vec3 p(g.surfaces[i].position);
      EXPECT_LT(glm::distance(field.space.position(field.sheets.corners[i]), p), 1e-5f);
      EXPECT_EQ(field.sheets.owners[i].sender, int(i));
      EXPECT_EQ(field.sheets.owners[i].layer, 0);
    }
  }
}

TEST(HeightField, HasBacksBehindFrontsOnTheirViewRays) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = geometry_of(wall(), view(orthographic), kWindow);
    const HeightField field = build_height_field(g, constant_thickness(g, 0.5f));
    EXPECT_EQ(field.sheets.triangles.size(), 4 * kCells);
    ASSERT_EQ(field.sheets.corners.size(), 2 * kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
      const glm::vec3 back = field.space.position(field.sheets.corners[kPixels + i]);
      EXPECT_LT(glm::distance(back, point_behind(g, i, 0.5f)), 1e-4f);
    }
  }
}

TEST(HeightField, GoesOnBehindWhatIsSeenWithoutACut) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = card_before_wall(orthographic);
    const RayScene rays(build_height_field(g, guess_solids(g)));
    int behind = 0;
    for (std::size_t i = 0; i < kPixels; ++i) {
      // From halfway between card and wall, straight to the wall.
      const glm::dvec3 p(g.surfaces[i].position);
      if (p.z < -5.5) continue;
      const Owner hit = rays.first_hit(p - glm::dvec3(0, 0, 0.9), {0, 0, -1}, 0.2).owner;
      ASSERT_GE(hit.sender, 0) << "the second layer has no holes";
      EXPECT_EQ(hit.layer, 1);
      EXPECT_LT(g.surfaces[std::size_t(hit.sender)].position.z, -5.5f) << "the wall sends";
      ++behind;
    }
    EXPECT_GT(behind, 100);
  }
}

TEST(HeightField, JoinsTheSecondLayerToWhatIsSeenBeside) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = card_before_wall(orthographic);
    const HeightField field = build_height_field(g, guess_solids(g));
    std::size_t of_wall = 0;
    for (const auto& triangle : field.sheets.triangles) {
      of_wall += std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
        const auto sender = std::size_t(field.sheets.owners[corner].sender);
        return g.surfaces[sender].position.z < -5.5f;
      });
    }
    EXPECT_EQ(of_wall, 2 * kCells) << "one sheet without a cut, behind the card's edges too";
  }
}

TEST(HeightField, HoldsALayerWhateverItsNumber) {
  const Geometry g = card_before_wall(false);
  const Solids guess = guess_solids(g);
  Solids third = guess;
  SolidLayer& nothing = third.behind.emplace_back(guess.behind.front());
  std::swap(nothing, third.behind.front());
  for (float& distance : third.behind.front().distance.pixels)
    distance = std::numeric_limits<float>::infinity();
  const HeightField two = build_height_field(g, guess), three = build_height_field(g, third);
  EXPECT_EQ(two.sheets.corners, three.sheets.corners);
  EXPECT_EQ(two.sheets.triangles, three.sheets.triangles);
  EXPECT_EQ(two.cuts.corners, three.cuts.corners);
  EXPECT_EQ(three.sheets.owners[kPixels].layer, 2);
}

TEST(HeightField, HoldsAsManyLayersAsAPixelHas) {
  const Geometry g = card_before_wall(false);
  Solids solids = constant_thickness(g, 0.1f);
  for (const float distance : {0.3f, 0.6f}) {
    SolidLayer layer(64, 48, Provenance::measured);
    for (std::size_t i = 0; i < kPixels; ++i) {
      if (g.surfaces[i].position.z <= -5.5) continue;
      layer.distance[i] = distance, layer.thickness[i] = 0.1f, layer.sender[i] = int(i);
    }
    solids.behind.push_back(std::move(layer));
  }
  const RayScene rays(build_height_field(g, solids));
  const std::size_t middle = g.surfaces.index(32, 24);
  const glm::dvec3 along = glm::normalize(glm::dvec3(g.surfaces[middle].position));
  for (const auto& [from, layer] : {std::pair{-0.05, 0}, {0.2, 1}, {0.5, 2}}) {
    const glm::dvec3 origin = glm::dvec3(g.surfaces[middle].position) + from * along;
    EXPECT_EQ(rays.first_hit(origin, along, 0.15).owner.layer, layer) << from;
    EXPECT_EQ(rays.first_hit(origin, along, 0.15).owner.sender, int(middle)) << from;
    EXPECT_FALSE(rays.is_blocked(origin, along, 0.04)) << from;
  }
}

/// Then rays in a part of a frame are rounded as those in the whole.
TEST(HeightField, OfAPartDiffersInTheExponentsOfItsHeightsOnly) {
  const Camera tilted = look_at(camera_from_fov(40, kWindow, 1), {0, -5, 2}, {0, 0, 0}, {0, 0, 1});
  const Geometry whole = geometry_of(wall(), tilted, kWindow), part = crop(whole, {3, 20, 60, 48});
  const HeightField all = build_height_field(whole, {}), some = build_height_field(part, {});
  const float ratio = some.sheets.corners[0].z / all.sheets.corners[20 * 64 + 3].z;
  int exponent;
  EXPECT_EQ(std::frexp(ratio, &exponent), 0.5f);
  EXPECT_NE(exponent, 1) << "the part has another mean depth";
  for (int y = 0; y < 28; ++y) {
    for (int x = 0; x < 57; ++x) {
      const glm::vec3 &one = all.sheets.corners[whole.surfaces.index(x + 3, y + 20)],
                      &other = some.sheets.corners[part.surfaces.index(x, y)];
      ASSERT_EQ(other, one * glm::vec3(1, 1, ratio)) << x << " " << y;
    }
  }
}

TEST(HeightField, RefusesMoreLayersThanItHasRoomFor) {
  const Geometry g = card_before_wall(false);
  Solids solids = guess_solids(g);
  while (solids.layers() <= kMostLayers) solids.behind.push_back(solids.behind.front());
  EXPECT_THROW(build_height_field(g, solids), std::logic_error);
}

}  // namespace
}  // namespace ssdo::test::height_field_test
