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

/// The point that a pixel shows, and the direction of its view ray, in the world.
struct Seen {
  glm::dvec3 point, along;
};
Seen seen_at(const Geometry& g, std::size_t i) {
  const glm::dmat3 to_world(glm::transpose(g.camera.rotation));
  const glm::dvec3 p(g.surfaces[i].position);
  return {to_world * p + g.camera.origin,
          to_world * (g.camera.orthographic ? glm::dvec3(0, 0, -1) : glm::normalize(p))};
}

/// How far the view ray of a pixel runs through a box that it enters at `from`.
double depth_of(const Box& box, const Seen& from) {
  double leaves = INFINITY;
  for (int c = 0; c < 3; ++c) {
    if (from.along[c] == 0) continue;
    const double side = from.along[c] > 0 ? box.high[c] : box.low[c];
    leaves = std::min(leaves, (side - from.point[c]) / from.along[c]);
  }
  return leaves;
}

/// Depths that were guessed, and those of the thing.
struct Depths {
  double found = 0, truth = 0;  ///< means
  double off = 0, spread = 0;   ///< root mean squares: found less truth; truth less its mean
};
template <class Truth>
Depths compare_depths(const Geometry& g, const Truth& truth) {
  const Solids solids = guess_solids(g);
  Depths all;
  std::vector<double> of_pixels;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (!g.is_surface(i)) continue;
    const double depth = truth(seen_at(g, i));
    if (depth <= 0) continue;
    of_pixels.push_back(depth);
    const double found = double(solids.thickness[i]);
    all.found += found, all.truth += depth, all.off += (found - depth) * (found - depth);
  }
  const auto count = double(of_pixels.size());
  all.found /= count, all.truth /= count, all.off = std::sqrt(all.off / count);
  for (const double depth : of_pixels) all.spread += (depth - all.truth) * (depth - all.truth);
  all.spread = std::sqrt(all.spread / count);
  return all;
}

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

/// A view ray leaves a box at once at a silhouette: one depth for all pixels would be off by their
/// spread.
TEST(ShownDepth, OfABoxThatShowsASideIsThatOfItsSection) {
  for (const double half_z : {0.05, 0.1, 0.15}) {
    for (const double azimuth : {45.0, 60.0}) {
      const Box box = post(0.4, half_z);
      const Camera camera = view(azimuth, 0, true);
      const Geometry g = geometry_of(all_of({wall(-3), box.surface()}), camera, kWindow);
      const Depths d = compare_depths(g, [&](const Seen& from) {
        return from.point.z > -1 && std::abs(from.point.y) < 0.2 ? depth_of(box, from) : 0.0;
      });
      fmt::print("{} deep, at {} degrees: {:.3f} for {:.3f}, off by {:.3f}, spread {:.3f}\n",
                 2 * half_z, azimuth, d.found, d.truth, d.off, d.spread);
      // At a right angle to the diagonal there may be half a pixel more.
      const double seen = std::sin(azimuth * std::numbers::pi / 180 - std::atan2(half_z, 0.4)),
                   unseen = pixel_of(camera) / (2 * seen * std::sqrt(1 - seen * seen));
      EXPECT_NEAR(d.found, d.truth, 0.08 * d.truth + unseen);
      EXPECT_LT(d.off, std::max(0.35 * d.spread, 1.1 * unseen));
    }
  }
}

TEST(ShownDepth, OfABallIsThatOfTheBall) {
  for (const bool orthographic : {false, true}) {
    const double radius = 0.4;
    const Geometry g =
        geometry_of(all_of({wall(-3), sphere({}, radius)}), view(35, 20, orthographic), kWindow);
    const Depths d = compare_depths(g, [&](const Seen& from) {
      return from.point.z > -1 ? -2 * glm::dot(from.point, from.along) : 0.0;
    });
    fmt::print("{:.3f} for {:.3f}, off by {:.3f}, spread {:.3f}\n", d.found, d.truth, d.off,
               d.spread);
    EXPECT_NEAR(d.found, d.truth, 0.1 * d.truth);
    EXPECT_LT(d.off, 0.35 * d.spread);
  }
}

TEST(ShownDepth, IsNotKnownOfWhatIsSeenFaceOnOrRound) {
  const auto in_the_middle = [](const Surface& thing, const Camera& camera) {
    const Geometry g = geometry_of(all_of({wall(-3), thing}), camera, kWindow);
    return guess_solids(g).thickness[g.surfaces.index(80, 60)];
  };
  EXPECT_NEAR(in_the_middle(post(0.4, 0.3).surface(), view(0, 0)), kDepthOfWidth * 0.8, 0.03);
  EXPECT_NEAR(in_the_middle(sphere({}, 0.4), view(35, 20)), 0.8, 0.04);
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
    const Seen from = seen_at(g, i);
    const glm::dvec3& p = from.point;
    if (!g.is_surface(i) || std::abs(p.y) > 1e-4 || std::abs(p.x) > 0.25 || std::abs(p.z) > 0.25)
      continue;
    ++top, thin += double(solids.thickness[i]) < 0.5 * depth_of(cube, from);
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
