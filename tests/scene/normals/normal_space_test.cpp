// SPDX-License-Identifier: Apache-2.0
//
// Which space and axes stored normals have, by the gradient of P.
#include "scene/normals/normal_space.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "scene/build_geometry.h"
#include "scene/geometry.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::normal_space_test {
namespace {

const Window kWindow{0, 0, 64, 48};

Surface still_life() {
  return all_of({plane({}, {0, 0, 1}), plane({0, 4, 0}, {0, -1, 0}), sphere({0.2, 0, 0.6}, 0.6),
                 sphere({-1, 0.5, 0.4}, 0.4)});
}

Camera usual_camera(const Window& window = kWindow) {
  return look_at(camera_from_fov(40, window, 1), {1.5, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
}

GBuffer still_life_frame() {
  return gbuffer_of(take_picture(still_life(), usual_camera(), kWindow));
}

/// The normals of `g` as they are used, beside those of the picture: mean angle in degrees over
/// the surfaces.
double mean_angle(const GBuffer& g, const GBuffer& right, GeometryReport& report) {
  GeometryReport ignored;
  const Geometry found = build_geometry(g, {}, "test", report),
                 expected = build_geometry(right, {}, "test", ignored);
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    if (!found.is_surface(i)) continue;
    const float cosine = glm::dot(found.surfaces[i].normal, expected.surfaces[i].normal);
    sum += glm::degrees(std::acos(std::clamp(double(cosine), -1.0, 1.0)));
    count += 1;
  }
  return sum / count;
}

/// All 48 orders and signs of the axes.
std::vector<glm::mat3> all_axes() {
  std::vector<glm::mat3> all;
  std::array<int, 3> source{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      glm::mat3 m(0);
      for (int i = 0; i < 3; ++i) m[source[std::size_t(i)]][i] = signs & (1 << i) ? -1.0f : 1.0f;
      all.push_back(m);
    }
  } while (std::next_permutation(source.begin(), source.end()));
  return all;
}

TEST(NormalSpace, IsFoundForAnyOrderAndSignOfTheAxesInWorldAndCameraSpace) {
  const GBuffer right = still_life_frame();
  const glm::mat3 world(1), camera(usual_camera().rotation);
  for (const glm::mat3& base : {world, camera}) {
    for (const glm::mat3& axes : all_axes()) {
      GBuffer g = right;
      for (glm::vec3& n : g.normal.pixels) n = axes * (base * n);
      GeometryReport report;
      EXPECT_LT(mean_angle(g, right, report), 0.05) << report.normal_space;
      EXPECT_GT(report.normal_agreement, 0.99);
    }
  }
}

TEST(NormalSpace, IsTheSpaceOfPWhereNothingElseIsBetter) {
  GeometryReport report;
  mean_angle(still_life_frame(), still_life_frame(), report);
  EXPECT_EQ(report.normal_space, "the space of P");
  // A floor alone looks the same in several spaces; its camera is given, since it shows none.
  const GBuffer floor = gbuffer_of(take_picture(plane({}, {0, 0, 1}), usual_camera(), kWindow));
  GeometryReport of_floor;
  build_geometry(floor, {"", 40, {}}, "test", of_floor);
  EXPECT_EQ(of_floor.normal_space, "the space of P");
}

TEST(NormalSpace, IsFittedWhereNormalsAreTurnedAgainstP) {
  const GBuffer right = still_life_frame();
  for (const float degrees : {5.0f, 20.0f, 33.0f}) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1), glm::radians(degrees), {1, 0.5f, -0.3f}));
    GBuffer g = right;
    for (glm::vec3& n : g.normal.pixels) n = turn * n;
    GeometryReport report;
    EXPECT_LT(mean_angle(g, right, report), 0.1) << degrees;
    EXPECT_NE(report.normal_space.find("a space of its own"), std::string::npos);
  }
}

/// Turned against the world by an angle about the vertical, which is y.
Picture slightly_turned_picture(float degrees) {
  const double angle = glm::radians(double(degrees));
  const Camera camera =
      look_at(camera_from_fov(40, kWindow, 1), {5 * std::sin(angle), 0.6, 5 * std::cos(angle)},
              {0, 0.6, 0}, {0, 1, 0});
  return take_picture(all_of({plane({}, {0, 1, 0}), sphere({0.2, 0.6, 0}, 0.6)}), camera, kWindow);
}

TEST(NormalSpace, IsToldFromAnotherThatIsTurnedByLittle) {
  for (const float degrees : {3.0f, 10.0f, 24.0f}) {
    const Picture picture = slightly_turned_picture(degrees);
    const GBuffer right = gbuffer_of(picture);
    GeometryReport of_world, of_camera;
    mean_angle(right, right, of_world);
    EXPECT_EQ(of_world.normal_space, "the space of P") << degrees;
    GBuffer g = right;
    for (glm::vec3& n : g.normal.pixels) n = glm::mat3(picture.camera.rotation) * n;
    EXPECT_LT(mean_angle(g, right, of_camera), 0.05) << degrees;
    EXPECT_EQ(of_camera.normal_space, "camera space") << degrees;
  }
}

/// Bumps of 15 degrees do not show a turn of 5.
TEST(NormalSpace, IsTheFirstWhereBumpsHideTheTurn) {
  const Picture picture = slightly_turned_picture(5);
  const GBuffer right = gbuffer_of(picture);
  for (const glm::mat3& turn : {glm::mat3(1), glm::mat3(picture.camera.rotation)}) {
    GBuffer g = right;
    std::mt19937 random(1);
    std::normal_distribution<float> bump(0, std::tan(glm::radians(15.0f)));
    for (glm::vec3& n : g.normal.pixels)
      n = turn * glm::normalize(n + glm::vec3(bump(random), bump(random), bump(random)));
    GeometryReport report;
    mean_angle(g, right, report);
    EXPECT_EQ(report.normal_space, "the space of P");
  }
}

TEST(NormalSpace, OfAShiftedFrameIsNone) {
  const GBuffer right = still_life_frame();
  for (const int shift : {6, 16}) {
    GBuffer g = right;
    for (int y = 0; y < kWindow.height(); ++y)
      for (int x = 0; x < kWindow.width(); ++x)
        g.normal(x, y) = right.normal((x + shift) % kWindow.width(), y);
    GeometryReport report;
    // What is rebuilt from P is right but for the pixels at edges.
    EXPECT_LT(mean_angle(g, right, report), 2) << shift;
    EXPECT_EQ(report.normal_space, "rebuilt from P");
    ASSERT_FALSE(report.warnings.empty());
    EXPECT_NE(report.warnings[0].find("normals do not belong to P"), std::string::npos);
  }
}

TEST(NormalSpace, KeepsBumpsAndTheNormalsOfBackFaces) {
  const GBuffer right = still_life_frame();
  GBuffer g = right;
  std::mt19937 random(1);
  std::normal_distribution<float> bump(0, std::tan(glm::radians(15.0f)));
  for (std::size_t i = 0; i < g.normal.size(); ++i) {
    glm::vec3& n = g.normal[i];
    n = glm::normalize(n + glm::vec3(bump(random), bump(random), bump(random)));
    if (i % 3 == 0) n = -n;  // a third of the faces are turned away
  }
  GeometryReport report;
  const double angle = mean_angle(g, right, report);
  EXPECT_EQ(report.normal_space, "the space of P");
  EXPECT_GT(angle, 10);
  EXPECT_LT(angle, 25);
}

TEST(NormalSpace, KeepsNormalsWhosePixelsHaveNoNeighbours) {
  // Checkerboard, rows, columns: P is smooth over every second pixel.
  const GBuffer right = still_life_frame();
  const std::array<bool (*)(int, int), 3> patterns = {[](int x, int y) { return (x + y) % 2 == 0; },
                                                      [](int, int y) { return y % 2 == 0; },
                                                      [](int x, int) { return x % 2 == 0; }};
  for (const auto& shows : patterns) {
    GBuffer g = right;
    for (int y = 0; y < kWindow.height(); ++y)
      for (int x = 0; x < kWindow.width(); ++x)
        if (!shows(x, y)) g.valid(x, y) = 0;
    GeometryReport report;
    EXPECT_LT(mean_angle(g, right, report), 0.05);
    EXPECT_EQ(report.normal_space, "the space of P");
    EXPECT_EQ(report.normals_rebuilt, 0u);
  }
  // One pixel of 64: nothing to hold N to, and no reason to throw it away.
  GBuffer sparse = right;
  for (std::size_t i = 0; i < sparse.valid.size(); ++i)
    if (i % 8 != 3 || i / std::size_t(kWindow.width()) % 8 != 5) sparse.valid[i] = 0;
  GeometryReport report;
  EXPECT_LT(mean_angle(sparse, right, report), 0.05);
  EXPECT_EQ(report.normals_rebuilt, 0u);
}

TEST(NormalSpace, OfAFrameOfDepthAloneIsFoundInTheWorldToo) {
  // No pose is known: the rotation of the world is fitted to the depth's own normals.
  const Picture picture = take_picture(still_life(), usual_camera(), kWindow);
  GBuffer g = gbuffer_of(picture);
  g.position = {};
  g.depth = Plane<float>(kWindow.width(), kWindow.height());
  for (std::size_t i = 0; i < g.depth.size(); ++i)
    g.depth[i] = float(-picture.camera.to_camera(glm::dvec3(picture.position[i])).z);
  GeometryReport report;
  const Geometry found = build_geometry(g, {"", 40, {}}, "test", report);
  double worst = 0;
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    if (!found.is_surface(i)) continue;
    const glm::vec3 expected = glm::mat3(picture.camera.rotation) * picture.normal[i];
    worst = std::max(worst, double(glm::length(found.surfaces[i].normal - expected)));
  }
  EXPECT_LT(worst, 5e-3);
  EXPECT_FALSE(found.world_known);
}

/// Most pixels show a floor, whose normal a turn about the vertical does not change.
TEST(NormalSpace, OfADepthAloneIsFittedBesideAFloor) {
  for (const float degrees : {10.0f, 24.0f}) {
    const Picture picture = slightly_turned_picture(degrees);
    GBuffer g = gbuffer_of(picture);
    g.position = {};
    g.depth = Plane<float>(kWindow.width(), kWindow.height());
    for (std::size_t i = 0; i < g.depth.size(); ++i)
      g.depth[i] = float(-picture.camera.to_camera(glm::dvec3(picture.position[i])).z);
    GBuffer right = g;
    for (glm::vec3& n : right.normal.pixels) n = glm::mat3(picture.camera.rotation) * n;
    GeometryReport report, ignored;
    const Geometry found = build_geometry(g, {"", 40, {}}, "test", report),
                   expected = build_geometry(right, {"", 40, {}}, "test", ignored);
    float worst = 0;
    for (std::size_t i = 0; i < found.surfaces.size(); ++i)
      worst = std::max(worst, glm::length(found.surfaces[i].normal - expected.surfaces[i].normal));
    EXPECT_LT(worst, 5e-3f) << degrees << report.normal_space;
    EXPECT_TRUE(report.warnings.empty());
  }
}

}  // namespace
}  // namespace ssdo::test::normal_space_test
