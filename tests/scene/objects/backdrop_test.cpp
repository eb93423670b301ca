// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/backdrop.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "scene/objects/backdrop_shapes.h"
#include "support/analytic_scene.h"

namespace ssdo::test::backdrop_test {
namespace {

constexpr Window kWindow{0, 0, 160, 90};

Camera camera(const glm::dvec3& target = {0, 2, 1}) {
  return look_at(camera_from_fov(55, kWindow, 1), {0.3, -6, 2.2}, target, {0, 0, 1});
}

const Surface kFloor = plane({0, 0, 0}, {0, 0, 1}), kBall = sphere({0.1, 0.6, 0.5}, 0.5),
              kStage = cut(kFloor, [](const glm::dvec3&p) { return glm::length(p) < 30; });

Geometry frame(const std::vector<Surface>& shown, const Camera& by = camera()) {
  return geometry_of(all_of(shown), by, kWindow);
}

bool is_backdrop(const Geometry& geometry) {
  const auto found = find_backdrop(geometry);
  return found && found->is_far();
}

/// Upright, about the origin, seen from the inside.
Surface cylinder(double radius) {
  return [radius](const Ray& ray) -> std::optional<Hit> {
    const glm::dvec2 o(ray.origin), d(ray.direction);
    const double a = glm::dot(d, d), b = glm::dot(o, d) / a,
                 t = -b + std::sqrt(b * b - (glm::dot(o, o) - radius * radius) / a);
    const glm::dvec2 inward = -(o + t * d) / radius;
    return Hit{t, {inward, 0}};
  };
}

TEST(Backdrop, ADomeIsFound) {
  for (const double radius : {150.0, 1000.0, 1e6}) {
    const Geometry with = frame({kStage, kBall, dome({0, 0, 0}, radius)}),
                   without = frame({kStage, kBall});
    const auto found = find_backdrop(with);
    ASSERT_TRUE(found && found->is_far()) << radius;
    EXPECT_EQ(found->what, fmt::format("a dome of radius {:.3g} around everything", radius));
    double pixels = 0;
    for (std::size_t i = 0; i < found->coverage.size(); ++i) {
      EXPECT_EQ(found->coverage[i] > 0, !without.is_surface(i)) << i;
      pixels += double(found->coverage[i]);
    }
    EXPECT_NEAR(found->share, pixels / double(kWindow.area()), 1e-9);
  }
}

/// However much of the frame it covers, and wherever its middle is.
TEST(Backdrop, ADomeIsFoundWhereverTheCameraLooks) {
  for (const glm::dvec3& target : {glm::dvec3(0, 2, 8), {0, 2, -0.5}, {9, -6, 4}, {0.3, -5, 30}}) {
    const Geometry with = frame({kStage, kBall, dome({20, 30, -40}, 400)}, camera(target));
    EXPECT_TRUE(is_backdrop(with));
  }
}

/// Far from all else, with nothing in between: a card, the sides of a box and a cylinder.
TEST(Backdrop, FarWallsBehindAGapAreFound) {
  const auto shows = [](const std::vector<Surface>& shown, const std::string& what,
                        const Camera& by = camera()) {
    const Geometry with = frame(shown, by), without = frame({kStage, kBall}, by);
    const auto found = find_backdrop(with);
    ASSERT_TRUE(found && found->is_far()) << what;
    EXPECT_TRUE(found->what.starts_with(what)) << found->what;
    for (std::size_t i = 0; i < found->coverage.size(); ++i)
      ASSERT_EQ(found->coverage[i] > 0, with.is_surface(i) && !without.is_surface(i)) << i;
  };
  const auto side = [](const glm::dvec3& normal) { return plane(-900.0 * normal, normal); };
  shows({kStage, kBall, side({0, -1, 0})}, "a plane behind everything, from a distance of 9");
  shows({kStage, kBall, side({0.6, -0.8, 0})}, "a plane behind everything");
  shows({kStage, kBall, side({0.6, -0.8, 0}), side({-0.6, -0.8, 0})}, "2 planes behind everything");
  // A narrow lens does not tell a cylinder from a dome.
  const Camera wide =
      look_at(camera_from_fov(110, kWindow, 1), {0.3, -6, 2.2}, {0, 2, 2.2}, {0, 0, 1});
  shows({kStage, kBall, cylinder(700)}, "a cylinder of radius 700 around everything", wide);
}

/// A gap is a backdrop from ten times on; with a set behind the gap, or sky above, it is none.
TEST(Backdrop, WallsNeedAWideGapAndNoSkyAboveThem) {
  const auto card = [](double away, double top) {
    return cut(plane({0, away, 0}, {0, -1, 0}),
               [top](const glm::dvec3& p) { return p.z < top && p.z > -1e3; });
  };
  const Surface near_stage = cut(kFloor, [](const glm::dvec3& p) { return glm::length(p) < 5; });
  EXPECT_TRUE(is_backdrop(frame({near_stage, kBall, card(140, 1e3)})));
  const auto close = find_backdrop(frame({near_stage, kBall, card(60, 1e3)}));
  ASSERT_TRUE(close);
  EXPECT_FALSE(close->is_far());
  EXPECT_FALSE(is_backdrop(frame({near_stage, kBall, card(140, 10)}))) << "sky above";
  const Surface hill = sphere({30, 260, 0}, 60);
  EXPECT_FALSE(is_backdrop(frame({near_stage, kBall, card(300, 1e3), hill}))) << "hills";
  const Surface post =
      cut(plane({0, -4, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.05; });
  EXPECT_FALSE(is_backdrop(frame({post, card(140, 1e3)}))) << "a post before a facade";
}

/// The ground of a street behind the edge of a roof is a plane far away behind a gap.
TEST(Backdrop, AGroundFarBelowIsNone) {
  const Surface roof =
      cut(plane({0, 0, 100}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < -3; });
  for (const bool world_known : {true, false}) {
    const auto seen = [&](const Surface& far) {
      Geometry shown = frame({roof, far}, look_at(camera_from_fov(55, kWindow, 1), {0, -6, 101.5},
                                                  {0, 0, 98}, {0, 0, 1}));
      shown.world_known = world_known;
      const auto found = find_backdrop(shown);
      return found && found->is_far();
    };
    EXPECT_FALSE(seen(kFloor)) << world_known;
    // A card there is one, also where it leans back.
    EXPECT_TRUE(seen(plane({0, 400, 0}, {0, -1, 0}))) << world_known;
    EXPECT_TRUE(seen(plane({0, 400, 0}, {0, -0.8, 0.6}))) << world_known;
  }
}

/// What stands on the ground that leads up to it is one from 150 heights of the camera on, if it is
/// seen 30 times as high.
TEST(Backdrop, WhatStandsOnTheGroundIsFoundByItsScale) {
  const auto found = [](const std::vector<Surface>& shown, const Camera& by = camera()) {
    return find_backdrop(frame(shown, by));
  };
  const auto wall = [](double away, const glm::dvec3& normal = {0, -1, 0}) {
    return plane({0, away, 0}, normal);
  };
  // The camera is 2.2 high, at y = -6.
  const auto card = found({kFloor, kBall, wall(434)});
  ASSERT_TRUE(card);
  EXPECT_EQ(card->what,
            "a card that stands on the ground, 200 times as far away as the camera is "
            "high");
  const Geometry shown = frame({kFloor, kBall, wall(434)});
  for (std::size_t i = 0; i < shown.surfaces.size(); ++i) {
    const glm::vec3 n =
        glm::vec3(glm::transpose(shown.camera.rotation) * glm::dvec3(shown.surfaces[i].normal));
    ASSERT_EQ(card->coverage[i] > 0, n.y < -0.9f && shown.surfaces[i].position.z < -100) << i;
  }
  const Camera level = camera({0.3, 2, 3.2});
  for (const double times : {75.0, 140.0, 160.0, 400.0}) {
    const auto at = found({kFloor, kBall, wall(2.2 * times - 6)}, level);
    ASSERT_TRUE(at) << times;
    EXPECT_EQ(at->is_far(), times > 150) << at->clearance;
    if (times < 200) {
      EXPECT_NEAR(at->clearance, times / 150, 0.01) << times;
    }
  }
  // Seen from above it is far away, and not high.
  const auto low = found({kFloor, kBall, wall(434)}, camera({0.3, 2, 0.9}));
  ASSERT_TRUE(low);
  EXPECT_FALSE(low->is_far());
  const auto corner =
      found({kFloor, kBall, wall(900, {0.6, -0.8, 0}), wall(900, {-0.6, -0.8, 0})}, level);
  ASSERT_TRUE(corner);
  EXPECT_TRUE(corner->what.starts_with("2 cards that stand on the ground")) << corner->what;
  const Camera wide =
      look_at(camera_from_fov(110, kWindow, 1), {0.3, -6, 2.2}, {0, 2, 2.2}, {0, 0, 1});
  const auto round = found({kFloor, kBall, cylinder(700)}, wide);
  ASSERT_TRUE(round && round->is_far());
  EXPECT_EQ(round->what.substr(0, 10), "a cylinder");
}

/// The ground of a sweep bends into its wall along an arc.
TEST(Backdrop, ASweepRisesFromTheGround) {
  const auto sweep = [](double away, double radius) -> std::vector<Surface> {
    const Surface arc = [=](const Ray& ray) -> std::optional<Hit> {
      const glm::dvec2 o(ray.origin.y - (away - radius), ray.origin.z - radius),
          d(ray.direction.y, ray.direction.z);
      const double a = glm::dot(d, d), b = glm::dot(o, d) / a,
                   under = b * b - (glm::dot(o, o) - radius * radius) / a;
      if (!(under > 0)) return std::nullopt;
      const double t = -b + std::sqrt(under);
      const glm::dvec2 q = o + t * d;
      if (t < 0 || q.x < 0 || q.y > 0) return std::nullopt;
      return Hit{t, {0, -q.x / radius, -q.y / radius}};
    };
    return {cut(kFloor, [=](const glm::dvec3& p) { return p.y < away - radius; }), arc,
            cut(plane({0, away, 0}, {0, -1, 0}), [=](const glm::dvec3& p) { return p.z > radius; }),
            kBall};
  };
  const Camera by = camera({0.3, 2, 1.7});
  for (const auto& [away, is_far] : {std::pair(12.0, false), {900.0, true}}) {
    const Geometry shown = frame(sweep(away, 0.4 * away), by);
    const auto found = find_backdrop(shown);
    ASSERT_TRUE(found) << away;
    EXPECT_TRUE(found->what.starts_with("a sweep that rises from")) << found->what;
    EXPECT_EQ(found->is_far(), is_far) << found->clearance;
    // What stands upright of it; the ball does not.
    const Geometry ball = frame({kBall}, by);
    for (std::size_t i = 0; i < shown.surfaces.size(); ++i) {
      const double up =
          (glm::transpose(shown.camera.rotation) * glm::dvec3(shown.surfaces[i].normal)).z;
      const bool is_ball =
          ball.is_surface(i) && ball.surfaces[i].position == shown.surfaces[i].position;
      if (std::abs(up - 0.7) < 0.05) continue;
      ASSERT_EQ(found->coverage[i] > 0, !is_ball && up < 0.7) << i << " " << up;
    }
  }
}

/// Walls of places with a roof, with sky above or beside them, behind the edge of a table.
TEST(Backdrop, WallsOfPlacesAreNone) {
  const Camera by = look_at(camera_from_fov(60, kWindow, 1), {0, -6, 0.06}, {0, 2, 0.6}, {0, 0, 1});
  const auto found = [&](const std::vector<Surface>& shown) {
    const auto backdrop = find_backdrop(frame(shown, by));
    return backdrop && backdrop->is_far();
  };
  const Surface wall = plane({0, 6, 0}, {0, -1, 0});
  // The low camera sees the wall from 200 times its own height, and 60 times as high.
  EXPECT_TRUE(found({kFloor, wall}));
  EXPECT_FALSE(found({kFloor, wall, plane({0, 0, 2.4}, {0, 0, -1})})) << "a roof";
  EXPECT_FALSE(found({kFloor, cut(wall, [](const glm::dvec3& p) { return p.z < 2; })})) << "sky";
  EXPECT_FALSE(found({kFloor, cut(wall, [](const glm::dvec3& p) { return p.x < 2; })})) << "beside";
  const Surface table = cut(kFloor, [](const glm::dvec3& p) { return p.y < -4; });
  EXPECT_FALSE(found({table, wall})) << "it stands lower";
  EXPECT_FALSE(found({kFloor, wall, plane({-5, 0, 0}, {1, 0, 0})})) << "a side wall nearby";
}

/// Each limit of a dome: what lies on it, how much larger it is, and from where it is seen.
TEST(Backdrop, ADomeHasLimits) {
  const auto clearance = [](const std::vector<Surface>& shown) {
    const auto found = find_backdrop(frame(shown));
    return found ? found->clearance : 0;
  };
  const double at_150 = clearance({kStage, kBall, dome({0, 0, 0}, 150)});
  EXPECT_NEAR(clearance({kStage, kBall, dome({0, 0, 0}, 300)}), 2 * at_150, 0.02 * at_150);
  // Nine tenths of the stage are nearer than 25 here.
  EXPECT_GT(at_150, 150 / (3 * 31.0));
  EXPECT_LT(at_150, 150 / (3 * 5.0));
  // Half of the far surfaces lie off it: a wall that cuts through the dome.
  const Surface wall =
      cut(plane({0, 250, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.x > 0; });
  EXPECT_FALSE(is_backdrop(frame({kStage, kBall, dome({0, 0, 0}, 500), wall})));
  // Normals that point out of it.
  Geometry outward = frame({kStage, kBall, dome({0, 0, 0}, 500)});
  const Geometry open = frame({kStage, kBall});
  for (std::size_t i = 0; i < outward.surfaces.size(); ++i)
    if (!open.is_surface(i)) outward.surfaces.set_normal(i, -outward.surfaces[i].normal);
  EXPECT_FALSE(is_backdrop(outward));
  // A dome of few pixels.
  Geometry sliver = frame({kStage, kBall});
  const Geometry whole = frame({kStage, kBall, dome({0, 0, 0}, 500)});
  for (int x = 0; x < 20; ++x) sliver.surfaces.set(x, 0, whole.surfaces(x, 0));
  EXPECT_FALSE(is_backdrop(sliver));
}

/// Nine tenths of what is not on a dome are to be nearer than a third of its radius.
TEST(Backdrop, ADomeIsThreeTimesAsLargeAsItsScene) {
  const auto at = [](double radius) {
    return find_backdrop(frame({kStage, kBall, dome({0, 0, 0}, radius)}));
  };
  const auto found = at(150);
  ASSERT_TRUE(found);
  std::vector<double> others;
  const Geometry stage = frame({kStage, kBall});
  for (const Surfel& s : stage.surfaces)
    if (s.is_surface()) others.push_back(glm::length(glm::dvec3(s.position)));
  std::ranges::sort(others);
  const double most = others[others.size() * 9 / 10];
  EXPECT_NEAR(found->clearance, 150 / (3 * most), 0.05 * found->clearance);
  // On both sides of the limit.
  const auto above = at(3.3 * most), below = at(2.7 * most);
  ASSERT_TRUE(above && below);
  EXPECT_TRUE(above->is_far());
  EXPECT_FALSE(below->is_far());
}

/// A ball is a sphere too, seen from outside; so is a bowl whose middle the camera is not in,
/// though it is seen from its inside.
TEST(Backdrop, TheCameraIsInADome) {
  const Camera at = camera({0.3, 10, 2.2});
  const Surface bowl =
      cut(dome({0, 3000, 2.2}, 1000), [](const glm::dvec3& p) { return p.y > 3000; });
  EXPECT_FALSE(is_backdrop(frame({kStage, kBall, bowl}, at)));
  // The same dome, around the camera.
  const Surface half = cut(dome({0, 0, 2.2}, 4000), [](const glm::dvec3& p) { return p.y > 3000; });
  EXPECT_TRUE(is_backdrop(frame({kStage, kBall, half}, at)));
}

/// A plane with too few samples is none, and takes none from what is left to other shapes.
TEST(Backdrop, PlanesWithFewSamplesTakeNothing) {
  for (const std::size_t on_plane : {23, 24}) {
    SurfelSamples left;
    for (std::size_t i = 0; i <= on_plane; ++i)
      left.push_back({{0.1f * float(i), 0, i < on_plane ? -10 : -20}, {0, 0, 1}, 0});
    const std::size_t flats = take_flats(left, 0.8, [](const Flat&) { return true; }).size();
    EXPECT_EQ(flats, std::size_t(on_plane == 24));
    EXPECT_EQ(left.size(), flats == 0 ? on_plane + 1 : 1);
  }
}

TEST(Backdrop, OtherFarThingsAreNone) {
  const Surface wall = plane({0, 60, 0}, {0, -1, 0}), side = plane({-40, 0, 0}, {1, 0, 0}),
                other = plane({40, 0, 0}, {-1, 0, 0}), ceiling = plane({0, 0, 30}, {0, 0, -1});
  const std::vector<std::vector<Surface>> scenes = {
      {kFloor, kBall},
      {kStage, kBall},
      {kBall},
      {kFloor, kBall, wall},
      {kFloor, wall, side, other, ceiling},
      {kFloor, side},
      // Domes that the camera is not in, and one that is no larger than its scene.
      {kFloor, sphere({0, 300, 0}, 250)},
      {sphere({0, 500, 0}, 100)},
      {kStage, kBall, dome({0, 0, 0}, 31)},
      // The ground of a valley.
      {kBall, cut(dome({0, 0, 300}, 300), [](const glm::dvec3& p) { return p.z < 15; })},
  };
  for (std::size_t i = 0; i < scenes.size(); ++i) EXPECT_FALSE(is_backdrop(frame(scenes[i]))) << i;
  EXPECT_FALSE(is_backdrop(geometry_of(
      kFloor, look_at(camera_from_ortho_width(4, kWindow, 1), {0, -4, 2}, {0, 0, 0}, {0, 0, 1}),
      kWindow)));
}

}  // namespace
}  // namespace ssdo::test::backdrop_test
