// SPDX-License-Identifier: Apache-2.0
#include "estimators/ssao_range.h"

#include <gtest/gtest.h>

#include "estimators/view_space/point_method_request.h"
#include "estimators/view_space/slow_point_kernel.h"

namespace ssdo::test::ssao_range_test {
namespace {

const Window kWindow{0, 0, 96, 72};

struct Settings {
  double range = 1, bias = 0.05, strength = 1;
  std::vector<std::string> set() const {
    return {"range=" + std::to_string(range), "bias=" + std::to_string(bias),
            "strength=" + std::to_string(strength)};
  }
};

/// The formula, sample by sample, in double.
double slow_ssao_range(const Geometry& g, int x, int y, double radius, const Settings& settings) {
  const Surfel& s = g.surfaces(x, y);
  if (!s.is_surface()) return 1;
  const glm::dvec3 p(s.position), n(s.normal);
  const glm::dvec3 random(frame_noise(0)[std::size_t((y & 3) * 4 + (x & 3))]);
  const glm::dvec3 tangent = glm::normalize(random - n * glm::dot(random, n));
  const glm::dmat3 frame(tangent, glm::cross(n, tangent), n);
  double sum = 0;
  for (const glm::dvec3& v : slow_point_kernel(64, 0.01, false, 0)) {
    const glm::dvec3 turned = frame * v;
    double z;
    if (!depth_at(g, p + radius * turned, z)) continue;
    const double depth = -z, own = -p.z;
    const double in_range = std::abs(depth - own) > settings.range * radius ? 0 : 1;
    const double in_front = depth + settings.bias * radius + s.rounding < own ? 1 : 0;
    sum += slow_smoothstep(0, 0.2, std::hypot(turned.x, turned.y)) * in_range * in_front;
  }
  return std::max(0.0, 1 - settings.strength * sum / 64);
}

TEST(SsaoRange, IsTheSlowEvaluation) {
  for (const Camera& projection :
       {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const Geometry g = geometry_of(room_with_a_ball(), tilted(projection, 55), kWindow);
    for (const Settings& settings : {Settings{}, Settings{0.3, 0.01, 2.5}}) {
      const Products out = run(ssao_range_method(), g, {.radius = 0.8f, .set = settings.set()});
      expect_close(out.ao, [&](int x, int y) { return slow_ssao_range(g, x, y, 0.8f, settings); });
    }
  }
}

TEST(SsaoRange, AnOpenPlaneThatFacesTheViewerReadsOneAndOneThatDoesNotHidesItself) {
  for (const Camera& projection :
       {camera_from_fov(60, kWindow, 1), camera_from_ortho_width(6, kWindow, 1)}) {
    const auto ao = [&](double tilt) {
      return run(ssao_range_method(),
                 geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), kWindow), {})
          .ao;
    };
    for (const float value : ao(0).pixels) EXPECT_EQ(value, 1);
    // The known fault: what the nearer half of the plane shows is in front of p.
    const Plane<float> turned = ao(60);
    for (int y = 34; y < 38; ++y) {
      for (int x = 46; x < 50; ++x) EXPECT_LT(turned(x, y), 0.99);
    }
  }
}

TEST(SsaoRange, WhatIsFartherInFrontThanTheRangeMakesNoHalo) {
  const auto darkest_behind = [](double depth) {
    const Geometry g = geometry_of(disc_before_a_plane(depth),
                                   tilted(camera_from_fov(40, kWindow, 1), 0), kWindow);
    const Products out = run(ssao_range_method(), g, {.radius = 0.5f});
    float least = 1;
    for (std::size_t i = 0; i < out.ao.size(); ++i) {
      if (g.surfaces[i].position.z < -6.1f) least = std::min(least, out.ao[i]);
    }
    return least;
  };
  EXPECT_EQ(darkest_behind(0.52), 1);
  EXPECT_LT(darkest_behind(0.48), 0.8);
}

TEST(SsaoRange, StrengthScalesWhatIsTakenAway) {
  const Geometry g =
      geometry_of(room_with_a_ball(), tilted(camera_from_fov(50, kWindow, 1), 55), kWindow);
  const auto ao = [&](double strength) {
    return run(ssao_range_method(), g, {.set = Settings{.strength = strength}.set()}).ao;
  };
  const Plane<float> none = ao(0), half = ao(0.5), whole = ao(1), too_much = ao(10);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(none[i], 1);
    EXPECT_NEAR(1 - half[i], (1 - whole[i]) / 2, 1e-6);
    EXPECT_GE(too_much[i], 0);
  }
}

}  // namespace
}  // namespace ssdo::test::ssao_range_test
