// SPDX-License-Identifier: Apache-2.0
//
// Whose space P is in, where --camera gives a pose.
#include "scene/camera/find_camera.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "scene/build_geometry.h"
#include "scene/camera/fit.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"
#include "support/temp_dir.h"

namespace ssdo::test::find_camera_test {
namespace {

const Window kWindow{0, 0, 96, 72};

Surface still_life() {
  return all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6), sphere({-1, 0.5, 0.4}, 0.4)});
}

Camera usual_camera() {
  return look_at(camera_from_fov(40, kWindow, 1), {1.5, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
}

void write_camera(const std::filesystem::path& path, const Camera& camera) {
  const glm::dvec3 t = -(camera.rotation * camera.origin);
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 3; ++row)
    rows.push_back(
        {camera.rotation[0][row], camera.rotation[1][row], camera.rotation[2][row], t[row]});
  rows.push_back({0, 0, 0, 1});
  std::ofstream(path) << nlohmann::json{{"fx", camera.fx}, {"world_to_camera", rows}};
}

/// Holds the geometry to what the picture shows in camera space.
void expect_placed(const Geometry& geometry, const Picture& picture) {
  for (std::size_t i = 0; i < geometry.surfaces.size(); ++i) {
    if (!geometry.is_surface(i)) continue;
    const glm::dvec3 p = picture.camera.to_camera(glm::dvec3(picture.position[i])),
                     n = picture.camera.rotation * glm::dvec3(picture.normal[i]);
    EXPECT_LT(glm::length(glm::dvec3(geometry.surfaces[i].position) - p), 1e-5);
    EXPECT_LT(glm::length(glm::dvec3(geometry.surfaces[i].normal) - n), 1e-4);
  }
}

TEST(FindCamera, TakesPInCameraSpaceBesideAPoseForWhatItIs) {
  const TempDir dir;
  const Picture picture = take_picture(still_life(), usual_camera(), kWindow);
  write_camera(dir / "camera.json", picture.camera);
  // Axes of camera space as other tools have them, OpenCV's among them; N in either space.
  for (const glm::vec3& signs :
       {glm::vec3(1, 1, 1), glm::vec3(1, 1, -1), glm::vec3(1, -1, -1), glm::vec3(-1, 1, 1)}) {
    for (const bool normals_in_world : {false, true}) {
      GBuffer g = gbuffer_of(picture);
      for (std::size_t i = 0; i < g.position.size(); ++i) {
        const glm::dvec3 p = picture.camera.to_camera(glm::dvec3(picture.position[i]));
        g.position[i] = signs * glm::vec3(p);
        if (!normals_in_world)
          g.normal[i] = signs * glm::vec3(picture.camera.rotation * glm::dvec3(g.normal[i]));
      }
      GeometryReport report;
      const Geometry geometry = build_geometry(g, {dir / "camera.json", {}, {}}, "test", report);
      expect_placed(geometry, picture);
      EXPECT_TRUE(report.warnings.empty());
      EXPECT_LT(report.residual->median_px, 0.01);
      EXPECT_TRUE(geometry.world_known);
      EXPECT_LT(glm::distance(geometry.world_to_camera[2], glm::mat3(picture.camera.rotation)[2]),
                1e-6);
    }
  }
}

TEST(FindCamera, TakesPInTheWorldOfThePose) {
  const TempDir dir;
  const Picture picture = take_picture(still_life(), usual_camera(), kWindow);
  write_camera(dir / "camera.json", picture.camera);
  GeometryReport report;
  const Geometry geometry =
      build_geometry(gbuffer_of(picture), {dir / "camera.json", {}, {}}, "test", report);
  expect_placed(geometry, picture);
  EXPECT_TRUE(report.warnings.empty());
}

TEST(FindCamera, PrefersPToAPoseOfAnotherShot) {
  const TempDir dir;
  const Picture picture = take_picture(still_life(), usual_camera(), kWindow);
  Camera other = usual_camera();
  other.origin += glm::dvec3(0.5, 0, 0);
  write_camera(dir / "camera.json", other);
  GeometryReport report;
  const Geometry geometry =
      build_geometry(gbuffer_of(picture), {dir / "camera.json", {}, {}}, "test", report);
  expect_placed(geometry, picture);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("contradicts P"), std::string::npos);
  EXPECT_EQ(report.camera_source, "fitted from P");
}

TEST(FindCamera, TakesACameraThatLooksTheOtherWayForNone) {
  // Behind the camera, positions project to the same pixels.
  const TempDir dir;
  const Picture picture = take_picture(still_life(), usual_camera(), kWindow);
  Camera turned = usual_camera();
  for (int i = 0; i < 3; ++i) turned.rotation[i] = -turned.rotation[i];
  EXPECT_FALSE(explains(turned, picture.position, picture.valid, kWindow));
  EXPECT_TRUE(explains(usual_camera(), picture.position, picture.valid, kWindow));
}

}  // namespace
}  // namespace ssdo::test::find_camera_test
