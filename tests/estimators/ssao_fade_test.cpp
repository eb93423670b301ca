// SPDX-License-Identifier: Apache-2.0
#include "estimators/ssao_fade.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimators/view_space/point_method_request.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 96, 72};
const std::vector<std::string> kEveryPixel = {"upsampling=0"};

/// The formula with the defaults, sample by sample, in double. Noise (column, row).
double slow_ssao_fade(const Geometry& g, int x, int y, int column, int row, double radius) {
  const Surfel& s = g.surfel(x, y);
  if (!s.is_surface()) return 1;
  const glm::dvec3 p(s.position), n(s.normal);
  const glm::dvec3 m(fade_noise(0)[std::size_t((row & 3) * 4 + (column & 3))]);
  double sum = 0;
  for (const glm::vec3& v : fade_offsets(0)) {
    const glm::dvec3 offset = glm::dvec3(v) - 2 * glm::dot(glm::dvec3(v), m) * m;
    const double flip = glm::dot(offset, n) < 0 ? -1 : 1;
    const glm::dvec3 q = p + flip * radius * offset;
    double z;
    if (!depth_at(g, q, z)) continue;
    const glm::dvec3 r = g.camera.orthographic ? glm::dvec3(q.x, q.y, z) : q * (z / q.z);
    const double distance = r.z - p.z;
    if (!(distance > 0.1 * radius + s.rounding)) continue;
    const double fade = std::min(std::max((2 * radius - distance) / (1.6 * radius), 0.0), 1.0);
    sum += std::max(glm::dot(n, glm::normalize(r - p)), 0.0) * fade;
  }
  return std::pow(1 - sum / 14, 2.0);
}

Geometry room(const Camera& projection, const Window& window = kWindow) {
  return geometry_of(room_with_a_ball(), tilted(projection, 55), window);
}

TEST(SsaoFade, OffsetsPointToCornersAndFacesOfACube) {
  glm::vec3 sum(0);
  for (const glm::vec3& v : fade_offsets(7)) {
    EXPECT_GE(glm::length(v), 0.25f);
    EXPECT_LE(glm::length(v), 1.0001f);
    const glm::vec3 a = glm::abs(glm::normalize(v));
    const float most = std::max({a.x, a.y, a.z});
    EXPECT_TRUE(std::abs(most - 1) < 1e-5 || std::abs(most - std::sqrt(1 / 3.0f)) < 1e-5);
    sum += glm::normalize(v);
  }
  EXPECT_LT(glm::length(sum), 1e-5);
}

TEST(SsaoFade, IsTheSlowEvaluation) {
  for (const Camera& projection :
       {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = room(projection);
    const Products out = run(ssao_fade_method(), g, {.radius = 0.8f, .set = kEveryPixel});
    expect_close(out.ao, [&](int x, int y) { return slow_ssao_fade(g, x, y, x, y, 0.8f); });
  }
}

TEST(SsaoFade, HalfResolutionIsTheSlowEvaluationUpsampled) {
  const Window odd{0, 0, 93, 71};
  const Geometry g = room(camera_from_fov(50, odd, 1), odd);
  const int columns = 47, rows = 36;
  Plane<double> half(columns, rows);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      half(x, y) = slow_ssao_fade(g, std::min(2 * x + 1, 92), std::min(2 * y + 1, 70), x, y, 0.8f);
    }
  }
  const auto at = [&](int x, int y) {
    return half(std::clamp(x, 0, columns - 1), std::clamp(y, 0, rows - 1));
  };
  const Products out = run(ssao_fade_method(), g, {.radius = 0.8f});
  expect_close(
      out.ao,
      [&](int x, int y) {
        // The place of the pixel's centre among the centres of 2 x 2 pixels.
        const double u = (x + 0.5) / 2 - 0.5, v = (y + 0.5) / 2 - 0.5;
        const int i = int(std::floor(u)), j = int(std::floor(v));
        const double a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) +
               b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
      },
      1e-4, 0.01);
}

TEST(SsaoFade, AnOpenPlaneThatFacesTheViewerReadsOne) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, 0), kWindow);
    for (const char* upsampling : {"upsampling=0", "upsampling=1", "upsampling=2"}) {
      for (const float ao : run(ssao_fade_method(), g, {.set = {upsampling}}).ao.pixels)
        EXPECT_EQ(ao, 1);
    }
  }
}

TEST(SsaoFade, WhatIsFartherInFrontThanTheFadeMakesNoHalo) {
  const auto darkest_behind = [](double depth) {
    const Geometry g = geometry_of(disc_before_a_plane(depth),
                                   tilted(camera_from_fov(40, kWindow, 1), 0), kWindow);
    const Products out = run(ssao_fade_method(), g, {.radius = 0.5f, .set = kEveryPixel});
    float least = 1;
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      if (g.surfel[i].position.z < -6.1f) least = std::min(least, out.ao[i]);
    }
    return least;
  };
  EXPECT_EQ(darkest_behind(1.01), 1);
  EXPECT_LT(darkest_behind(0.4), 0.8);
}

TEST(SsaoFade, PowerIsAPower) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1));
  const auto ao = [&](const char* power) {
    return run(ssao_fade_method(), g, {.set = {"upsampling=0", power}}).ao;
  };
  const Plane<float> access = ao("power=1"), squared = ao("power=2"), fourth = ao("power=4");
  for (std::size_t i = 0; i < access.size(); ++i) {
    EXPECT_NEAR(squared[i], std::pow(access[i], 2), 1e-6);
    EXPECT_NEAR(fourth[i], std::pow(access[i], 4), 1e-6);
  }
}

TEST(SsaoFade, TheEffectFadesWithDistance) {
  const Geometry g = room(camera_from_fov(50, kWindow, 1));
  const Plane<float> whole = run(ssao_fade_method(), g, {.set = kEveryPixel}).ao;
  const Plane<float> faded =
      run(ssao_fade_method(), g,
          {.set = {"upsampling=0", "distance-start=5.5", "distance-end=6.5"}})
          .ao;
  int kept = 0, gone = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    const double left = std::clamp(6.5 + double(g.surfel[i].position.z), 0.0, 1.0);
    EXPECT_NEAR(1 - faded[i], left * (1 - whole[i]), 1e-6);
    kept += left == 1 && whole[i] < 0.9;
    gone += left == 0 && whole[i] < 0.9;
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(gone, 20);
}

}  // namespace
}  // namespace ssdo::test
