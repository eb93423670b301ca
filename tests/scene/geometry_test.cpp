// SPDX-License-Identifier: Apache-2.0
//
// From the layers of a file to surfaces in camera space.
#include "scene/geometry.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "scene/build_geometry.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"
#include "support/temp_dir.h"

namespace ssdo::test::geometry_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Window kWindow{0, 0, 96, 72};

Surface ball_on_ground() { return all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.7}, 0.7)}); }

Camera projection(bool orthographic) {
  return orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(45, kWindow, 1);
}

Camera view(bool orthographic) {
  return look_at(projection(orthographic), {0, -5, 3}, {0, 0, 0.4}, {0, 0, 1});
}

/// What a geometry differs from another by: the largest distances of positions and of normals.
struct Difference {
  float position = 0, normal = 0;
};

Difference difference(const Geometry& a, const Geometry& b) {
  Difference most;
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    EXPECT_EQ(a.is_surface(i), b.is_surface(i));
    const auto apart = [](const glm::vec3& p, const glm::vec3& q) { return glm::distance(p, q); };
    most.position = std::max(most.position, apart(a.surfaces[i].position, b.surfaces[i].position));
    most.normal = std::max(most.normal, apart(a.surfaces[i].normal, b.surfaces[i].normal));
  }
  return most;
}

/// A file for --camera.
void write_camera(const Camera& camera, const std::filesystem::path& path) {
  const glm::dmat3& r = camera.rotation;
  const glm::dvec3 t = -(r * camera.origin);
  std::ofstream out(path);
  out << fmt::format(R"({{"fx": {}, "fy": {}, "cx": {}, "cy": {}, "world_to_camera": [)", camera.fx,
                     camera.fy, camera.cx, camera.cy);
  for (int i = 0; i < 3; ++i)
    out << fmt::format("[{}, {}, {}, {}], ", r[0][i], r[1][i], r[2][i], t[i]);
  out << "[0, 0, 0, 1]]}";
}

CameraOptions with_fov(double degrees) { return {{}, degrees, {}}; }
CameraOptions with_width(double width) { return {{}, {}, width}; }

TEST(Geometry, IsPInTheSpaceOfTheCameraThatItShows) {
  for (const bool orthographic : {false, true}) {
    const Camera camera = view(orthographic);
    GeometryReport report;
    const Geometry g = build_geometry(gbuffer_of(take_picture(ball_on_ground(), camera, kWindow)),
                                      {}, "f", report);
    const Difference off = difference(g, geometry_of(ball_on_ground(), camera, kWindow));
    // An orthographic camera's place along its axis shows nowhere.
    if (!orthographic) {
      EXPECT_LT(off.position, 1e-3f);
    }
    EXPECT_LT(off.normal, 1e-4f);
    EXPECT_TRUE(g.world_known);
    EXPECT_EQ(report.normal_space, "the space of P");
    EXPECT_EQ(report.normals_rebuilt, 0u);
  }
}

/// Depth alone, of a picture whose camera the user gives.
GBuffer depth_of(const Picture& picture, DepthKind kind) {
  GBuffer g = gbuffer_of(picture);
  g.depth = Plane<float>(kWindow.width(), kWindow.height());
  g.depth_kind = kind;
  for (std::size_t i = 0; i < g.depth.size(); ++i) {
    const glm::dvec3 p = picture.camera.to_camera(glm::dvec3(picture.position[i]));
    g.depth[i] = float(kind == DepthKind::ray ? glm::length(p) : -p.z);
  }
  g.position = g.normal = {};
  return g;
}

TEST(Geometry, FromDepthIsThatFromP) {
  const Camera camera = view(false);
  const Picture picture = take_picture(ball_on_ground(), camera, kWindow);
  const Geometry expected = geometry_of(ball_on_ground(), camera, kWindow);
  for (const DepthKind kind : {DepthKind::planar, DepthKind::ray}) {
    GeometryReport report;
    const Geometry g = build_geometry(depth_of(picture, kind), with_fov(45), "f", report);
    EXPECT_LT(difference(g, expected).position, 3e-5f);
    EXPECT_FALSE(g.world_known);
    EXPECT_EQ(report.normals_rebuilt, picture.valid.size());
    EXPECT_EQ(report.normal_space, "rebuilt from P");
  }
}

TEST(Geometry, HasNormalsThatFaceTheViewerAndNoneMissing) {
  const Camera camera = view(false);
  GBuffer g = gbuffer_of(take_picture(ball_on_ground(), camera, kWindow));
  const std::size_t missing = g.normal.index(20, 60), turned = g.normal.index(70, 62);
  g.normal[missing] = glm::vec3(0);
  g.normal[turned] = -g.normal[turned];
  GeometryReport report;
  const Geometry geometry = build_geometry(g, {}, "f", report);
  EXPECT_LT(difference(geometry, geometry_of(ball_on_ground(), camera, kWindow)).normal, 1e-3f);
  EXPECT_EQ(report.normals_rebuilt, 1u);
  EXPECT_EQ(report.normals_turned, 1u);
}

/// What no P places is no background.
TEST(Geometry, LeavesOutWhatLiesBehindTheCamera) {
  const Camera camera = view(false);
  GBuffer g = gbuffer_of(take_picture(ball_on_ground(), camera, kWindow));
  const std::size_t behind = g.position.index(5, 70);
  g.position[behind] = glm::vec3(0, -20, 8);
  const std::size_t broken = behind + 3;
  g.valid[broken] = 0;
  g.broken = Plane<unsigned char>(kWindow.width(), kWindow.height());
  g.broken[broken] = 1;
  const TempDir dir;
  write_camera(camera, dir / "camera.json");
  GeometryReport report;
  const Geometry geometry =
      build_geometry(g, {(dir / "camera.json").string(), {}, {}}, "f", report);
  EXPECT_FALSE(geometry.is_surface(behind));
  EXPECT_TRUE(geometry.is_surface(behind + 1));
  for (std::size_t i = 0; i < geometry.surfaces.size(); ++i)
    EXPECT_EQ(geometry.surfaces[i].is_broken(), i == behind || i == broken) << i;
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("1 positions lie behind the camera")));
}

TEST(Geometry, OfAFrameWithoutSurfacesIsEmpty) {
  GBuffer g = gbuffer_of(take_picture(sphere({0, 0, -100}, 1), view(false), kWindow));
  g.background_pixels = g.valid.size();
  GeometryReport report;
  const Geometry geometry = build_geometry(g, {}, "f", report);
  for (std::size_t i = 0; i < geometry.surfaces.size(); ++i) ASSERT_FALSE(geometry.is_surface(i));
  EXPECT_THAT(report.warnings, ElementsAre("the frame shows no surface"));
}

TEST(Geometry, KnowsTheMedianDepthAndTheHeightOfTheFrameThere) {
  const Surface wall = plane({0, 0, -7}, {0, 0, 1});
  for (const bool orthographic : {false, true}) {
    const Camera camera = look_at(projection(orthographic), {0, 0, 0}, {0, 0, -1}, {0, 1, 0});
    GeometryReport report;
    const Geometry g =
        build_geometry(depth_of(take_picture(wall, camera, kWindow), DepthKind::planar),
                       orthographic ? with_width(4) : with_fov(45), "f", report);
    EXPECT_FLOAT_EQ(g.median_depth, 7);
    const double width = orthographic ? 4 : 2 * 7 * std::tan(0.5 * 45 * 3.14159265 / 180);
    EXPECT_NEAR(g.frame_height_at(g.median_depth), width * 72 / 96, 1e-4);
  }
}

}  // namespace
}  // namespace ssdo::test::geometry_test
