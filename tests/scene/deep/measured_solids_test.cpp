// SPDX-License-Identifier: Apache-2.0
//
// What deep images know beside what a frame shows: positions and thicknesses against geometry.
#include "scene/deep/measured_solids.h"

#include <gtest/gtest.h>

#include "scene/deep/join_measured.h"
#include "support/boxes.h"
#include "support/error_matchers.h"

namespace ssdo::test::measured_solids_test {
namespace {

const Window kWindow{0, 0, 120, 90};
constexpr float kFar = 1e9f;

/// Looks along -z from z = 6: camera space is the world's, 6 higher.
Camera view(bool orthographic) {
  return look_at(
      orthographic ? camera_from_ortho_width(6, kWindow, 1) : camera_from_fov(53, kWindow, 1),
      {0, 0, 6}, {0, 0, 0}, {0, 1, 0});
}

/// A leaning wall, a box before it, and another box between them that the first hides in part.
const Box kNear{{-1, -2, 1}, {0.4, 2, 1.5}}, kHidden{{-0.5, -1.8, -0.5}, {0.6, 1.8, 0.2}};
Surface wall() { return plane({0, 0, -1.5}, {std::sin(0.3), 0, std::cos(0.3)}); }
Surface scene() { return all_of({wall(), kNear.surface(), kHidden.surface()}); }

bool shows(const Geometry& g, std::size_t i, const Box& box) {
  return std::abs(g.surfaces[i].position.z + 6 - box.high.z) < 1e-4;
}

/// Distance between two points of a pixel's ray by their heights z in the world.
double between(const Geometry& g, std::size_t i, double from_z, double to_z) {
  if (g.camera.orthographic) return from_z - to_z;
  const glm::vec3 p(g.surfaces[i].position);
  return (from_z - to_z) * glm::length(p) / -p.z;
}

struct Found {
  Geometry geometry;
  Solids solids;
  std::vector<std::string> warnings;
};

Found find(const Surface& seen, const Camera& camera, const std::vector<DeepPixels>& elements,
           DeepDepths depths = {std::nullopt, kFar}, std::optional<float> thickness = {}) {
  Found found{geometry_of(seen, camera, kWindow), {}, {}};
  std::vector<DeepImage> images;
  for (const DeepPixels& pixels : elements) images.push_back(image_of(pixels));
  const MeasuredSolids measured = measure_solids(found.geometry, images, depths, found.warnings);
  found.solids = join_measured(found.geometry, measured, thickness);
  return found;
}

TEST(MeasuredSolids, LieWhereTheElementsLie) {
  for (const bool orthographic : {false, true}) {
    const Camera camera = view(orthographic);
    const DeepPixels deep = merged({wall(), kNear.surface(), kHidden.surface()}, camera, kWindow);
    const Found found = find(scene(), camera, {deep});
    const Geometry &g = found.geometry, wall_alone = geometry_of(wall(), camera, kWindow);
    EXPECT_TRUE(found.warnings.empty());
    int boxes = 0, walls = 0;
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      const Solid second = found.solids.at(1, i), third = found.solids.at(2, i);
      if (!shows(g, i, kNear)) continue;
      const Ray ray = ray_through(camera, double(i % 120) + 0.5, double(i / 120) + 0.5);
      const auto [enter, leave] = kHidden.cross(ray);
      ASSERT_TRUE(second.exists());
      EXPECT_EQ(found.solids.provenance(1, i), Provenance::measured);
      if (enter < leave && std::abs(ray.origin.z + enter * ray.direction.z - 0.2) < 1e-6) {
        EXPECT_NEAR(second.distance, between(g, i, 1.5, 0.2), 1e-4);
        ASSERT_TRUE(third.exists());
        EXPECT_LT(
            glm::distance(point_behind(g, i, third.distance), wall_alone.surfaces[i].position),
            1e-3);
        EXPECT_EQ(found.solids.provenance(2, i), Provenance::measured);
        EXPECT_LE(second.thickness, third.distance - second.distance + 1e-4)
            << "ends before the next";
        ++boxes;
      } else if (enter > leave) {
        EXPECT_LT(
            glm::distance(point_behind(g, i, second.distance), wall_alone.surfaces[i].position),
            1e-3);
        ++walls;
      }
      EXPECT_LE(found.solids.at(0, i).thickness, second.distance);
    }
    EXPECT_GT(boxes, 200);
    EXPECT_GT(walls, 200);
  }
}

/// The hidden part of a box that is seen beside what hides it sends its light.
TEST(MeasuredSolids, BelongToTheSurfacesThatReachBehind) {
  const Camera camera = view(true);
  const Found found = find(scene(), camera,
                           {merged({wall(), kNear.surface(), kHidden.surface()}, camera, kWindow)});
  const Geometry& g = found.geometry;
  int hidden = 0, sending = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const Solid second = found.solids.at(1, i);
    if (!shows(g, i, kNear) || std::abs(second.distance - 1.3) > 1e-4) continue;
    ++hidden;
    if (second.sender < 0) continue;
    EXPECT_TRUE(shows(g, std::size_t(second.sender), kHidden));
    ++sending;
  }
  EXPECT_GT(hidden, 500);
  EXPECT_EQ(sending, hidden);
}

TEST(MeasuredSolids, HaveMeasuredThicknesses) {
  for (const bool orthographic : {false, true}) {
    const Camera camera = view(orthographic);
    DeepPixels deep(kWindow);
    for (const Box& box : {kHidden, kNear}) add_box(box, camera, deep);
    for (const std::optional<float> given : {std::optional<float>(), {0.01f}}) {
      const Found found = find(scene(), camera, {deep}, {std::nullopt, kFar}, given);
      const Geometry& g = found.geometry;
      int pixels = 0;
      for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
        if (!shows(g, i, kNear)) continue;
        const Ray ray = ray_through(camera, double(i % 120) + 0.5, double(i / 120) + 0.5);
        const auto [enter, leave] = kNear.cross(ray);
        EXPECT_NEAR(found.solids.at(0, i).thickness, leave - enter, 1e-4);
        EXPECT_TRUE(found.solids.end_is_measured(i));
        const auto [second_enter, second_leave] = kHidden.cross(ray);
        if (second_enter > second_leave || second_leave - second_enter < 0.2) continue;
        EXPECT_NEAR(found.solids.at(1, i).thickness, second_leave - second_enter, 1e-4);
        ++pixels;
      }
      EXPECT_GT(pixels, 200);
    }
  }
}

TEST(MeasuredSolids, AreNothingWhereNothingIsHidden) {
  // A deep image that shows only what the frame shows: the guesses stay, bit by bit.
  const Camera camera = view(false);
  const Found found = find(scene(), camera, {merged({scene()}, camera, kWindow)});
  const Solids guess = guess_solids(found.geometry);
  ASSERT_EQ(found.solids.layers(), guess.layers());
  EXPECT_EQ(found.solids.thickness.pixels, guess.thickness.pixels);
  for (std::size_t i = 0; i < guess.thickness.size(); ++i)
    EXPECT_FALSE(found.solids.end_is_measured(i));
  EXPECT_EQ(found.solids.behind[0].distance.pixels, guess.behind[0].distance.pixels);
  EXPECT_EQ(found.solids.behind[0].sender.pixels, guess.behind[0].sender.pixels);
}

TEST(MeasuredSolids, DoNotDependOnHowElementsAreSplit) {
  const Camera camera = view(false);
  const std::vector<Surface> elements = {wall(), kNear.surface(), kHidden.surface()};
  const Found one = find(scene(), camera, {merged(elements, camera, kWindow)});
  std::vector<DeepPixels> apart;
  for (const Surface& element : {elements[2], elements[0], elements[1]})
    apart.push_back(merged({element}, camera, kWindow));
  // Merged once more, with the elements that overlap themselves.
  apart.push_back(merged(elements, camera, kWindow));
  const Found many = find(scene(), camera, apart);
  ASSERT_EQ(one.solids.layers(), many.solids.layers());
  EXPECT_EQ(one.solids.thickness.pixels, many.solids.thickness.pixels);
  for (std::size_t k = 0; k < one.solids.behind.size(); ++k) {
    EXPECT_EQ(one.solids.behind[k].distance.pixels, many.solids.behind[k].distance.pixels);
    EXPECT_EQ(one.solids.behind[k].thickness.pixels, many.solids.behind[k].thickness.pixels);
  }
}

TEST(MeasuredSolids, TakeTheKindOfDepthThatFitsTheFrame) {
  const Camera camera = view(false);
  DeepPixels planar(kWindow), by_ray(kWindow);
  for (const Box& box : {kHidden, kNear}) add_box(box, camera, planar);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      const float slope = float(glm::length(camera.unproject({x + 0.5, y + 0.5}, 1)));
      for (const DeepSample& s : planar.at(x, y))
        by_ray.at(x, y).push_back({s.front * slope, s.back * slope, s.alpha});
    }
  }
  const Found expected = find(scene(), camera, {planar}), chosen = find(scene(), camera, {by_ray}),
              given = find(scene(), camera, {by_ray}, {DepthKind::ray, kFar});
  EXPECT_TRUE(expected.warnings.empty());
  EXPECT_TRUE(given.warnings.empty());
  ASSERT_EQ(chosen.warnings.size(), 1u);
  EXPECT_NE(chosen.warnings[0].find("distances along the rays"), std::string::npos);
  for (std::size_t i = 0; i < expected.geometry.surfaces.size(); ++i) {
    ASSERT_EQ(chosen.solids.at(1, i).distance, given.solids.at(1, i).distance);
    ASSERT_EQ(expected.solids.at(1, i).exists(), given.solids.at(1, i).exists());
    if (!given.solids.at(1, i).exists()) continue;
    ASSERT_NEAR(expected.solids.at(1, i).distance, given.solids.at(1, i).distance, 1e-4);
  }
}

TEST(MeasuredSolids, AreRefusedOrDoubtedWhereTheyAreOfAnotherFrame) {
  const Camera camera = view(false);
  DeepPixels deep = merged({wall(), kNear.surface()}, camera, kWindow);
  for (auto& samples : deep.samples)
    for (DeepSample& s : samples) s.front *= 0.01f, s.back *= 0.01f;
  EXPECT_THAT(error_of([&] { find(scene(), camera, {deep}); }),
              IsError(ExitCode::layer, "lies in front of what the frame shows in 100 %"));
  for (auto& samples : deep.samples)
    for (DeepSample& s : samples) s.front *= 1e4f, s.back *= 1e4f;
  const Found far = find(scene(), camera, {deep});
  ASSERT_EQ(far.warnings.size(), 1u);
  EXPECT_NE(far.warnings[0].find("no sample lies on a surface"), std::string::npos);
  const DeepPixels other = merged({wall()}, camera, {0, 0, 100, 90});
  EXPECT_THAT(error_of([&] { find(scene(), camera, {other}); }),
              IsError(ExitCode::layer, "has the display window 0,0 to 99,89"));
}

/// What moved, or is not in the frame, lies in front of what the frame shows: it is left out.
TEST(MeasuredSolids, LeaveOutWhatIsInFrontOfTheFrame) {
  const Camera camera = view(true);
  const Box moved{{1.2, -1, 1}, {2, 1, 1.5}};
  DeepPixels deep = merged({scene()}, camera, kWindow);
  add_box(moved, camera, deep);
  const Found found = find(scene(), camera, {deep});
  const Solids guess = guess_solids(found.geometry);
  EXPECT_EQ(found.solids.thickness.pixels, guess.thickness.pixels);
  EXPECT_EQ(found.solids.behind[0].distance.pixels, guess.behind[0].distance.pixels);
}

}  // namespace
}  // namespace ssdo::test::measured_solids_test
