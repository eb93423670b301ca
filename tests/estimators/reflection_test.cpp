// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <numbers>
#include <random>

#include "estimators/gtao.h"
#include "estimators/obscurance_request.h"
#include "estimators/reflection_occlusion.h"

namespace ssdo::test {
namespace {

constexpr double kPi = std::numbers::pi;
const Window kWindow{0, 0, 48, 36};

/// The seed's formula in double, from the angles of both cones and the angle between their axes.
double slow_occlusion(double length, double between, double roughness, double strength) {
  const double reflection = std::max(roughness, 0.1) * kPi, open = length * kPi * strength;
  const double difference = std::abs(reflection - open);
  const double t = (between - difference) / (reflection + open - difference);
  const double overlap = slow_smoothstep(0, 1, 1 - std::min(std::max(t, 0.0), 1.0));
  return overlap * std::min(std::max((open - 0.1) / 0.2, 0.0), 1.0);
}

glm::vec3 at_angle(double angle) { return {float(std::sin(angle)), 0, float(std::cos(angle))}; }

TEST(Reflection, ConesMeetAsInTheSeed) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  int partly = 0;
  for (int i = 0; i < 20000; ++i) {
    const double length = 0.03 + 0.97 * share(random), between = kPi * share(random),
                 roughness = share(random), strength = 0.05 + 0.95 * share(random);
    const double expected = slow_occlusion(length, between, roughness, strength);
    const float found = reflection_occlusion(float(length) * at_angle(0.7), at_angle(0.7 + between),
                                             float(roughness), float(strength));
    ASSERT_NEAR(found, expected, 2e-4)
        << length << " " << between << " " << roughness << " " << strength;
    partly += expected > 0.01 && expected < 0.99;
  }
  EXPECT_GT(partly, 5000);
}

TEST(Reflection, OneWhereAConeIsInsideTheOtherZeroWhereTheyDoNotTouch) {
  const glm::vec3 n = at_angle(0);
  // A hemisphere of sky and a specular cone of 18 degrees about its edge: inside to 72 degrees,
  // outside from 108 on, half way at 90.
  EXPECT_EQ(reflection_occlusion(n, at_angle(kPi * 71 / 180), 0, 0.5f), 1);
  EXPECT_NEAR(reflection_occlusion(n, at_angle(kPi / 2), 0, 0.5f), 0.5, 1e-5);
  EXPECT_EQ(reflection_occlusion(n, at_angle(kPi * 109 / 180), 0, 0.5f), 0);
  EXPECT_EQ(reflection_occlusion(n, at_angle(kPi * 71 / 180), 0.1f, 0.5f), 1)
      << "no cone is narrower than that of roughness 0.1";
}

TEST(Reflection, TheLengthOfTheBentNormalDecides) {
  const glm::vec3 r = at_angle(0.4);
  EXPECT_EQ(reflection_occlusion(glm::vec3(0), r, 0.5f, 0.5f), 0) << "all is closed";
  // A visible cone of 0.1 radians is closed, one of 0.3 is fully counted.
  const auto of_angle = [](double angle) { return float(angle / (kPi / 2)) * at_angle(0); };
  EXPECT_EQ(reflection_occlusion(of_angle(0.0999), at_angle(0), 0.1f, 0.5f), 0);
  EXPECT_NEAR(reflection_occlusion(of_angle(0.2), at_angle(0), 0.1f, 0.5f), 0.5, 1e-5);
  EXPECT_NEAR(reflection_occlusion(of_angle(0.3001), at_angle(0), 0.1f, 0.5f), 1, 1e-5);
}

/// Reflections of a frame whose bent normals are given.
Plane<float> reflect(const Geometry& g, const Plane<glm::vec3>& bent, double roughness,
                     const Plane<float>* layer = nullptr) {
  const Plane<glm::vec3> none;
  const Environment sky = Environment::constant(glm::vec3(1));
  const ParameterValues parameters = {{"roughness", roughness}, {"reflection-strength", 0.5}};
  EstimateInput in{g, none, none, sky, {.reflection = true}, 1, 0, 0, parameters, {}};
  in.roughness = layer;
  return reflection_occlusion(in, bent);
}

TEST(Reflection, EveryPixelMirrorsItsOwnRay) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(room_with_a_ball(), tilted(projection, 50), kWindow);
    const glm::vec3 up(0.6f, 0, 0.48f);
    const Plane<float> found = reflect(g, Plane<glm::vec3>(48, 36, up), 0.3);
    double least = 1, most = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const glm::dvec3 p(g.surfel[i].position), n(g.surfel[i].normal);
      const glm::dvec3 from_viewer =
          g.camera.orthographic ? glm::dvec3(0, 0, -1) : p / std::sqrt(glm::dot(p, p));
      const glm::dvec3 r = from_viewer - 2 * glm::dot(from_viewer, n) * n, b(up);
      const double length = std::sqrt(glm::dot(b, b));
      const double expected = slow_occlusion(length, std::acos(glm::dot(b, r) / length), 0.3, 0.5);
      EXPECT_NEAR(found[i], g.is_surface(i) ? expected : 1, 2e-4) << i;
      least = std::min(least, expected), most = std::max(most, expected);
    }
    EXPECT_LT(least, 0.1);
    EXPECT_GT(most, 0.9);
  }
}

TEST(Reflection, ALayerOfRoughnessStandsInPlaceOfTheParameter) {
  const Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(60, kWindow, 1), 40), kWindow);
  const Plane<glm::vec3> bent(48, 36, glm::vec3(0, 0.5f, 0.2f));
  const Plane<float> rough = reflect(g, bent, 0.9), smooth = reflect(g, bent, 0.2);
  EXPECT_NE(rough.pixels, smooth.pixels);
  Plane<float> layer(48, 36, 0.2f);
  layer(7, 5) = 0.9f;
  const Plane<float> found = reflect(g, bent, 0.5, &layer), empty;
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i], i == found.index(7, 5) ? rough[i] : smooth[i]);
  EXPECT_EQ(reflect(g, bent, 0.9, &empty).pixels, rough.pixels);
}

TEST(Reflection, BackgroundAndWhatIsBrokenIsOpen) {
  Geometry g =
      geometry_of(sphere({0, 0, 0}, 1), tilted(camera_from_fov(60, kWindow, 1), 40), kWindow);
  g.surfel(24, 18).normal.x = NAN;
  g.surfel(25, 18).position.z = NAN;
  const Plane<float> found = reflect(g, Plane<glm::vec3>(48, 36), 0.5);
  EXPECT_EQ(found(0, 0), 1);
  EXPECT_EQ(found(24, 18), 1);
  EXPECT_EQ(found(25, 18), 1);
  EXPECT_EQ(found(24, 16), 0);
}

/// What gtao makes of a frame.
Products reflected_by_gtao(const Geometry& g, const std::vector<std::string>& set,
                           ProductSet products) {
  const ParameterValues parameters = resolve_parameters(gtao_method(), set);
  const Plane<glm::vec3> none;
  const Environment sky = Environment::constant(glm::vec3(1));
  return gtao_method().estimate({g, none, none, sky, products, 2, 0, 0, parameters, {}});
}

TEST(Reflection, GtaoTakesTheMeanOfItsSlicesBeforeItIsMadeUnit) {
  // At the foot of a wall the slices lean to different sides.
  const Geometry g =
      geometry_of(still_life(), tilted(camera_from_fov(50, kWindow, 1), 50), kWindow);
  const auto make = [&](const char* slices) {
    return reflected_by_gtao(g, {slices, "roughness=0.2"}, {.bent = true, .reflection = true});
  };
  const Products one = make("slices=1"), three = make("slices=3");
  const Plane<float> of_one = reflect(g, one.bent, 0.2), of_three = reflect(g, three.bent, 0.2);
  int narrower = 0;
  for (std::size_t i = 0; i < of_one.size(); ++i) {
    EXPECT_NEAR(one.reflection[i], of_one[i], 1e-4) << "of one slice it is unit from the start";
    narrower += three.reflection[i] < of_three[i] - 0.02f;
  }
  EXPECT_GT(narrower, 50);
  // Whoever asks for nothing else gets nothing else.
  const Products alone = reflected_by_gtao(g, {"slices=3", "roughness=0.2"}, {.reflection = true});
  EXPECT_EQ(alone.reflection.pixels, three.reflection.pixels);
  EXPECT_TRUE(alone.bent.empty() && alone.direct.empty());
}

TEST(Reflection, AnOpenPlaneThatFacesTheViewerMirrorsAll) {
  const Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_ortho_width(6, kWindow, 1), 0), kWindow);
  for (const char* roughness : {"roughness=0", "roughness=0.5", "roughness=1"}) {
    for (const float open :
         reflected_by_gtao(g, {roughness}, {.reflection = true}).reflection.pixels)
      EXPECT_NEAR(open, 1, 1e-4);
  }
}

TEST(Reflection, NothingThatComesInMakesANaN) {
  for (const char* roughness : {"roughness=0", "roughness=1"}) {
    const Products out = reflected_by_gtao(broken_geometry(), {roughness}, {.reflection = true});
    for (const float open : out.reflection.pixels) EXPECT_TRUE(open >= 0 && open <= 1) << open;
  }
}

}  // namespace
}  // namespace ssdo::test
