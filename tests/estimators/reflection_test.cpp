// SPDX-License-Identifier: Apache-2.0
//
// Reflection occlusion: the overlap of cones, and the product that gtao makes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "estimators/gtao.h"
#include "estimators/obscurance_request.h"
#include "estimators/reflection_occlusion.h"
#include "filters/geometry_filter.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 96, 72};

/// The formula in double as seed 002 prints it, with the strength 1/2 of the engine.
double slow_overlap(const glm::dvec3& bent, const glm::dvec3& mirrored, double roughness) {
  const double length = glm::length(bent), cone = std::max(roughness, 0.1) * glm::pi<double>(),
               open = length * glm::pi<double>() * 0.5;
  const double cosine = glm::dot(bent, mirrored) / std::max(length, 0.001),
               between = std::acos(std::clamp(cosine, -1.0, 1.0));
  const double difference = std::abs(cone - open);
  const double x = 1 - std::clamp((between - difference) / (cone + open - difference), 0.0, 1.0);
  return slow_smoothstep(0, 1, x) * std::clamp((open - 0.1) / 0.2, 0.0, 1.0);
}

glm::dvec3 direction(std::mt19937& random) {
  std::normal_distribution<double> number;
  return glm::normalize(glm::dvec3(number(random), number(random), number(random)));
}

TEST(ReflectionOcclusion, IsTheSeedsFormula) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  int between = 0;
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 bent = direction(random) * (0.001 + share(random) * 0.999),
                     mirrored = direction(random);
    const double roughness = share(random), expected = slow_overlap(bent, mirrored, roughness);
    EXPECT_NEAR(reflection_occlusion(bent, mirrored, float(roughness)), expected, 1e-5);
    between += expected > 0.05 && expected < 0.95;
  }
  EXPECT_GT(between, 3000);
}

TEST(ReflectionOcclusion, KnownCones) {
  const glm::vec3 up(0, 0, 1), side(1, 0, 0);
  // One cone in the other.
  EXPECT_EQ(reflection_occlusion(up, up, 0), 1);
  // A half-ball and a half-ball a right angle apart: half way.
  EXPECT_NEAR(reflection_occlusion(up, side, 0.5f), 0.5f, 1e-6);
  // Beyond each other.
  EXPECT_EQ(reflection_occlusion(up, -up, 0.25f), 0);
  EXPECT_EQ(reflection_occlusion(glm::vec3(0), up, 0.5f), 0);
  EXPECT_EQ(reflection_occlusion(up * 0.06f, up, 0.5f), 0) << "too narrow to be sure of";
}

Products reflect(const Geometry& g, double roughness) {
  ParameterValues parameters = resolve_parameters(gtao_method(), {});
  parameters["roughness"] = roughness;
  const Plane<glm::vec3> none;
  const Environment sky = Environment::constant(glm::vec3(1));
  return gtao_method().estimate(
      {g, none, none, sky, {.reflection = true}, 2, 0, 0, parameters, {}});
}

Geometry room(const Camera& projection) {
  return geometry_of(still_life(), look_at(projection, {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
                     kWindow);
}

/// Of one slice the bent normal has unit length, so that bent tells it.
TEST(Reflection, OfGtaoIsTheOverlapOfItsBentNormal) {
  for (const Camera& projection :
       {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(4, kWindow, 1)}) {
    const Geometry g = room(projection);
    const ParameterValues parameters =
        resolve_parameters(gtao_method(), {"slices=1", "roughness=0.2"});
    const Plane<glm::vec3> none;
    const Environment sky = Environment::constant(glm::vec3(1));
    const Products out = gtao_method().estimate(
        {g, none, none, sky, {.bent = true, .reflection = true}, 2, 0, 0, parameters, {}});
    float least = 1;
    for (std::size_t i = 0; i < out.reflection.size(); ++i) {
      if (!g.is_surface(i)) {
        EXPECT_EQ(out.reflection[i], 1);
        continue;
      }
      const Surfel& s = g.surfel[i];
      const glm::dvec3 n(s.normal),
          in =
              g.camera.orthographic ? glm::dvec3(0, 0, -1) : glm::normalize(glm::dvec3(s.position)),
          mirrored = in - 2 * glm::dot(n, in) * n;
      EXPECT_NEAR(out.reflection[i], slow_overlap(out.bent[i], mirrored, 0.2), 1e-4);
      least = std::min(least, out.reflection[i]);
    }
    EXPECT_LT(least, 0.7f);
  }
}

TEST(Reflection, AnOpenPlaneThatFacesTheViewerMirrorsAll) {
  const Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_ortho_width(6, kWindow, 1), 0), kWindow);
  for (const double roughness : {0.0, 0.5, 1.0}) {
    for (const float open : reflect(g, roughness).reflection.pixels) EXPECT_NEAR(open, 1, 1e-4);
  }
}

TEST(Reflection, IsFilteredLikeAo) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1));
  Products noisy = reflect(g, 0.2);
  Products as_ao;
  as_ao.ao = noisy.reflection;
  EXPECT_NE(filter_geometry(noisy, g, 4).reflection.pixels, noisy.reflection.pixels);
  EXPECT_EQ(filter_geometry(noisy, g, 4).reflection.pixels, filter_geometry(as_ao, g, 4).ao.pixels);
}

TEST(Reflection, NothingThatComesInMakesANaN) {
  for (const double roughness : {0.0, 1.0}) {
    for (const float open : reflect(broken_geometry(), roughness).reflection.pixels)
      EXPECT_TRUE(open >= 0 && open <= 1) << open;
  }
}

}  // namespace
}  // namespace ssdo::test
