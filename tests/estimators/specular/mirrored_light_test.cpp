// SPDX-License-Identifier: Apache-2.0
//
// The light that rough surfaces mirror without occluders, against sums in double.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "estimators/microfacets.h"
#include "estimators/specular/specular_scene.h"
#include "math/sobol.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo::test::mirrored_light_test {
namespace {

double smith(double cosine, double alpha) {
  return 2 * cosine / (cosine + std::sqrt(cosine * cosine + alpha * alpha * (1 - cosine * cosine)));
}

/// D G1 G1 / (4 n.v n.l) n.l times Schlick's F, in double.
double mirrored(const glm::dvec3& n, const glm::dvec3& v, const glm::dvec3& l, double alpha,
                double f0) {
  const double nv = glm::dot(n, v), nl = glm::dot(n, l);
  if (nl <= 0) return 0;
  const glm::dvec3 h = glm::normalize(v + l), across = glm::cross(n, h);
  const double nh = glm::dot(n, h), q = glm::dot(across, across) + alpha * alpha * nh * nh;
  const double rise = std::pow(1 - glm::dot(v, h), 5.0);
  return alpha * alpha / (kPi * q * q) * smith(nv, alpha) * smith(nl, alpha) / (4 * nv) *
         (f0 + (1 - f0) * rise);
}

/// Of a source, by very many of its points.
double mirrored_by_sum(const Source& source, const Surfel& s, double alpha, double f0) {
  constexpr int kPoints = 1 << 13;
  const glm::dvec3 viewer = -glm::normalize(glm::dvec3(s.position));
  double sum = 0;
  for (int k = 0; k < kPoints; ++k) {
    const SourcePoint point = source.sample(s.position, sobol_point(std::uint32_t(k), 91));
    sum += double(point.weight) *
           mirrored(glm::normalize(glm::dvec3(s.normal)), viewer, glm::dvec3(point.to), alpha, f0);
  }
  return kPi * double(source.irradiance.y) * sum / kPoints;
}

/// A disc that gives light to one side, of a radiance of 1.
struct Disc final : Source {
  glm::vec3 place, towards;
  float radius;

  Disc(const glm::vec3& at, const glm::vec3& to, float r) : place(at), towards(to), radius(r) {
    irradiance = glm::vec3(r * r);  // pi r^2 times the radiance, over pi
  }
  glm::vec3 point(const glm::vec2& u) const override {
    const glm::vec3 x = glm::normalize(glm::cross(towards, glm::vec3(0.3f, 0.5f, 0.8f))),
                    y = glm::cross(towards, x);
    const float r = radius * std::sqrt(u.x), turn = 2 * glm::pi<float>() * u.y;
    return place + r * (std::cos(turn) * x + std::sin(turn) * y);
  }
  SourcePoint seen(const glm::vec3& position, const glm::vec3& at) const override {
    const float distance = glm::distance(position, at);
    const glm::vec3 to = (at - position) / distance;
    return {to, distance, std::max(0.0f, -glm::dot(to, towards)) / (distance * distance)};
  }
  float received(const glm::vec3& position, const glm::vec3& normal) const override {
    const SourcePoint middle = seen(position, place);
    return middle.weight * std::max(0.0f, glm::dot(middle.to, normal));
  }
  SourceCone cone(const glm::vec3& position) const override {
    const SourcePoint middle = seen(position, place);
    return {middle.to, middle.distance, std::atan(radius / middle.distance)};
  }
};

/// How far off and how large what was found is over what is true, by its root mean square and by
/// the largest values.
struct Off {
  double rmse = 0, most = 0;
};
template <class Truth>
Off off(const Plane<glm::vec3>& found, const Truth& truth, int step = 5) {
  double square = 0, all = 0, most = 0, most_true = 0;
  for (int y = 0; y < kWindow.height(); y += step) {
    for (int x = 0; x < kWindow.width(); x += step) {
      const double is = double(found(x, y).y), should = truth(x, y);
      square += (is - should) * (is - should), all += should * should;
      most = std::max(most, is), most_true = std::max(most_true, should);
    }
  }
  EXPECT_GT(all, 0);
  return {std::sqrt(square / all), most / most_true};
}

TEST(MirroredLight, ReflectancesOfAnEvenLightAreThoseOfTheTruth) {
  // shared/truth/README.md: numerical integration, angles to the normal.
  struct Row {
    double roughness, degrees, share;
  };
  const Reflectances reflectances;
  for (const Row& row :
       {Row{0.2, 0, 0.998}, Row{0.2, 30, 0.998}, Row{0.2, 60, 0.996}, Row{0.2, 75, 0.985},
        Row{0.2, 85, 0.916}, Row{0.5, 0, 0.916}, Row{0.5, 30, 0.904}, Row{0.5, 60, 0.855},
        Row{0.5, 75, 0.828}, Row{0.5, 85, 0.859}}) {
    const glm::vec2 sums =
        reflectances(float(std::cos(glm::radians(row.degrees))), float(row.roughness));
    EXPECT_NEAR(sums.x + sums.y, row.share, 1.5e-3) << row.roughness << " " << row.degrees;
  }
}

TEST(MirroredLight, AnOpenPlaneMirrorsAnEvenLightByItsReflectance) {
  const Reflectances reflectances;
  for (const double tilt : {0.0, 40.0, 70.0}) {
    const Scene scene = scene_of(floor_seen_at(tilt));
    for (const double roughness : {0.2, 0.47}) {
      for (const double ior : {kMirror, 1.5}) {
        const float f0 = float(std::pow((ior - 1) / (ior + 1), 2));
        for (const char* method : {"bitmask", "trace"}) {
          const Plane<glm::vec3> found = specular_of(method, scene, roughness, ior);
          for (std::size_t i = 0; i < found.size(); i += 37) {
            const Surfel& s = scene.geometry.surfaces[i];
            const float cosine = -glm::dot(glm::normalize(s.position), s.normal);
            const glm::vec2 sums = reflectances(cosine, float(roughness));
            ASSERT_NEAR(found[i].y, f0 * sums.x + sums.y, 2e-4) << method << " " << tilt;
          }
        }
      }
    }
  }
}

TEST(MirroredLight, FresnelIsSchlicks) {
  // The sums of the table by a double sum over directions.
  const Reflectances reflectances;
  for (const double degrees : {10.0, 55.0, 78.0}) {
    for (const double roughness : {0.45, 0.8}) {
      const double alpha = roughness * roughness, c = std::cos(glm::radians(degrees));
      const glm::dvec3 n(0, 0, 1), v(std::sqrt(1 - c * c), 0, c);
      double sum = 0;
      constexpr int kRings = 400, kTurns = 800;
      for (int i = 0; i < kRings; ++i) {
        const double z = (i + 0.5) / kRings, r = std::sqrt(1 - z * z);
        for (int k = 0; k < kTurns; ++k) {
          const double turn = 2 * kPi * (k + 0.5) / kTurns;
          sum += mirrored(n, v, {r * std::cos(turn), r * std::sin(turn), z}, alpha, 0.1);
        }
      }
      sum *= 2 * kPi / (double(kRings) * kTurns);
      const glm::vec2 found = reflectances(float(c), float(roughness));
      EXPECT_NEAR(0.1f * found.x + found.y, sum, 2e-3) << degrees << " " << roughness;
    }
  }
}

TEST(MirroredLight, SkyIsTheSumOverTheSky) {
  const auto radiance = [](const glm::vec3& d) {
    return glm::vec3(d.z > 0 ? 1 + d.z + 0.8f * std::sin(6 * d.x) : 0.2f);
  };
  for (const double tilt : {20.0, 65.0}) {
    Scene scene = scene_of(floor_seen_at(tilt), painted(radiance));
    ASSERT_TRUE(scene.light.sources.empty());
    for (const double roughness : {0.0, 0.3, 0.6}) {
      const Plane<glm::vec3> found = unoccluded(scene, roughness);
      const glm::dmat3 to_world = glm::transpose(glm::dmat3(scene.geometry.world_to_camera));
      const auto truth = [&](int x, int y) {
        const Surfel& s = scene.geometry.surfaces(x, y);
        const glm::dvec3 n(s.normal), v = -glm::normalize(glm::dvec3(s.position));
        const glm::dvec3 t = glm::normalize(glm::cross(n, glm::dvec3(0.1, 0.9, 0.2))),
                         b = glm::cross(n, t);
        double sum = 0;
        constexpr int kRays = 4096;
        for (int k = 0; k < kRays; ++k) {
          const glm::vec3 local(glm::dot(v, t), glm::dot(v, b), glm::dot(v, n));
          const FacetSample sample =
              mirror_at_facet(local, float(roughness), sobol_point(std::uint32_t(k), 5));
          const glm::dvec3 to(sample.to);
          const glm::vec3 world(to_world * (to.x * t + to.y * b + to.z * n));
          sum += double(sample.share * radiance(world).y) / kRays;
        }
        return sum;
      };
      const Off error = off(found, truth, 11);
      fmt::print("sky, seen at {} degrees, roughness {}: {:.4f}\n", tilt, roughness, error.rmse);
      EXPECT_LT(error.rmse, 0.03) << tilt << " " << roughness;
    }
  }
}

TEST(MirroredLight, HighlightsOfSourcesAreTheSumOverTheirPoints) {
  struct Case {
    double degrees;  ///< from which the floor is seen, to its normal
    double radius;   ///< of the source, 4 away
    double roughness, within;
  };
  for (const Case& c :
       {Case{10, 0.02, 0.2, 0.01}, Case{50, 0.02, 0.2, 0.01}, Case{80, 0.02, 0.2, 0.02},
        Case{80, 0.02, 0.5, 0.01}, Case{10, 0.35, 0.2, 0.03}, Case{50, 0.35, 0.5, 0.03},
        Case{80, 0.35, 0.5, 0.1}, Case{10, 1.5, 0.3, 0.05}, Case{50, 1.5, 0.3, 0.08},
        Case{50, 1.5, 0.6, 0.04}}) {
    Scene scene = scene_of(floor_seen_at(c.degrees), Environment::constant(glm::vec3(0)));
    // Where a mirror in the middle of the floor shows it.
    const Surfel& s = scene.geometry.surfaces(kWindow.width() / 2, kWindow.height() / 2);
    const glm::vec3 to = glm::reflect(glm::normalize(s.position), s.normal);
    scene.light.sources = {
        std::make_shared<const Disc>(s.position + 4.0f * to, -to, float(c.radius))};
    const double alpha = c.roughness * c.roughness;
    const Off error = off(
        unoccluded(scene, c.roughness, 1.5),
        [&](int x, int y) {
          return mirrored_by_sum(*scene.light.sources[0], scene.geometry.surfaces(x, y), alpha,
                                 0.04);
        },
        7);
    fmt::print("disc of {}, seen at {} degrees, roughness {}: RMSE {:.4f}, largest {:.3f}\n",
               c.radius, c.degrees, c.roughness, error.rmse, error.most);
    EXPECT_LT(error.rmse, c.within) << c.radius << " " << c.degrees << " " << c.roughness;
    EXPECT_LT(error.most, 1.05);
  }
}

TEST(MirroredLight, HighlightsOfWideLampsAtGrazingViewsAreTheSumOverTheirPoints) {
  struct Case {
    const char* shape;
    double roughness, within;
  };
  for (const Case& c :
       {Case{"rect", 0.2, 0.07}, Case{"rect", 0.35, 0.04}, Case{"rect", 0.5, 0.02},
        Case{"sphere", 0.2, 0.13}, Case{"sphere", 0.35, 0.05}, Case{"sphere", 0.5, 0.03}}) {
    Scene scene = scene_of(floor_seen_at(80), Environment::constant(glm::vec3(0)));
    const Surfel& s = scene.geometry.surfaces(kWindow.width() / 2, kWindow.height() / 2);
    const glm::vec3 to = glm::reflect(glm::normalize(s.position), s.normal);
    Lamp lamp;
    const bool is_rect = std::string(c.shape) == "rect";
    lamp.type = is_rect ? LampType::rect : LampType::sphere;
    // Twenty degrees wide.
    lamp.position = glm::dvec3(s.position + 4.0f * to);
    lamp.radius = 4 * std::sin(glm::radians(10.0));
    lamp.width = lamp.height = 8 * std::tan(glm::radians(10.0));
    lamp.axes[2] = glm::dvec3(to);
    lamp.axes[0] = glm::normalize(glm::cross(glm::dvec3(0.3, 1, 0.2), lamp.axes[2]));
    lamp.axes[1] = glm::cross(lamp.axes[2], lamp.axes[0]);
    scene.light.sources = {make_source(lamp, {}, 0)};
    const double alpha = c.roughness * c.roughness;
    const Off error = off(
        unoccluded(scene, c.roughness, 1.5),
        [&](int x, int y) {
          return mirrored_by_sum(*scene.light.sources[0], scene.geometry.surfaces(x, y), alpha,
                                 0.04);
        },
        7);
    fmt::print(
        "{} 20 degrees wide, seen at 80 degrees, roughness {}: RMSE {:.4f}, largest {:.3f}\n",
        c.shape, c.roughness, error.rmse, error.most);
    EXPECT_LT(error.rmse, c.within) << c.shape << " " << c.roughness;
    EXPECT_LT(error.most, 1.05) << c.shape << " " << c.roughness;
  }
}

}  // namespace
}  // namespace ssdo::test::mirrored_light_test
