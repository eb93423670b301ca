// SPDX-License-Identifier: Apache-2.0
//
// Method trace on surfaces that nothing hides but themselves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimators/trace_request.h"
#include "scene/solids.h"

namespace ssdo::test {
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

/// Normals that lean away from a plane: it hides what of their hemispheres is below it, half of
/// one minus the cosine, and nothing else.
TEST(TraceConvex, APlaneHidesWhatShadingNormalsSeeBelowIt) {
  Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(30, kWindow, 1), 72), kWindow);
  const glm::vec3 up = g.world_to_camera * glm::vec3(0, 0, 1);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const glm::vec3 bump(std::sin(0.4f * float(x)), std::sin(0.5f * float(y)), 0);
      g.surfel(x, y).normal = g.world_to_camera * glm::normalize(glm::vec3(0, 0, 1) + 0.4f * bump);
    }
  }
  const Products out = run_trace(g, {.radius = kNoLimit, .samples = 256});
  double squares = 0, bias = 0;
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    const double expected = 0.5 * (1 + double(glm::dot(g.surfel[i].normal, up)));
    const double off = double(out.ao[i]) - expected;
    bias += off / double(out.ao.size()), squares += off * off / double(out.ao.size());
  }
  fmt::print("shading normals: bias {:+.5f}, RMS {:.4f}\n", bias, std::sqrt(squares));
  EXPECT_NEAR(bias, 0, 2e-3);
  EXPECT_LT(std::sqrt(squares), 0.02);
}

}  // namespace
}  // namespace ssdo::test
