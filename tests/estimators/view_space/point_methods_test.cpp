// SPDX-License-Identifier: Apache-2.0
//
// What holds for all methods that sample points: the same result from every instruction set and any
// crop, and nothing but numbers out. See also hard/hard_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "estimators/view_space/point_method_request.h"
#include "parallel/tiles.h"
#include "support/crop.h"

namespace ssdo::test::point_methods_test {
namespace {

struct Case {
  std::string name, method;
  std::vector<std::string> set;
  float near = 0.1f;  ///< a radius that reaches less than 24 pixels far
};

class PointMethods : public testing::TestWithParam<Case> {
 protected:
  const Method& method() const { return find_method(GetParam().method); }
  Products estimate(const Geometry& g, float radius, bool direct = false) const {
    return run(method(), g, {.radius = radius, .set = GetParam().set, .direct = direct});
  }
};

const Window kWindow{0, 0, 151, 97};

Geometry room(const Window& window = kWindow) {
  return geometry_of(room_with_a_ball(), tilted(camera_from_fov(50, window, 1), 55), window);
}

TEST_P(PointMethods, VectorsGiveWhatOneLaneGives) {
  if (!has_isa("scalar")) GTEST_SKIP() << "a build for one instruction set";
  const Geometry g = room();
  const auto ao = [&](const char* name) {
    const ChosenIsa isa(name);
    return estimate(g, 0.7f).ao;
  };
  const Plane<float> scalar = ao("scalar");
  int compared = 0;
  for (const char* name : kVectorIsas) {
    if (!has_isa(name)) continue;
    const Plane<float> vector = ao(name);
    expect_close(
        vector, [&](int x, int y) { return scalar(x, y); }, 1e-5, 0.003);
    ++compared;
  }
  if (compared == 0) fmt::print("this machine has no vectors to compare\n");
}

TEST_P(PointMethods, ACropDoesNotChangeABit) {
  const Geometry whole = room();
  const Products all = estimate(whole, GetParam().near);
  for (const Window window :
       {Window{13, 7, 151, 97}, Window{0, 0, 138, 90}, Window{6, 5, 133, 91}}) {
    const Products cropped = estimate(crop(whole, window), GetParam().near);
    // Farther from the border than any sample of ssao-fade reaches: five radii.
    const int margin = 24;
    double darkest = 1;
    for (int y = margin; y < window.height() - margin; ++y) {
      for (int x = margin; x < window.width() - margin; ++x) {
        EXPECT_EQ(cropped.ao(x, y), all.ao(x + window.x0, y + window.y0)) << x << ", " << y;
        darkest = std::min(darkest, double(cropped.ao(x, y)));
      }
    }
    EXPECT_LT(darkest, 0.96);
  }
}

TEST_P(PointMethods, BrokenPixelsNeitherComeOutNorSpread) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  Geometry g = room();
  const float odd[] = {nan, infinity, -infinity, 0, 1e-40f, 1e38f, -1e38f, -1e-30f};
  for (std::size_t i = 0; i < g.surfaces.size(); i += 7) {
    Surfel s = g.surfaces[i];
    const float value = odd[(i / 7) % 8];
    switch ((i / 56) % 8) {
      case 0:
        s.position.x = value;
        break;
      case 1:
        s.position.z = value;
        break;
      case 2:
        s.normal.y = value;
        break;
      case 3:
        s.normal = glm::vec3(0), s.rounding = 0;
        break;
      case 4:
        s.position = glm::vec3(value), s.rounding = 0;
        break;
      case 5:
        s.rounding = value;
        break;
      case 6:
        s.rounding = Surfel::kBackground;
        break;
      default:
        s.normal = glm::vec3(0, 0, -1), s.rounding = 0;
        break;
    }
    g.surfaces.set(i, s);
  }
  const Products out = estimate(g, 0.7f, true);
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    EXPECT_TRUE(out.ao[i] >= 0 && out.ao[i] <= 1) << i << ": " << out.ao[i];
    EXPECT_TRUE(std::isfinite(out.direct[i].x));
    if (!g.surfaces[i].is_surface()) {
      EXPECT_EQ(out.ao[i], 1);
      EXPECT_EQ(out.direct[i], glm::vec3(0));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PointMethods,
                         testing::Values(Case{"ssao", "ssao", {}},
                                         Case{"ssao_range", "ssao-range", {}},
                                         Case{"fade_every_pixel", "ssao-fade", {"upsampling=0"}},
                                         Case{"fade_bilinear", "ssao-fade", {}},
                                         Case{"fade_along_surfaces", "ssao-fade", {"upsampling=2"}},
                                         Case{"ssdo", "ssdo", {}, 0.4f},
                                         Case{"hbao", "hbao", {}, 0.9f},
                                         Case{"gtao", "gtao", {"steps=12"}},
                                         Case{"gtao_thin", "gtao", {"steps=12", "thickness=0.7"}}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace ssdo::test::point_methods_test
