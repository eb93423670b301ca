// SPDX-License-Identifier: Apache-2.0
//
// The light of lamps without occluders, against slow sums: any distance, tilt and cut by the
// horizon.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_access.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <string>

#include "scene/light/lamps/lamp_sum.h"

namespace ssdo::test::lamp_light_test {
namespace {

constexpr double kWanted = 1e-3;
const WorldToCamera kCamera;  // camera space is the world

Lamp random_lamp(LampType type, std::mt19937& random) {
  Lamp lamp;
  lamp.name = "lamp";
  lamp.type = type;
  lamp.axes = about(random_unit(random));
  lamp.position = between(random, 0, 3) * random_unit(random);
  lamp.radius = std::pow(10, between(random, -1, 1));
  lamp.width = std::pow(10, between(random, -1, 1)),
  lamp.height = lamp.width * between(random, 0.2, 5);
  lamp.angle = std::pow(10, between(random, -1, 2.55));
  lamp.intensity = 3;
  return lamp;
}

/// A receiver in front of a lamp, 0.003 to 300 times its size away from it; half of them have the
/// lamp at their horizon.
struct Receiver {
  glm::vec3 position, normal;

  Receiver(const Lamp& lamp, std::mt19937& random) {
    const double size = lamp.type == LampType::rect ? lamp.width / 2 : lamp.radius;
    glm::dvec3 out = random_unit(random);
    const double front = glm::dot(out, -lamp.axes[2]);
    double away = std::pow(10, between(random, -2.5, 2.5));
    if (lamp.type == LampType::sphere) {
      away = 1 + std::pow(10, between(random, -2.5, 2.5));
    } else if (front < 0.05) {
      out = glm::normalize(out + lamp.axes[2] * (front - between(random, 0.05, 1)));
    }
    position = glm::vec3(lamp.position + out * (away * size));
    glm::dvec3 n = random_unit(random);
    if (between(random, 0, 1) < 0.5) {
      const glm::dvec3 across = glm::normalize(glm::cross(n, out));
      n = glm::normalize(across + between(random, -1, 1) * std::min(1.0, 1 / away) * out);
    }
    normal = glm::vec3(n);
  }
};

/// What a receiver at the same place gets at most, whatever its normal.
double most_light(const Source& source, const glm::vec3& position) {
  std::mt19937 random(1);
  float most = 0;
  for (int i = 0; i < 200; ++i)
    most = std::max(most, source.received(position, glm::vec3(random_unit(random))));
  return most * source.irradiance.x;
}

void expect_as_summed(const Lamp& lamp, std::mt19937& random, int count, int side) {
  for (int i = 0; i < count; ++i) {
    const Receiver r(lamp, random);
    const auto source = make_source(lamp, kCamera, 0);
    Lamp open = lamp;
    open.has_cone = false;
    const double most = most_light(*make_source(open, kCamera, 0), r.position);
    const double found = source->unoccluded(r.position, r.normal).x;
    const double slow = 3 * slow_sum(lamp, r.position, r.normal, side);
    EXPECT_NEAR(found, slow, kWanted * most)
        << i << ", type " << int(lamp.type) << ", "
        << glm::distance(glm::dvec3(r.position), lamp.position) / reach_of(lamp)
        << " sizes away, cone " << lamp.cone_angle << " " << lamp.cone_softness;
  }
}

class LampLight : public testing::TestWithParam<LampType> {};

TEST_P(LampLight, IsTheSumOverItsPoints) {
  std::mt19937 random(7);
  for (int i = 0; i < 25; ++i) {
    Lamp lamp = random_lamp(GetParam(), random);
    lamp.soft_falloff = i % 2 == 1;
    expect_as_summed(lamp, random, 1, 500);
  }
}

TEST_P(LampLight, IsTheSumWithinItsCone) {
  if (GetParam() == LampType::distant) return;
  std::mt19937 random(8);
  for (int i = 0; i < 25; ++i) {
    Lamp lamp = random_lamp(GetParam(), random);
    lamp.has_cone = true;
    lamp.cone_angle = between(random, 10, 100);
    lamp.cone_softness = i % 4 == 0 ? 0 : between(random, 0, 1);
    lamp.cone_by_cosine = i % 2 == 1, lamp.soft_falloff = i % 3 == 1;
    expect_as_summed(lamp, random, 1, 600);
  }
}

TEST_P(LampLight, IsTheMeanOverItsPoints) {
  std::mt19937 random(9);
  for (int i = 0; i < 30; ++i) {
    Lamp lamp = random_lamp(GetParam(), random);
    lamp.has_cone = i % 3 == 0;
    lamp.cone_angle = between(random, 20, 100), lamp.cone_softness = between(random, 0.2, 1);
    lamp.cone_by_cosine = i % 2 == 1, lamp.soft_falloff = i % 5 == 0;
    const Receiver r(lamp, random);
    const auto source = make_source(lamp, kCamera, 0);
    constexpr int kSide = 128;
    double sum = 0, brightest = 0, weights = 0;
    for (int k = 0; k < kSide * kSide; ++k) {
      const glm::vec2 u((float(k % kSide) + 0.5f) / kSide, (float(k / kSide) + 0.5f) / kSide);
      const SourcePoint point = source->sample(r.position, u);
      ASSERT_NEAR(glm::length(point.to), 1, 1e-4);
      ASSERT_GT(point.distance, 0);
      sum += point.weight * std::max(0.0f, glm::dot(point.to, r.normal));
      brightest = std::max(brightest, double(point.weight)), weights += point.weight;
    }
    const double mean = sum / (kSide * kSide);
    Lamp open = lamp;
    open.has_cone = false;
    const double most =
        most_light(*make_source(open, kCamera, 0), r.position) / source->irradiance.x;
    EXPECT_NEAR(source->received(r.position, r.normal), mean, 2 * kWanted * most) << i;
    // One ray tells as much as another: no fireflies.
    if (!lamp.has_cone) {
      EXPECT_LT(brightest, 2.5 * weights / (kSide * kSide)) << i;
    }
  }
}

TEST_P(LampLight, IsFiniteAndContinuousEverywhere) {
  std::mt19937 random(10);
  for (const double radius : {1e-6, 0.1, 1e6}) {
    for (int i = 0; i < 400; ++i) {
      Lamp lamp = random_lamp(GetParam(), random);
      lamp.position = glm::dvec3(0);
      lamp.radius = radius, lamp.width = radius, lamp.height = 2 * radius;
      lamp.normalize = i % 2 == 0;
      lamp.has_cone = i % 3 == 0, lamp.soft_falloff = i % 7 == 0;
      constexpr double kNearest = 0.01;
      const auto source = make_source(lamp, kCamera, kNearest);
      // On its surface, on its plane, at its middle, within a pixel.
      glm::dvec3 at = random_unit(random) * std::pow(10, between(random, -9, 7));
      if (i % 5 == 1) at = random_unit(random) * radius;
      if (i % 5 == 2) at = lamp.axes[0] * between(random, -1, 1) * radius;
      if (i % 5 == 3) at = glm::dvec3(0);
      const glm::vec3 position(at), normal(random_unit(random));
      const float received = source->received(position, normal);
      const SourcePoint point =
          source->sample(position, glm::vec2{between(random, 0, 1), between(random, 0, 1)});
      EXPECT_TRUE(std::isfinite(received) && received >= 0) << received;
      EXPECT_TRUE(std::isfinite(point.weight) && point.weight >= 0 && point.distance > 0)
          << radius << " " << i << " " << point.weight << " " << point.distance;
      EXPECT_NEAR(glm::length(point.to), 1, 1e-3);
      EXPECT_LE(received, 1.6 / (kNearest * kNearest));
      EXPECT_LE(point.weight, 8 / (kNearest * kNearest));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Types, LampLight,
    testing::Values(LampType::sphere, LampType::disk, LampType::rect, LampType::distant),
    [](const auto& type) {
      return std::string(std::array{"Sphere", "Disk", "Rect", "Distant"}[std::size_t(type.param)]);
    });

TEST(Lamp, NormalizeDividesByTheArea) {
  Lamp lamp;
  lamp.intensity = 100;
  const glm::vec3 position(0), normal(0, 0, -1);
  const auto light = [&] { return make_source(lamp, kCamera, 0)->unoccluded(position, normal).x; };
  lamp.position = {0, 0, -50};
  lamp.axes = about({0, 0, -1});  // looks at the receiver
  for (const LampType type : {LampType::sphere, LampType::disk, LampType::rect}) {
    lamp.type = type;
    lamp.radius = 0.2, lamp.width = 0.4, lamp.height = 0.1;
    lamp.normalize = false;
    const double area = type == LampType::sphere ? 4 * glm::pi<double>() * 0.04
                        : type == LampType::disk ? glm::pi<double>() * 0.04
                                                 : 0.04;
    const double plain = light();
    lamp.normalize = true;
    EXPECT_NEAR(light() * area / plain, 1, 1e-5);
    // Far away, it is as that of any size.
    lamp.radius = 0.02, lamp.width = 0.04, lamp.height = 0.01;
    EXPECT_NEAR(light() * area / plain, 1, 1e-4);
  }
  // A distant lamp gives a surface that faces it its intensity.
  lamp.type = LampType::distant;
  for (const double angle : {0.0, 0.53, 90.0, 180.0}) {
    lamp.angle = angle;
    EXPECT_NEAR(light(), 100 / glm::pi<double>(), 1e-3) << angle;
  }
}

TEST(Lamp, OfAPointGoesWithTheSquareOfTheDistance) {
  Lamp lamp;
  lamp.radius = 0, lamp.normalize = true, lamp.intensity = 50;
  lamp.position = {1, 2, -3};
  const auto source = make_source(lamp, kCamera, 0.001);
  for (const double distance : {0.002, 0.1, 1.0, 1000.0}) {
    for (const double cosine : {1.0, 0.3, 0.001, -0.2}) {
      const glm::dvec3 normal(std::sqrt(1 - cosine * cosine), 0, cosine);
      const glm::vec3 position(lamp.position - glm::dvec3(0, 0, distance));
      const double actual = glm::distance(glm::dvec3(position), lamp.position);
      const double expected =
          50 / (4 * glm::pi<double>() * actual * actual) * std::max(0.0, cosine);
      EXPECT_NEAR(source->unoccluded(position, glm::vec3(normal)).x, expected, 1e-5 * expected);
    }
  }
  // Nearer than `nearest`, there is no more.
  const float most = source->unoccluded({1, 2, -3.0005f}, {0, 0, 1}).x;
  EXPECT_NEAR(most, 50 / (4 * glm::pi<double>() * 1e-6), 0.01 * most);
}

TEST(Lamp, ShinesInsideOfItsSphereWithoutAJump) {
  Lamp lamp;
  lamp.radius = 2;
  const auto source = make_source(lamp, kCamera, 0);
  const glm::vec3 normal = glm::normalize(glm::vec3(1, 2, 3));
  EXPECT_NEAR(source->unoccluded({0, 0, 0}, normal).x, 1, 1e-6);
  const float on_surface = source->unoccluded({2, 0, 0}, normal).x;
  EXPECT_NEAR(on_surface, (1 - normal.x) / 2, 1e-3);
  for (const float x : {1.9999f, 2.0001f})
    EXPECT_NEAR(source->unoccluded({x, 0, 0}, normal).x, on_surface, 0.01f) << x;
}

TEST(Lamp, FlatOnesSendFromTheirFrontOnly) {
  Lamp lamp;
  for (const LampType type : {LampType::disk, LampType::rect}) {
    lamp.type = type;  // looks along -z
    const auto source = make_source(lamp, kCamera, 0);
    EXPECT_GT(source->received({0.1f, 0.2f, -1}, {0, 0, 1}), 0);
    EXPECT_EQ(source->received({0.1f, 0.2f, 1}, {0, 0, -1}), 0);
    EXPECT_EQ(source->received({0.1f, 0.2f, 0}, {0, 0, 1}), 0);
    EXPECT_EQ(source->sample({0.1f, 0.2f, 1}, {0.5f, 0.5f}).weight, 0);
  }
}

/// The same scene in a world that is turned, moved and, for the second, left-handed.
TEST(Lamp, IsPlacedByTheCamera) {
  std::mt19937 random(11);
  for (const double hand : {1.0, -1.0}) {
    WorldToCamera camera;
    camera.rotation = glm::transpose(about(random_unit(random)));
    camera.rotation = camera.rotation * glm::dmat3(hand, 0, 0, 0, 1, 0, 0, 0, 1);
    camera.origin = {5, -2, 30};
    for (const LampType type :
         {LampType::sphere, LampType::disk, LampType::rect, LampType::distant}) {
      Lamp lamp = random_lamp(type, random);
      lamp.has_cone = type != LampType::distant;
      lamp.cone_angle = 80, lamp.cone_softness = 0.5;
      const auto in_world = make_source(lamp, kCamera, 0), in_camera = make_source(lamp, camera, 0);
      for (int i = 0; i < 20; ++i) {
        const Receiver r(lamp, random);
        const glm::dvec3 place = camera.rotation * (glm::dvec3(r.position) - camera.origin),
                         normal = camera.rotation * glm::dvec3(r.normal);
        const float world = in_world->received(r.position, r.normal);
        EXPECT_NEAR(in_camera->received(glm::vec3(place), glm::vec3(normal)), world,
                    0.02 * most_light(*in_world, r.position) / in_world->irradiance.x);
      }
    }
  }
}

/// Lamps of Blender of C watts, for which its renders follow (DiffDir: irradiance over pi)
///   point, radius r   C cos / (4 pi^2 (d^2 + r^2)), a disk of radius r that faces the receiver
///   spot              the same times c and a smooth step, c being the cosine to its axis
///   area, size x, y   C / (4 x y) times the form factor
/// Those of the frames that were rendered to check this: watts, radius or size, cone.
struct BlenderLamp {
  double watts, radius, height, cone, blend;
};

TEST(BlenderLamps, OfAPointAreDisksThatTurn) {
  constexpr double kPi = std::numbers::pi;
  for (const auto& [watts, radius] : {std::pair{60.0, 0.05}, {120.0, 0.06}, {2500.0, 0.2}}) {
    Lamp lamp;
    lamp.radius = radius, lamp.intensity = watts / (4 * kPi * kPi * radius * radius);
    lamp.soft_falloff = true;
    for (const double d : {0.1, 1.0, 3.0, 20.0}) {
      const float found =
          make_source(lamp, kCamera, 0)->unoccluded({0, 0, float(d)}, {0, 0.6f, -0.8f}).x;
      const double formula = watts * 0.8 / (4 * kPi * kPi * (d * d + radius * radius));
      EXPECT_NEAR(found / formula, 1, d > 2 * radius ? 1e-5 : 0.05) << d;
    }
  }
}

TEST(BlenderLamps, OfASpotAreDisksWithCones) {
  constexpr double kPi = std::numbers::pi;
  for (const BlenderLamp& spot :
       {BlenderLamp{2000, 0.05, 0, 30, 0.3}, {250, 0.05, 0, 90, 0.4}, {12000, 0.1, 0, 45, 0.5}}) {
    const double border = glm::radians(spot.cone / 2), edge = std::cos(border);
    Lamp lamp;
    lamp.type = LampType::disk;
    // Its size smears the edge of the cone, here as in Blender; the formula has none.
    lamp.radius = spot.radius / 30;
    lamp.normalize = true, lamp.intensity = spot.watts / (4 * kPi);
    lamp.has_cone = lamp.cone_by_cosine = true, lamp.cone_angle = spot.cone / 2;
    lamp.cone_softness = 1 - std::acos(edge + (1 - edge) * spot.blend) / border;
    const auto source = make_source(lamp, kCamera, 0);
    for (const double off : {0.0, 0.3, 0.6, 0.85, 0.95}) {
      const double c = std::cos(off * border), d = 6;
      const glm::dvec3 to(std::sin(off * border), 0, -c);  // it looks along -z
      const double t = std::clamp((c - edge) / ((1 - edge) * spot.blend), 0.0, 1.0);
      const double formula = spot.watts * c * t * t * (3 - 2 * t) / (4 * kPi * kPi * d * d);
      const double facing = spot.watts / (4 * kPi * kPi * d * d);
      EXPECT_NEAR(source->unoccluded(glm::vec3(to * d), glm::vec3(-to)).x, formula, 1e-3 * facing)
          << spot.cone << " " << off;
    }
  }
}

TEST(BlenderLamps, OfAnAreaAreRectangles) {
  for (const BlenderLamp& area :
       {BlenderLamp{60, 0.9, 0.5, 0, 0}, {160, 1.6, 0.9, 0, 0}, {2500, 5, 2.5, 0, 0}}) {
    Lamp lamp;
    lamp.type = LampType::rect;
    lamp.width = area.radius, lamp.height = area.height;
    lamp.normalize = true, lamp.intensity = area.watts / 4;
    const glm::vec3 position(0.4f, -0.7f, -2.2f), normal(0, 0.6f, 0.8f);
    const double formula = area.watts / (4 * area.radius * area.height) *
                           slow_sum(lamp, glm::dvec3(position), glm::dvec3(normal), 800);
    EXPECT_NEAR(make_source(lamp, kCamera, 0)->unoccluded(position, normal).x / formula, 1, 1e-3);
  }
}

}  // namespace
}  // namespace ssdo::test::lamp_light_test
