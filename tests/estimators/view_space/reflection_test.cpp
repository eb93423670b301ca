// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "estimators/gtao.h"
#include "estimators/obscurance_request.h"
#include "estimators/view_space/reflection_occlusion.h"

namespace ssdo::test::reflection_test {
namespace {

constexpr double kPi = std::numbers::pi;
const Window kWindow{0, 0, 48, 36};

/// Solid angle of the overlap in double, from the angles of both cones and the angle between their
/// axes.
double slow_overlap(double length, double between, double roughness, double strength) {
  const double reflection = std::max(roughness, 0.1) * kPi, open = length * kPi * strength;
  const double difference = std::abs(reflection - open);
  const double t = (between - difference) / (reflection + open - difference);
  const double share = slow_smoothstep(0, 1, 1 - std::min(std::max(t, 0.0), 1.0));
  const double opened = std::min(std::max((open - 0.1) / 0.2, 0.0), 1.0);
  return share * opened * 2 * kPi * (1 - std::cos(std::min(reflection, open)));
}

/// Of that, the part that an open surface has too: its normal is so far from what is mirrored.
double slow_occlusion(double length, double between, double from_normal, double roughness,
                      double strength) {
  const double of_open = slow_overlap(1, from_normal, roughness, strength);
  if (of_open == 0) return 0;
  return std::min(slow_overlap(length, between, roughness, strength) / of_open, 1.0);
}

glm::vec3 at_angle(double angle) { return {float(std::sin(angle)), 0, float(std::cos(angle))}; }

/// Reflections of a frame whose bent normals are given.
Plane<float> reflect(const Geometry& g, const Plane<glm::vec3>& bent, double roughness,
                     const Plane<float>* layer = nullptr, double strength = 0.5) {
  Scene scene = scene_of(g);
  if (layer) scene.roughness = *layer;
  const Request request{
      .products = {.reflection = true}, .radius = 1, .parameters = {{"roughness", roughness}}};
  return reflection_occlusion(scene, request, make_view_planes(g), bent, float(strength));
}

/// A pixel of which both cones are known: between their axes lies an angle up to half a turn.
struct Cones {
  double length, between, roughness;
};

/// Parallel views of surfaces that mirror the direction at `between`; bent normals point at the
/// viewer.
Plane<float> reflect_cones(const std::vector<Cones>& pixels, double strength) {
  const int width = int(pixels.size());
  Geometry g;
  g.window = g.display = {0, 0, width, 1};
  g.camera = camera_from_ortho_width(width, g.display, 1);
  g.surfaces = Surfaces(width, 1);
  Plane<glm::vec3> bent(width, 1);
  Plane<float> roughness(width, 1);
  for (int x = 0; x < width; ++x) {
    const Cones& of = pixels[std::size_t(x)];
    g.surfaces.set(x, 0, {{float(x), 0, -1}, at_angle(of.between / 2), 0});
    bent(x, 0) = glm::vec3(0, 0, float(of.length));
    roughness(x, 0) = float(of.roughness);
  }
  return reflect(g, bent, 0, &roughness, strength);
}

TEST(Reflection, ConesMeetAsInDouble) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  int partly = 0;
  for (int row = 0; row < 200; ++row) {
    const double strength = 0.05 + 0.95 * share(random);
    std::vector<Cones> pixels;
    for (int i = 0; i < 101; ++i)
      pixels.push_back({0.03 + 0.97 * share(random), 0.998 * kPi * share(random), share(random)});
    const Plane<float> found = reflect_cones(pixels, strength);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Cones& of = pixels[i];
      const double expected =
          slow_occlusion(of.length, of.between, of.between / 2, of.roughness, strength);
      ASSERT_NEAR(found[i], expected, 5e-4)
          << of.length << " " << of.between << " " << of.roughness << " " << strength;
      partly += expected > 0.01 && expected < 0.99;
    }
  }
  EXPECT_GT(partly, 5000);
}

/// The same of one pixel.
float reflect_one(double length, double between, double roughness) {
  return reflect_cones({{length, between, roughness}}, 0.5)[0];
}

TEST(Reflection, OneWhereAConeIsInsideTheOtherZeroWhereTheyDoNotTouch) {
  // A hemisphere of sky and a specular cone of 18 degrees about its edge: inside to 72 degrees,
  // outside from 108 on, half way at 90.
  EXPECT_EQ(reflect_one(1, kPi * 71 / 180, 0), 1);
  EXPECT_NEAR(reflect_one(1, kPi / 2, 0), 0.5, 1e-5);
  EXPECT_EQ(reflect_one(1, kPi * 109 / 180, 0), 0);
  EXPECT_EQ(reflect_one(1, kPi * 71 / 180, 0.1), 1) << "no cone is narrower than that of 0.1";
}

TEST(Reflection, TheLengthOfTheBentNormalDecides) {
  EXPECT_EQ(reflect_one(0, 0.4, 0.5), 0) << "all is closed";
  // A visible cone of 0.1 radians is closed, one of 0.3 is fully counted: by its solid angle.
  const auto share = [](double angle, double of) {
    return (1 - std::cos(angle)) / (1 - std::cos(of));
  };
  EXPECT_EQ(reflect_one(0.0999 / (kPi / 2), 0, 0.1), 0);
  EXPECT_NEAR(reflect_one(0.2 / (kPi / 2), 0, 0.1), 0.5 * share(0.2, 0.1 * kPi), 1e-5);
  EXPECT_NEAR(reflect_one(0.3001 / (kPi / 2), 0, 0.1), share(0.3001, 0.1 * kPi), 1e-5);
  EXPECT_NEAR(reflect_one(0.5, 0, 0.4), share(kPi / 4, 0.4 * kPi), 1e-5);
}

TEST(Reflection, VectorsGiveWhatOneLaneGives) {
  const Geometry g =
      geometry_of(room_with_a_ball(), tilted(camera_from_fov(60, kWindow, 1), 50), kWindow);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> share(0, 1);
  Plane<glm::vec3> bent(48, 36);
  Plane<float> layer(48, 36);
  for (std::size_t i = 0; i < bent.size(); ++i) {
    bent[i] = share(random) * g.surfaces[i].normal;
    layer[i] = share(random);
  }
  expect_the_same_from_every_isa([&] { return reflect(g, bent, 0, &layer); });
  expect_the_same_from_any_threads([&] { return reflect(g, bent, 0, &layer); });
}

TEST(Reflection, EveryPixelMirrorsItsOwnRay) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(room_with_a_ball(), tilted(projection, 50), kWindow);
    const glm::vec3 up(0.6f, 0, 0.48f);
    const Plane<float> found = reflect(g, Plane<glm::vec3>(48, 36, up), 0.3);
    double least = 1, most = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const glm::dvec3 p(g.surfaces[i].position), n(g.surfaces[i].normal);
      const glm::dvec3 from_viewer =
          g.camera.orthographic ? glm::dvec3(0, 0, -1) : p / std::sqrt(glm::dot(p, p));
      const glm::dvec3 r = from_viewer - 2 * glm::dot(from_viewer, n) * n, b(up);
      const double length = std::sqrt(glm::dot(b, b));
      const double expected = slow_occlusion(length, std::acos(glm::dot(b, r) / length),
                                             std::acos(glm::dot(n, r)), 0.3, 0.5);
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
  g.surfaces.normal[0](24, 18) = NAN;
  g.surfaces.position[2](25, 18) = NAN;
  const Plane<float> found = reflect(g, Plane<glm::vec3>(48, 36), 0.5);
  EXPECT_EQ(found(0, 0), 1);
  EXPECT_EQ(found(24, 18), 1);
  EXPECT_EQ(found(25, 18), 1);
  EXPECT_EQ(found(24, 16), 0);
}

/// What gtao makes of a frame.
Products reflected_by_gtao(const Geometry& g, const std::vector<std::string>& set,
                           ProductSet products) {
  return gtao_method().estimate(
      scene_of(g),
      {.products = products, .radius = 2, .parameters = resolve_parameters(gtao_method(), set)},
      {});
}

TEST(Reflection, GtaoTakesItsBentNormalBeforeItIsMadeUnit) {
  const Geometry g =
      geometry_of(still_life(), tilted(camera_from_fov(50, kWindow, 1), 50), kWindow);
  const Products three =
      reflected_by_gtao(g, {"slices=3", "roughness=0.2"}, {.bent = true, .reflection = true});
  const Plane<float> of_unit = reflect(g, three.bent, 0.2);
  int narrower = 0;
  for (std::size_t i = 0; i < of_unit.size(); ++i)
    narrower += three.reflection[i] < of_unit[i] - 0.02f;
  EXPECT_GT(narrower, 50);
  // Whoever asks for nothing else gets nothing else.
  const Products alone = reflected_by_gtao(g, {"slices=3", "roughness=0.2"}, {.reflection = true});
  EXPECT_EQ(alone.reflection.pixels, three.reflection.pixels);
  EXPECT_TRUE(alone.bent.empty() && alone.direct.empty());
}

TEST(Reflection, AnOpenPlaneMirrorsAllFromAnyElevation) {
  for (const Camera& projection :
       {camera_from_fov(20, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    for (const double elevation : {90.0, 45.0, 30.0, 20.0, 11.0}) {
      const Geometry g =
          geometry_of(plane({}, {0, 0, 1}), tilted(projection, 90 - elevation), kWindow);
      for (const char* roughness : {"roughness=0", "roughness=0.2", "roughness=1"}) {
        for (const float open :
             reflected_by_gtao(g, {roughness}, {.reflection = true}).reflection.pixels)
          ASSERT_NEAR(open, 1, 1e-4) << elevation << " " << roughness;
      }
    }
  }
}

TEST(Reflection, NothingThatComesInMakesANaN) {
  for (const char* roughness : {"roughness=0", "roughness=1"}) {
    const Products out = reflected_by_gtao(broken_geometry(), {roughness}, {.reflection = true});
    for (const float open : out.reflection.pixels) EXPECT_TRUE(open >= 0 && open <= 1) << open;
  }
}

}  // namespace
}  // namespace ssdo::test::reflection_test
