// SPDX-License-Identifier: Apache-2.0
//
// Method trace on surfaces that nothing hides but themselves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimators/trace_request.h"
#include "scene/solids/solids.h"

namespace ssdo::test::convex_test {
namespace {

const Window kWindow{0, 0, 96, 72};

TEST(TraceConvex, ASphereIsOpenToItsSilhouette) {
  for (const bool orthographic : {false, true}) {
    const Camera camera =
        orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(40, kWindow, 1);
    const Geometry g = geometry_of(sphere({0.013, 0.021, 0}, 1), tilted(camera, 30), kWindow);
    for (const bool guessed : {false, true}) {
      const Solids solids = guessed ? guess_solids(g) : constant_thickness(g, kNoLimit);
      const Products out = run_trace(g, {.radius = kNoLimit, .samples = 256, .solids = &solids});
      const float least = *std::min_element(out.ao.pixels.begin(), out.ao.pixels.end());
      fmt::print("sphere: least ao {:.3f}\n", least);
      EXPECT_GE(least, 0.99f) << orthographic << " " << guessed;
    }
  }
}

/// What so many planes that touch the unit sphere enclose, with the sphere's normals.
Surface facets(int count) {
  std::vector<glm::dvec3> planes;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, turn = i * kPi * (3 - std::sqrt(5.0));
    planes.emplace_back(std::sqrt(1 - z * z) * glm::dvec2(std::cos(turn), std::sin(turn)), z);
  }
  return [planes](const Ray& ray) -> std::optional<Hit> {
    double enters = 0, leaves = 1e9;
    for (const glm::dvec3& n : planes) {
      const double facing = glm::dot(n, ray.direction), t = (1 - glm::dot(n, ray.origin)) / facing;
      (facing < 0 ? enters : leaves) = facing < 0 ? std::max(enters, t) : std::min(leaves, t);
    }
    if (enters == 0 || enters > leaves) return std::nullopt;
    return Hit{enters, glm::normalize(ray.origin + enters * ray.direction)};
  };
}

/// At the outline of facets smooth normals face away from the viewer.
TEST(TraceConvex, FacetsUnderSmoothNormalsAreOpen) {
  const Geometry g = geometry_of(facets(400), tilted(camera_from_fov(40, kWindow, 1), 30), kWindow);
  const Products out = run_trace(g, {.radius = kNoLimit, .samples = 256});
  double sum = 0, count = 0;
  float least = 1;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    if (!g.surfaces[i].is_surface()) continue;
    sum += double(out.ao[i]), count += 1, least = std::min(least, out.ao[i]);
  }
  fmt::print("facets: mean ao {:.4f}, least {:.3f} of {}\n", sum / count, least, count);
  EXPECT_GT(sum / count, 0.995);
  EXPECT_GT(least, 0.95f);
}

/// Normals that lean away from a plane: it hides what of their hemispheres is below it, half of
/// one minus the cosine, and nothing else.
TEST(TraceConvex, APlaneHidesWhatShadingNormalsSeeBelowIt) {
  Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(30, kWindow, 1), 72), kWindow);
  const glm::vec3 up = g.world_to_camera * glm::vec3(0, 0, 1);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const glm::vec3 bump(std::sin(0.4f * float(x)), std::sin(0.5f * float(y)), 0);
      g.surfaces.set_normal(g.surfaces.index(x, y),
                            g.world_to_camera * glm::normalize(glm::vec3(0, 0, 1) + 0.4f * bump));
    }
  }
  const Products out = run_trace(g, {.radius = kNoLimit, .samples = 256});
  double squares = 0, bias = 0;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    const double expected = 0.5 * (1 + double(glm::dot(g.surfaces[i].normal, up)));
    const double off = double(out.ao[i]) - expected;
    bias += off / double(out.ao.size()), squares += off * off / double(out.ao.size());
  }
  fmt::print("shading normals: bias {:+.5f}, RMS {:.4f}\n", bias, std::sqrt(squares));
  EXPECT_NEAR(bias, 0, 2e-3);
  EXPECT_LT(std::sqrt(squares), 0.02);
}

}  // namespace
}  // namespace ssdo::test::convex_test
