// SPDX-License-Identifier: Apache-2.0
//
// How deep things are by the sides that a frame shows and does not show, through guess_solids().
#include "scene/solids/shown_depth.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "scene/solids/solids.h"
#include "scene/solids/width_of_run.h"
#include "support/analytic_scene.h"
#include "support/boxes.h"

namespace ssdo::test::shown_depth_test {
namespace {

const Window kWindow{0, 0, 160, 120};

/// Looks at the origin from 6 away, `azimuth` degrees to the right of the z axis.
Camera view(double azimuth, double elevation, bool orthographic = false) {
  const double a = azimuth * std::numbers::pi / 180, e = elevation * std::numbers::pi / 180;
  return look_at(
      orthographic ? camera_from_ortho_width(3, kWindow, 1) : camera_from_fov(28, kWindow, 1),
      6.0 * glm::dvec3(std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)), {},
      {0, 1, 0});
}

double pixel_of(const Camera& camera) {
  return camera.orthographic ? 1 / camera.fx : 6 / camera.fx;
}

Surface wall(double z) { return plane({0, 0, z}, {0, 0, 1}); }

/// The median thickness of the pixels of a thing with |y| < `reach`, which lies in z > -1.
float thickness_of(const Geometry& g, double reach) {
  const Solids solids = guess_solids(g);
  std::vector<float> found;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const glm::dvec3 p =
        glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces[i].position) + g.camera.origin;
    if (g.is_surface(i) && p.z > -1 && std::abs(p.y) < reach) found.push_back(solids.thickness[i]);
  }
  if (found.empty()) return 0;
  std::nth_element(found.begin(), found.begin() + std::ptrdiff_t(found.size() / 2), found.end());
  return found[found.size() / 2];
}

float thickness_of(const Surface& thing, const Camera& camera) {
  return thickness_of(geometry_of(all_of({wall(-3), thing}), camera, kWindow), 0.2);
}

Box post(double half_x, double half_z) { return {{-half_x, -0.9, -half_z}, {half_x, 0.9, half_z}}; }

TEST(ShownDepth, OfABoardWhoseSideIsNotSeenIsSmall) {
  for (const bool orthographic : {false, true}) {
    for (const double azimuth : {25.0, 40.0, -55.0}) {
      const Camera camera = view(azimuth, 0, orthographic);
      const float found = thickness_of(post(0.4, 0.002).surface(), camera);
      const double seen = std::abs(std::sin(azimuth * std::numbers::pi / 180));
      fmt::print("at {} degrees: {:.3f} thick\n", azimuth, found);
      // Half a pixel of its side, and a surface is closed from a pixel to the next.
      const double side = pixel_of(camera) / (2 * seen * std::sqrt(1 - seen * seen)),
                   step = pixel_of(camera) * seen / std::sqrt(1 - seen * seen);
      EXPECT_LT(found, 1.3 * std::max(side, step));
      EXPECT_GT(found, 0.7 * std::max(side, step));
    }
  }
}

TEST(ShownDepth, OfABoxThatShowsASideIsThatOfItsSection) {
  for (const double half_z : {0.05, 0.1, 0.15}) {
    for (const double azimuth : {45.0, 60.0}) {
      const double a = azimuth * std::numbers::pi / 180, x = 0.4, z = half_z,
                   width = 2 * (x * std::cos(a) + z * std::sin(a)), mean = 4 * x * z / width;
      const Camera camera = view(azimuth, 0, true);
      const float found = thickness_of(post(x, z).surface(), camera);
      // At a right angle to the diagonal there may be more.
      const double seen = std::sin(a - std::atan2(z, x)),
                   unseen = pixel_of(camera) / (2 * seen * std::sqrt(1 - seen * seen));
      fmt::print("{} deep, at {} degrees: {:.3f}, {:.3f} in the mean\n", 2 * z, azimuth, found,
                 mean);
      EXPECT_GT(found, mean);
      EXPECT_NEAR(found, kDepthOfWidth * 4 / std::numbers::pi * mean + unseen, 0.08 * mean);
    }
  }
}

TEST(ShownDepth, IsNotKnownOfWhatIsSeenFaceOnOrRound) {
  const auto in_the_middle = [](const Surface& thing, const Camera& camera) {
    const Geometry g = geometry_of(all_of({wall(-3), thing}), camera, kWindow);
    return guess_solids(g).thickness[g.surfaces.index(80, 60)];
  };
  EXPECT_NEAR(in_the_middle(post(0.4, 0.3).surface(), view(0, 0)), kDepthOfWidth * 0.8, 0.03);
  EXPECT_NEAR(in_the_middle(sphere({}, 0.4), view(35, 20)), kDepthOfWidth * 0.8, 0.04);
}

/// From above, lines across the upper corners of a cube enter it by one side and leave it by the
/// next; both of those are turned away.
TEST(ShownDepth, IsNotToldByLinesAcrossACorner) {
  const Box cube{{-0.4, -0.8, -0.4}, {0.4, 0, 0.4}};
  const Geometry g =
      geometry_of(all_of({plane({0, -0.8, 0}, {0, 1, 0}), cube.surface()}), view(20, 40), kWindow);
  const Solids solids = guess_solids(g);
  int top = 0, thin = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const glm::dvec3 p =
        glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces[i].position) + g.camera.origin;
    if (!g.is_surface(i) || std::abs(p.y) > 1e-4 || std::abs(p.x) > 0.25 || std::abs(p.z) > 0.25)
      continue;
    ++top, thin += solids.thickness[i] < 0.3;
  }
  EXPECT_GT(top, 200);
  fmt::print("{} of {} pixels are thin\n", thin, top);
  EXPECT_EQ(thin, 0);
}

TEST(ShownDepth, IsNotToldWhereASideWouldBeHidden) {
  // A wall close behind the near edge of a turned board hides a side of it that is long.
  const Camera camera = view(4, 0, true);
  const auto with_wall_at = [&](double z) {
    return thickness_of(geometry_of(all_of({wall(z), post(0.4, 0.002).surface()}), camera, kWindow),
                        0.2);
  };
  EXPECT_LT(with_wall_at(-2), 0.2);
  // 5 pixels behind.
  const Geometry g = geometry_of(all_of({wall(-5 * pixel_of(camera)), post(0.4, 0.002).surface()}),
                                 camera, kWindow);
  const Solids solids = guess_solids(g);
  EXPECT_GT(solids.thickness[g.surfaces.index(80, 60)], 0.4);
}

/// A slope of which only one or two pixels are seen: rays that go through between them do not miss
/// it.
TEST(ShownDepth, ClosesASurfaceBetweenPixels) {
  const double t = 60 * std::numbers::pi / 180;
  const Camera camera = view(0, 0, true);
  const double pixel = pixel_of(camera);
  const Surface leaf =
      cut(plane({0, 0, 0}, {0, std::sin(t), std::cos(t)}), [&](const glm::dvec3& p) {
        return std::abs(p.y - 0.5 * pixel) < 0.6 * pixel && std::abs(p.x) < 6 * pixel;
      });
  const Geometry g = geometry_of(all_of({wall(-3), leaf}), camera, kWindow);
  const Solids solids = guess_solids(g);
  int pixels = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (std::isinf(solids.thickness[i])) continue;
    ++pixels;
    EXPECT_GE(solids.thickness[i], 0.999 * std::tan(t) * pixel);
  }
  EXPECT_GE(pixels, 11);
}

}  // namespace
}  // namespace ssdo::test::shown_depth_test
