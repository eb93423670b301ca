// SPDX-License-Identifier: Apache-2.0
//
// Normals of frames that have depth and no N, and of surfaces under a normal map.
#include "scene/normals/normals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "scene/build_geometry.h"
#include "scene/normals/geometric_normal.h"
#include "support/analytic_scene.h"

namespace ssdo::test::normals_test {
namespace {

const Window kWindow{0, 0, 64, 48};

/// The geometry that a frame of depth alone leads to, rounded to float as a file has it.
Geometry from_depth(const Surface& scene, const Camera& camera, const CameraOptions& options,
                    DepthKind kind = DepthKind::planar, const Window& window = kWindow) {
  const Picture picture = take_picture(scene, camera, window);
  GBuffer g;
  g.window = g.display = window;
  g.depth_kind = kind;
  g.valid = picture.valid;
  g.depth = Plane<float>(window.width(), window.height(), 1e10f);
  for (std::size_t i = 0; i < g.depth.size(); ++i) {
    if (!picture.valid[i]) continue;
    const glm::dvec3 p = camera.to_camera(glm::dvec3(picture.position[i]));
    g.depth[i] = float(kind == DepthKind::ray ? glm::length(p) : -p.z);
  }
  GeometryReport report;
  Geometry geometry = build_geometry(g, options, "test", report);
  EXPECT_EQ(report.normal_space, "rebuilt from P");
  return geometry;
}

glm::dvec3 normal_at(const Geometry& g, std::size_t i) { return glm::dvec3(g.surfaces[i].normal); }

TEST(NormalsFromDepth, OfAPlaneAreItsNormalUpToTheBorder) {
  for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
    const double t = glm::radians(tilt);
    const glm::dvec3 eye(0, -9 * std::sin(t), 9 * std::cos(t)), up(0.2, std::cos(t), std::sin(t));
    const Surface floor = plane({}, {0, 0, 1});
    for (const DepthKind kind : {DepthKind::planar, DepthKind::ray}) {
      const Camera camera = look_at(camera_from_fov(20, kWindow, 1), eye, {}, up);
      const Geometry g = from_depth(floor, camera, {"", 20, {}}, kind);
      for (std::size_t i = 0; i < g.surfaces.size(); ++i)
        EXPECT_LT(glm::length(normal_at(g, i) - camera.rotation * glm::dvec3(0, 0, 1)), 1e-3);
    }
    const Camera camera = look_at(camera_from_ortho_width(2, kWindow, 1), eye, {}, up);
    const Geometry g = from_depth(floor, camera, {"", {}, 2});
    for (std::size_t i = 0; i < g.surfaces.size(); ++i)
      EXPECT_LT(glm::length(normal_at(g, i) - camera.rotation * glm::dvec3(0, 0, 1)), 1e-3);
  }
}

TEST(NormalsFromDepth, AreUnitVectorsAtAnyDistance) {
  constexpr std::array kDepths = {1e-44f, 1e-30f, 1e-20f, 1.0f, 1e17f, 1e25f, 3e38f};
  for (const float near : kDepths) {
    for (const float far : kDepths) {
      GBuffer g;
      g.window = g.display = {0, 0, 5, 4};
      g.valid = Plane<unsigned char>(5, 4, 1);
      g.depth = Plane<float>(5, 4, near);
      g.depth(2, 1) = g.depth(3, 3) = g.depth(0, 2) = far;
      GeometryReport report;
      const Geometry geometry = build_geometry(g, {"", 40, {}}, "test", report);
      std::vector<glm::vec3> smooth(5);
      for (int y = 0; y < 4; ++y) {
        find_geometric_normals(geometry.surfaces, y, false, smooth);
        for (int x = 0; x < 5; ++x) {
          EXPECT_NEAR(glm::length(geometry.surfaces(x, y).normal), 1, 1e-5) << near << " " << far;
          EXPECT_NEAR(glm::length(smooth[std::size_t(x)]), 1, 1e-5) << near << " " << far;
        }
      }
    }
  }
}

TEST(NormalsFromDepth, StayOnTheirOwnSideOfASilhouette) {
  // A card before a tilted wall: whichever side of an edge a pixel lies on, one of the two
  // differences stays on its surface, and it is the smaller one.
  const glm::dvec3 wall = glm::normalize(glm::dvec3(0.5, 0.2, 1)), front(0, 0, 1);
  const Surface scene =
      all_of({plane({0, 0, -2}, wall), cut(plane({}, front), [](const glm::dvec3& p) {
                return std::abs(p.x) < 0.51 && std::abs(p.y) < 0.52;
              })});
  const Camera camera = look_at(camera_from_fov(40, kWindow, 1), {0, 0, 5}, {}, {0, 1, 0});
  const Geometry g = from_depth(scene, camera, {"", 40, {}});
  const Picture picture = take_picture(scene, camera, kWindow);
  std::size_t at_edges = 0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const std::size_t i = g.surfaces.index(x, y);
      const glm::dvec3 expected = camera.rotation * glm::dvec3(picture.normal[i]);
      EXPECT_LT(glm::length(normal_at(g, i) - expected), 1e-3) << x << " " << y;
      at_edges += x > 0 && picture.normal[i] != picture.normal[i - 1];
    }
  }
  EXPECT_GT(at_edges, 20u);
}

TEST(NormalsFromDepth, DoNotLeanOnTheBackground) {
  const Camera camera = look_at(camera_from_fov(40, kWindow, 1), {0, 0, 5}, {}, {0, 1, 0});
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.4, -0.3, 1));
  const Geometry g =
      from_depth(cut(plane({}, n), [](const glm::dvec3& p) { return glm::length(p) < 1; }), camera,
                 {"", 40, {}});
  std::size_t surfaces = 0, without_a_plane = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (!g.is_surface(i)) continue;
    ++surfaces;
    without_a_plane += glm::length(normal_at(g, i) - camera.rotation * n) > 1e-3;
  }
  EXPECT_GT(surfaces, 300u);
  EXPECT_EQ(without_a_plane, 0u);
}

TEST(NormalsFromDepth, FaceTheViewerWhereThereIsNoPlaneToSee) {
  for (const Window& window : {Window{0, 0, 1, 1}, Window{0, 0, 5, 1}, Window{0, 0, 1, 5}}) {
    const Camera camera = look_at(camera_from_fov(4, window, 1), {0, -3, 3}, {}, {0, 0, 1});
    const Geometry g =
        from_depth(plane({}, {0, 0, 1}), camera, {"", 4, {}}, DepthKind::planar, window);
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      const glm::dvec3 view = -glm::normalize(glm::dvec3(g.surfaces[i].position));
      EXPECT_LT(glm::length(normal_at(g, i) - view), 1e-6);
    }
  }
}

/// What geometric_normal() says of a pixel, and the normal that the pixel has.
struct NormalPair {
  glm::vec3 geometric, shading;
};
NormalPair normals_at(const Geometry& g, int x, int y) {
  const Surfel& s = g.surfaces(x, y);
  return {geometric_normal(g.surfaces, x, y, -glm::normalize(s.position)), s.normal};
}

TEST(GeometricNormals, AreThoseOfTheSurfaceUnderANormalMap) {
  const Camera camera = look_at(camera_from_fov(40, kWindow, 1), {0, -3, 2}, {}, {0, 0, 1});
  const glm::vec3 up(camera.rotation * glm::dvec3(0, 0, 1));
  for (const double lean : {1.0, 10.0, 40.0}) {
    Geometry g = geometry_of(plane({}, {0, 0, 1}), camera, kWindow);
    const double a = glm::radians(lean);
    const glm::vec3 shading(camera.rotation * glm::dvec3(std::sin(a), 0, std::cos(a)));
    g.surfaces.change_each([&](Surfel& s) { s.normal = shading; });
    const NormalPair inside = normals_at(g, 30, 20);
    // Within two degrees both are one.
    EXPECT_LT(glm::distance(inside.geometric, lean < 2 ? shading : up), 1e-4) << lean;
    const NormalPair border = normals_at(g, 0, 47);
    EXPECT_LT(glm::distance(border.geometric, lean < 2 ? shading : up), 1e-4) << "at the border";
  }
}

TEST(GeometricNormals, OfARowAreThoseOfItsPixels) {
  const Surface ball = all_of(
      {cut(plane({}, {0, 0, 1}), [](auto& p) { return p.y < 0.4; }), sphere({0, 0, 0.5}, 0.5)});
  for (const bool orthographic : {false, true}) {
    const Camera projection =
        orthographic ? camera_from_ortho_width(3, kWindow, 1) : camera_from_fov(40, kWindow, 1);
    Geometry g = geometry_of(ball, look_at(projection, {0, -3, 2}, {}, {0, 0, 1}), kWindow);
    for (std::size_t i = 0; i < g.surfaces.size(); i += 3)
      g.surfaces.set_normal(i, glm::normalize(g.surfaces[i].normal + glm::vec3(0.2f, 0, 0)));
    std::vector<glm::vec3> row(std::size_t(kWindow.width()));
    int surfaces = 0;
    for (int y = 0; y < kWindow.height(); ++y) {
      find_geometric_normals(g.surfaces, y, orthographic, row);
      for (int x = 0; x < kWindow.width(); ++x) {
        const Surfel& s = g.surfaces(x, y);
        if (!s.is_usable()) continue;
        ++surfaces;
        const glm::vec3 alone =
            geometric_normal(g.surfaces, x, y, direction_to_viewer(s.position, orthographic));
        EXPECT_LT(glm::distance(row[std::size_t(x)], alone), 1e-5f) << x << " " << y;
      }
    }
    EXPECT_GT(surfaces, 1000);
  }
}

TEST(GeometricNormals, AreThoseOfThePixelWherePositionsTellNone) {
  const Camera camera = look_at(camera_from_fov(40, kWindow, 1), {0, -3, 2}, {}, {0, 0, 1});
  // Across an edge between two faces, and across a silhouette.
  const Surface faces =
      all_of({cut(plane({}, {0, 0, 1}), [](auto& p) { return p.x < 0.01; }),
              cut(plane({0.01, 0, 0}, {-1, 0, 0.3}), [](auto& p) { return p.x >= 0.01; })});
  const Surface ball = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)});
  for (const Surface& scene : {faces, ball}) {
    const Geometry g = geometry_of(scene, camera, kWindow);
    for (int y = 0; y < kWindow.height(); ++y) {
      for (int x = 0; x < kWindow.width(); ++x) {
        if (!g.surfaces(x, y).is_usable()) continue;
        const NormalPair n = normals_at(g, x, y);
        EXPECT_GT(glm::dot(n.geometric, n.shading), 0.96f) << x << " " << y;
      }
    }
  }
  // Positions in half floats leave no slope.
  Geometry g = geometry_of(plane({}, {0, 0, 1}), camera, kWindow);
  g.surfaces.change_each([](Surfel& s) {
    s.normal = glm::normalize(s.normal + glm::vec3(0.5f, 0, 0)), s.rounding = 0.02f;
  });
  EXPECT_EQ(normals_at(g, 30, 20).geometric, g.surfaces(30, 20).normal);
}

}  // namespace
}  // namespace ssdo::test::normals_test
