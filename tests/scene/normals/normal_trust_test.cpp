// SPDX-License-Identifier: Apache-2.0
//
// Normals that are meant to differ from P stay, on the objects that have them and everywhere else;
// normals of another frame do not.
#include "scene/normals/normal_trust.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <random>

#include "scene/build_geometry.h"
#include "scene/geometry.h"
#include "scene/normals/normal_space.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::normal_trust_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const Window kWindow{0, 0, 120, 80};
const glm::dvec3 kUp(0, 0, 1), kBall(0.9, 0.1, 0.35);
constexpr double kBallRadius = 0.35;

/// Discs of one radius, turned at random, over the left half of the ground.
Surface leaves(double radius) {
  std::mt19937 random(1);
  std::normal_distribution<double> axis;
  std::uniform_real_distribution<double> x(-1.2, 0.2), y(-0.7, 0.7), z(0.15, 0.8);
  std::vector<Surface> all;
  for (int k = 0; k < 40; ++k) {
    // In braces: in this order, with any compiler.
    const glm::dvec3 centre{x(random), y(random), z(random)},
        normal = glm::normalize(glm::dvec3{axis(random), axis(random), axis(random)});
    all.push_back(cut(plane(centre, normal), [=](const glm::dvec3& p) {
      return glm::distance(p, centre) < radius && p.z > 0.01;
    }));
  }
  return all_of(all);
}

Picture garden(double radius, double height = 1.8) {
  const Camera camera =
      look_at(camera_from_fov(38, kWindow, 1), {0.3, -4, height}, {0, 0, 0.3}, kUp);
  return take_picture(all_of({plane({}, kUp), sphere(kBall, kBallRadius), leaves(radius)}), camera,
                      kWindow);
}

bool is_floor(const glm::vec3& p) { return p.z < 0.005f; }

bool is_leaf(const glm::vec3& p) {
  return !is_floor(p) && glm::distance(glm::dvec3(p), kBall) > kBallRadius + 0.005;
}

/// A normal map of the floor that has waves along x.
glm::vec3 wave(const glm::vec3& p, float degrees, float length) {
  const float lean = glm::radians(degrees) * std::sin(2 * glm::pi<float>() * p.x / length);
  return {std::sin(lean), 0, std::cos(lean)};
}

using NormalOf = std::function<glm::vec3(const glm::vec3& position, const glm::vec3& normal)>;

GBuffer with_normals(const Picture& picture, const NormalOf& stored) {
  GBuffer g = gbuffer_of(picture);
  for (std::size_t i = 0; i < g.normal.size(); ++i)
    if (picture.valid[i]) g.normal[i] = stored(picture.position[i], picture.normal[i]);
  return g;
}

/// The largest angle, in degrees, between a normal as it is used and as it is stored, over the
/// pixels of `where` that are not turned to the viewer.
double largest_change(const GBuffer& g, const Geometry& found,
                      const std::function<bool(const glm::vec3&)>& where) {
  double largest = 0;
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    if (!found.is_surface(i) || !where(g.position[i])) continue;
    const glm::vec3 stored = found.normals_to_camera * g.normal[i];
    if (glm::dot(stored, found.surfaces[i].position) > 0) continue;
    largest = std::max(
        largest, double(glm::degrees(
                     2 * std::asin(std::min(
                             1.0f, 0.5f * glm::distance(stored, found.surfaces[i].normal))))));
  }
  return largest;
}

struct Style {
  const char* name;
  NormalOf leaf;
  float wave_degrees, wave_length;
};

const std::array<Style, 4> kStyles = {{
    {"up", [](const glm::vec3&, const glm::vec3&) { return glm::vec3(0, 0, 1); }, 20, 0.2f},
    {"crown",
     [](const glm::vec3& p, const glm::vec3&) {
       return glm::normalize(p - glm::vec3(-0.5f, 0, 0.3f));
     },
     20, 0.2f},
    {"steep waves", [](const glm::vec3&, const glm::vec3& n) { return n; }, 70, 0.2f},
    {"long steep waves", [](const glm::vec3&, const glm::vec3& n) { return n; }, 70, 0.5f},
}};

TEST(NormalTrust, KeepsNormalsThatAreMeantToDifferFromP) {
  for (const Style& style : kStyles) {
    double least_agreement = 1;
    for (const double radius : {0.06, 0.12, 0.2}) {
      SCOPED_TRACE(testing::Message() << style.name << ", leaves of " << radius);
      const GBuffer g = with_normals(garden(radius), [&](const glm::vec3& p, const glm::vec3& n) {
        if (is_floor(p)) return wave(p, style.wave_degrees, style.wave_length);
        return is_leaf(p) ? style.leaf(p, n) : n;
      });
      GeometryReport report;
      const Geometry found = build_geometry(g, {}, "test", report);
      EXPECT_EQ(report.normal_space, "the space of P");
      EXPECT_LT(largest_change(g, found, [](const glm::vec3&) { return true; }), 0.1);
      least_agreement = std::min(least_agreement, report.normal_agreement);
    }
    EXPECT_LT(least_agreement, NormalSpace::kLeastShare) << style.name << ": shows nothing";
  }
}

TEST(NormalTrust, SaysThatNormalsDisagreeAndAreUsed) {
  const GBuffer g = with_normals(garden(0.2), [](const glm::vec3& p, const glm::vec3& n) {
    return is_leaf(p) ? glm::vec3(0, 0, 1) : n;
  });
  GeometryReport report;
  build_geometry(g, {}, "test", report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_THAT(report.warnings[0], HasSubstr("are used as they are"));
}

/// Leaves whose normals all point up agree with other axes by chance as well as with their own.
TEST(NormalTrust, LeavesBeforeTheSkyShowNoOtherAxes) {
  for (const double height : {0.4, -1.0}) {
    const Camera camera =
        look_at(camera_from_fov(30, kWindow, 1), {-0.5, -4, height}, {-0.5, 0, 0.45}, kUp);
    const GBuffer g =
        with_normals(take_picture(leaves(0.2), camera, kWindow),
                     [](const glm::vec3&, const glm::vec3&) { return glm::vec3(0, 0, 1); });
    GeometryReport report;
    build_geometry(g, {}, "test", report);
    EXPECT_THAT(report.normal_space, StartsWith("the space of P")) << height;
    EXPECT_THAT(report.normal_space, Not(HasSubstr("turned"))) << height;
  }
}

/// Below a crown, N points up where leaves show their undersides.
TEST(NormalTrust, NormalsBelowTheSurfaceAreBroughtToTheViewersSide) {
  const Camera camera =
      look_at(camera_from_fov(30, kWindow, 1), {-0.5, -3, -1.5}, {-0.5, 0, 0.45}, kUp);
  const Picture picture =
      take_picture(all_of({leaves(0.2), sphere(kBall, kBallRadius)}), camera, kWindow);
  const GBuffer right = gbuffer_of(picture),
                up = with_normals(picture, [](const glm::vec3&p, const glm::vec3&n) {
                  return is_leaf(p) ? glm::vec3(0, 0, 1) : n;
                });
  GeometryReport report, ignored;
  const Geometry found = build_geometry(up, {}, "test", report),
                 expected = build_geometry(right, {}, "test", ignored);
  EXPECT_GT(report.normals_turned, 100u);
  int against = 0;  // the surface; on the rim of a leaf
  for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
    if (!found.is_surface(i)) continue;
    const glm::vec3 &n = found.surfaces[i].normal, &p = found.surfaces[i].position;
    against += glm::dot(n, p) > 0 && glm::dot(n, expected.surfaces[i].normal) < -0.05f;
  }
  EXPECT_LE(against, 1);
}

TEST(NormalTrust, AFrameOfAnotherPictureIsRebuilt) {
  const Picture picture = garden(0.12);
  const GBuffer right = gbuffer_of(picture);
  const auto at = [&](int x, int y) { return right.normal(x % 120, y); };
  const std::vector<std::pair<const char*, std::function<glm::vec3(int, int)>>> wrong = {
      {"shifted", [&](int x, int y) { return at(x + 9, y); }},
      {"mirrored", [&](int x, int y) { return at(119 - x, y); }},
      {"upside down", [&](int x, int y) { return at(x, 79 - y); }}};
  for (const auto& [name, normal] : wrong) {
    GBuffer g = right;
    for (int y = 0; y < kWindow.height(); ++y)
      for (int x = 0; x < kWindow.width(); ++x) g.normal(x, y) = normal(x, y);
    GeometryReport report;
    build_geometry(g, {}, "test", report);
    EXPECT_EQ(report.normal_space, "rebuilt from P") << name;
    ASSERT_FALSE(report.warnings.empty()) << name;
    EXPECT_THAT(report.warnings[0], HasSubstr("normals do not belong to P"));
  }
}

/// Tangent space, for one: the floor may keep it, since it is right there.
TEST(NormalTrust, AConstantNIsUsedOnlyWhereItAgrees) {
  const Picture picture = garden(0.2);
  for (const glm::vec3& constant : {glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(1, 0, 0)}) {
    const GBuffer g =
        with_normals(picture, [&](const glm::vec3&, const glm::vec3&) { return constant; });
    GeometryReport report, ignored;
    const Geometry found = build_geometry(g, {}, "test", report),
                   right = build_geometry(gbuffer_of(picture), {}, "test", ignored);
    EXPECT_GT(report.normals_rebuilt, 500u);
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
      if (!found.is_surface(i)) continue;
      sum += std::abs(glm::dot(found.surfaces[i].normal, right.surfaces[i].normal)), count += 1;
    }
    EXPECT_GT(sum / count, 0.9) << constant.x << constant.y << constant.z;
  }
}

TEST(NormalTrust, RightNormalsAreUsedEverywhere) {
  GeometryReport report;
  build_geometry(gbuffer_of(garden(0.12)), {}, "test", report);
  EXPECT_EQ(report.normals_rebuilt, 0u);
  EXPECT_THAT(report.warnings, IsEmpty());
}

}  // namespace
}  // namespace ssdo::test::normal_trust_test
