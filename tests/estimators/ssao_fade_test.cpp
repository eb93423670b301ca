// SPDX-License-Identifier: Apache-2.0
#include "estimators/ssao_fade.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimators/slow_ssao_fade.h"

namespace ssdo::test::ssao_fade_test {
namespace {

const Window kWindow{0, 0, 96, 72};
const std::vector<std::string> kEveryPixel = {"upsampling=0"};

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
  const Plane<double> half = slow_half_map(g, 0.8f);
  const Products out = run(ssao_fade_method(), g, {.radius = 0.8f});
  expect_close(
      out.ao, [&](int x, int y) { return slow_bilinear(half, x, y); }, 1e-4, 0.01);
}

/// Each upsampling has the filter before it; without upsampling there is no map to filter.
TEST(SsaoFade, TheMapAtHalfResolutionIsFilteredBeforeItGoesUp) {
  const Window odd{0, 0, 93, 71};
  const Geometry g = room(camera_from_fov(50, odd, 1), odd);
  int calls = 0;
  const auto filter = [&](Plane<float> map, const Surfaces& surfaces) {
    ++calls;
    EXPECT_EQ(map.width, 47);
    EXPECT_EQ(map.height, 36);
    for (int y = 0; y < map.height; ++y) {
      for (int x = 0; x < map.width; ++x) {
        const glm::ivec2 pixel = sampled_pixel(g, x, y);
        EXPECT_EQ(surfaces(x, y).position, g.surfaces(pixel.x, pixel.y).position);
        map(x, y) = 0.25f;
      }
    }
    return map;
  };
  const Method method = ssao_fade_method();
  for (const auto& [upsampling, filters] : {std::pair{0, false}, {1, true}, {2, true}}) {
    calls = 0;
    const Request request{
        .products = {.ao = true},
        .radius = 0.8f,
        .parameters = resolve_parameters(method, {"upsampling=" + std::to_string(upsampling)}),
        .filter_half = filter};
    const Plane<float> ao = method.estimate(scene_of(g), request, {}).ao;
    EXPECT_EQ(calls, int(filters)) << upsampling;
    const bool flat = std::ranges::all_of(ao.pixels, [](float a) { return a == 0.25f; });
    EXPECT_EQ(flat, filters) << upsampling;
  }
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
      if (g.surfaces[i].position.z < -6.1f) least = std::min(least, out.ao[i]);
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
    const double left = std::clamp(6.5 + double(g.surfaces[i].position.z), 0.0, 1.0);
    EXPECT_NEAR(1 - faded[i], left * (1 - whole[i]), 1e-6);
    kept += left == 1 && whole[i] < 0.9;
    gone += left == 0 && whole[i] < 0.9;
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(gone, 20);
}

}  // namespace
}  // namespace ssdo::test::ssao_fade_test
