// SPDX-License-Identifier: Apache-2.0
//
// The right-angled wedge, albedo 0.8, under a sky of 1: endless, direct + N bounces are 1/2, 0.7,
// 0.78, 0.812. A frame shows a piece of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"

namespace ssdo::test::wedge_test {
namespace {

const Window kWindow{0, 0, 480, 352};
constexpr int kBounces = 3;
using Levels = std::array<double, kBounces + 1>;  ///< after no bounce, one, two, three

Levels measured(const Geometry& g, bool extend) {
  Levels levels{};
  for (int n = 0; n <= kBounces; ++n) {
    const Products out = run(g, {.radius = kNoLimit,
                                 .products = {.ao = true, .direct = true},
                                 .slices = 4,
                                 .extend = extend,
                                 .albedo = 0.8f,
                                 .bounces = n});
    levels[std::size_t(n)] = middle(kWindow, [&](int x, int y) {
      return double(out.direct(x, y).x) + (n > 0 ? double(out.bounce(x, y).x) : 0);
    });
  }
  return levels;
}

/// The light on the piece that the frame shows, by rays between the nodes of a grid over the
/// picture, its values in between by linear interpolation.
class SlowWedge {
 public:
  SlowWedge(const Surface& scene, const Camera& camera) : scene_(scene), camera_(camera) {
    for (int y = 0; y <= kRows; ++y) {
      for (int x = 0; x <= kColumns; ++x) nodes_.push_back(look(point_of(pixel_of(x, y))));
    }
    std::vector<double> light(nodes_.size(), 0.0);
    for (Values& values : light_) {
      for (std::size_t i = 0; i < nodes_.size(); ++i) values.push_back(gathered(nodes_[i], light));
      light = values;
    }
  }

  /// At a pixel, after each bounce.
  Levels at(const glm::dvec2& pixel) const {
    const View view = look(point_of(pixel));
    Levels levels{};
    Values light(nodes_.size(), 0.0);
    for (int n = 0; n <= kBounces; ++n) {
      levels[std::size_t(n)] = gathered(view, light);
      light = light_[std::size_t(n)];
    }
    return levels;
  }

 private:
  static constexpr int kColumns = 25, kRows = 17, kRays = 4096;
  using Values = std::vector<double>;

  /// The share of the sky, and where in the picture each other ray ends.
  struct View {
    double sky = 0;
    std::vector<glm::dvec2> hits;
  };

  static glm::dvec2 pixel_of(int x, int y) {
    return {double(kWindow.width()) * x / kColumns, double(kWindow.height()) * y / kRows};
  }

  Point point_of(const glm::dvec2& pixel) const {
    const Ray ray = ray_through(camera_, pixel.x, pixel.y);
    const Hit hit = scene_(ray).value();
    return {ray.origin + hit.distance * ray.direction, hit.normal};
  }

  View look(const Point& p) const {
    View view;
    for_each_cosine_direction(p.normal, kRays, [&](const glm::dvec3& d) {
      const auto hit = scene_({p.position + 1e-7 * p.normal, d});
      const glm::dvec2 at =
          hit ? camera_.project(camera_.to_camera(p.position + hit->distance * d)) : glm::dvec2(-1);
      const bool shown =
          at.x >= 0 && at.y >= 0 && at.x <= kWindow.width() && at.y <= kWindow.height();
      if (shown)
        view.hits.push_back(at);
      else
        view.sky += 1.0 / kRays;
    });
    return view;
  }

  double gathered(const View& view, const Values& light) const {
    double sum = view.sky;
    for (const glm::dvec2& at : view.hits) {
      const double x = at.x / kWindow.width() * kColumns, y = at.y / kWindow.height() * kRows;
      const int x0 = std::min(int(x), kColumns - 1), y0 = std::min(int(y), kRows - 1);
      const double fx = x - x0, fy = y - y0;
      const auto node = [&](int i, int j) {
        return light[std::size_t((y0 + j) * (kColumns + 1) + x0 + i)];
      };
      sum += 0.8 / kRays *
             ((1 - fy) * ((1 - fx) * node(0, 0) + fx * node(1, 0)) +
              fy * ((1 - fx) * node(0, 1) + fx * node(1, 1)));
    }
    return sum;
  }

  const Surface& scene_;
  const Camera& camera_;
  std::vector<View> nodes_;
  std::array<Values, kBounces + 1> light_;
};

void print(const char* what, const Levels& levels) {
  fmt::print("wedge, {:<22} {:.4f} {:.4f} {:.4f} {:.4f}\n", what, levels[0], levels[1], levels[2],
             levels[3]);
}

TEST(BitmaskWedge, WhatTheFrameShowsIsWhatRaysGive) {
  const Surface scene = floor_and_wall();
  for (const double x : {0.15, 0.4}) {
    const Camera camera =
        tilted(camera_from_ortho_width(4, kWindow, 1), 45, 20, glm::dvec3(0, -x, 0));
    const Levels fast = measured(geometry_of(scene, camera, kWindow), false);
    const Levels slow =
        SlowWedge(scene, camera).at({kWindow.width() / 2.0, kWindow.height() / 2.0});
    print(fmt::format("x {}, by rays", x).c_str(), slow);
    print(fmt::format("x {}, frame open", x).c_str(), fast);
    for (std::size_t n = 0; n < fast.size(); ++n) EXPECT_NEAR(fast[n], slow[n], 5e-3) << n;
  }
}

TEST(BitmaskWedge, ContinuedBeyondTheFrameItIsEndless) {
  const Surface scene = floor_and_wall();
  const Levels endless = {0.5, 0.7, 0.78, 0.812};
  for (const Camera& projection :
       {camera_from_ortho_width(4, kWindow, 1), camera_from_fov(40, kWindow, 1)}) {
    const Camera camera = tilted(projection, 45, 5.5, {0, -0.15, 0});
    const Levels fast = measured(geometry_of(scene, camera, kWindow), true);
    print(camera.orthographic ? "continued, ortho" : "continued, persp", fast);
    for (std::size_t n = 0; n < fast.size(); ++n) EXPECT_NEAR(fast[n], endless[n], 3e-2) << n;
  }
}

}  // namespace
}  // namespace ssdo::test::wedge_test
