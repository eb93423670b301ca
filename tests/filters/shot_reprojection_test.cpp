// SPDX-License-Identifier: Apache-2.0
//
// The vector form of Reprojection against the scalar one.
#include "filters/shot/shot_reprojection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "filters/reprojection.h"
#include "support/analytic_scene.h"

namespace ssdo::test::shot_reprojection_test {
namespace {

Surface things(double x) {
  return all_of({plane({}, {0, 0, 1}), sphere({x, 0, 0.5}, 0.4), sphere({-1.2, 0.7, 0.3}, 0.3)});
}

/// Of all points: how many the other frame shows and looks through, and on how many both differ.
struct Counts {
  int same = 0, through = 0, other_same = 0, other_through = 0, all = 0;
  double worst = 0;  ///< difference of the weights of a pixel
};

Counts compare(const Geometry& now, const Geometry& other) {
  const KeptSurfaces own = keep_surfaces(now), kept = keep_surfaces(other);
  const Reprojection reference(other, now);
  const ShotReprojection reprojection(kept, own);
  Counts counts;
  for_each_points_of_grid(own, 1, [&](const RowOfPixels& row) {
    RowOfPoints points;
    ReprojectedPoints sights;
    unsigned char through[RowOfPoints::kMost];
    load_points(own, row, points);
    const bool some = reprojection.find(points, sights);
    reprojection.find_through(points, through);
    for (int i = 0; i < row.count; ++i) {
      const Surfel& s = now.surfaces(row.x + i, row.y);
      if (!s.is_surface()) {
        EXPECT_TRUE(!some || sights.pixel[i] < 0);
        EXPECT_EQ(through[i], 0);
        continue;
      }
      const PixelsBefore at = reference.find(s, glm::dvec2(NAN));
      const bool same = some && sights.pixel[i] >= 0;
      counts.all += 1;
      counts.same += at.count > 0, counts.through += at.sight == SeenBefore::through;
      counts.other_same += same != (at.count > 0);
      counts.other_through += (through[i] != 0) != (at.sight == SeenBefore::through);
      if (!same || at.count == 0) continue;
      for (int k = 0; k < 4; ++k) {
        double weight = 0;
        for (int j = 0; j < at.count; ++j) {
          const int x = int(at.pixel[j]) % other.surfaces.width,
                    y = int(at.pixel[j]) / other.surfaces.width;
          if (int(kept.index(x, y)) == sights.pixel[i] + k % 2 + k / 2 * kept.stride())
            weight = double(at.weight[j]);
        }
        counts.worst = std::max(counts.worst, std::abs(weight - double(sights.weight[k][i])));
      }
    }
  });
  return counts;
}

/// Normals that look away from the camera too, and roundings over a factor of 1000.
TEST(KeptSurfaces, KeepNormalsAndRoundings) {
  const Window window{0, 0, 70, 30};
  const Camera camera = look_at(camera_from_fov(45, window, 1), {0, 0, 4}, {}, {0, 1, 0});
  Geometry geometry = geometry_of(plane({}, {0, 0, 1}), camera, window);
  const int count = int(geometry.surfaces.size());
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, turn = 2.4 * i, across = std::sqrt(1 - z * z);
    geometry.surfaces.set_normal(std::size_t(i),
                                 {across * std::cos(turn), across * std::sin(turn), z});
    geometry.surfaces.rounding[std::size_t(i)] = float(1e-4 * std::pow(1000, double(i) / count));
  }
  const KeptSurfaces kept = keep_surfaces(geometry);
  for_each_points_of_grid(kept, 1, [&](const RowOfPixels& row) {
    RowOfPoints points;
    load_points(kept, row, points);
    for (int i = 0; i < row.count; ++i) {
      const Surfel& s = geometry.surfaces(row.x + i, row.y);
      const glm::vec3 normal(points.normal[0][i], points.normal[1][i], points.normal[2][i]);
      EXPECT_LT(glm::distance(normal, s.normal), 1e-3f);
      EXPECT_GE(points.rounding[i], s.rounding);
      EXPECT_LE(points.rounding[i], 1.1251f * s.rounding);
      EXPECT_EQ(points.position[2][i], s.position.z);
    }
  });
}

TEST(ReprojectedPoints, AreThoseOfTheScalarForm) {
  const Window window{5, -3, 102, 70};  // rows do not end with a vector
  for (const bool orthographic : {false, true}) {
    const auto camera = [&](double x) {
      return look_at(
          orthographic ? camera_from_ortho_width(4, window, 1) : camera_from_fov(45, window, 1),
          {x, -4, 3}, {0.2 * x, 0, 0}, {0.1 * x, 0, 1});
    };
    const Geometry now = geometry_of(things(0.3), camera(0), window);
    for (const double x : {-1.0, 0.07, 0.4}) {
      const Counts counts = compare(now, geometry_of(things(-0.3), camera(x), window));
      EXPECT_GT(counts.same, counts.all / 2);
      EXPECT_GT(counts.through, 20);
      // Where rounding decides a test, or a pixel has next to no part.
      EXPECT_LE(counts.other_same, counts.all / 500) << x << orthographic;
      EXPECT_LE(counts.other_through, counts.all / 1000) << x << orthographic;
      EXPECT_LT(counts.worst, 2e-3) << x << orthographic;
    }
  }
}

/// Two sheets that cross at a point are not the same surface there.
TEST(ReprojectedPoints, AnotherNormalIsAnotherSurface) {
  const Window window{0, 0, 64, 40};
  const Camera camera = look_at(camera_from_fov(45, window, 1), {0, -4, 3}, {}, {0, 0, 1});
  const Geometry now = geometry_of(plane({}, {0, 0, 1}), camera, window);
  for (const double degrees : {20.0, 35.0}) {  // of 26
    Geometry turned = now;
    const double angle = degrees * 3.14159265358979 / 180;
    turned.surfaces.change_each([&](Surfel& s) {
      const glm::vec3 across = glm::normalize(glm::cross(s.normal, glm::vec3(1, 0, 0)));
      s.normal = float(std::cos(angle)) * s.normal + float(std::sin(angle)) * across;
    });
    const Counts counts = compare(now, turned);
    EXPECT_EQ(counts.other_same, 0);
    EXPECT_EQ(counts.same, degrees < 26 ? counts.all : 0);
  }
}

/// What lies beside a pixel has no part in it, or the edge of what moved would be missed.
TEST(ReprojectedPoints, UnderACameraAtRestAPixelIsItself) {
  const Window window{0, 0, 130, 72};
  const Camera camera = look_at(camera_from_fov(45, window, 1), {3, -4, 2.7}, {}, {0, 0, 1});
  const KeptSurfaces own = keep_surfaces(geometry_of(things(0.3), camera, window));
  const ShotReprojection reprojection(own, own);
  for_each_points_of_grid(own, 1, [&](const RowOfPixels& row) {
    RowOfPoints points;
    ReprojectedPoints sights;
    load_points(own, row, points);
    if (!reprojection.find(points, sights)) return;
    for (int i = 0; i < row.count; ++i) {
      if (std::isnan(points.position[2][i])) continue;
      EXPECT_EQ(sights.pixel[i], int(own.index(row.x + i, row.y)));
      EXPECT_EQ(sights.weight[0][i], 1);
    }
  });
}

TEST(ReprojectedPoints, ACameraThatLooksAwaySeesNothing) {
  const Window window{0, 0, 70, 50};
  const Camera camera = look_at(camera_from_fov(45, window, 1), {0, -4, 3}, {}, {0, 0, 1});
  const Geometry now = geometry_of(things(0), camera, window);
  Geometry behind = now;
  behind.camera.rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1) * camera.rotation;
  const Counts counts = compare(now, behind);
  EXPECT_EQ(counts.same + counts.through + counts.other_same + counts.other_through, 0);
}

}  // namespace
}  // namespace ssdo::test::shot_reprojection_test
