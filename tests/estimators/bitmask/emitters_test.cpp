// SPDX-License-Identifier: Apache-2.0
//
// Small bright senders, which few steps of a march jump over: their light by rays of their own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "estimators/bitmask/request.h"

namespace ssdo::test::emitters_test {
namespace {

const Window kWindow{0, 0, 160, 96};

/// A glowing ball over a black floor.
struct Lamp {
  double radius, height;
  glm::vec3 color{1};

  glm::dvec3 centre() const { return {0, 0, height}; }
  bool shows(const glm::dvec3& p) const { return glm::distance(p, centre()) < 1.01 * radius; }

  /// Irradiance over pi, of a unit of radiance: exact where all of the ball is above the horizon.
  double light_at(const Point& p) const {
    const glm::dvec3 to = centre() - p.position;
    const double d2 = glm::dot(to, to);
    return radius * radius / d2 * glm::dot(to, p.normal) / std::sqrt(d2);
  }
};

/// A frame of things on a floor, with radiance sent where `lamps` are.
class LitFrame {
 public:
  LitFrame(std::vector<Lamp> lamps, const std::vector<Surface>& others = {},
           const Camera& projection = camera_from_fov(40, kWindow, 1))
      : lamps_(std::move(lamps)),
        camera_(look_at(projection, {0.5, -4.2, 2.4}, {0, 0, 0.3}, {0, 0, 1})) {
    std::vector<Surface> all = others;
    all.push_back(plane({}, {0, 0, 1}));
    for (const Lamp& lamp : lamps_) all.push_back(sphere(lamp.centre(), lamp.radius));
    scene_ = all_of(all);
    geometry_ = geometry_of(scene_, camera_, kWindow);
    solids_ = guess_solids(geometry_);
  }

  Products light(BitmaskRequest request) const {
    request.radius = kNoLimit, request.bounces = 1, request.solids = &solids_;
    request.radiance = {kWindow.width(), kWindow.height(), glm::vec3(0)};
    for_each_pixel([&](int x, int y, const Point& p) {
      for (const Lamp& lamp : lamps_)
        if (lamp.shows(p.position)) request.radiance(x, y) = lamp.color;
    });
    return run(geometry_, request);
  }

  /// Calls `visit(x, y, point)` for pixels that show something.
  template <class Visit>
  void for_each_pixel(const Visit& visit) const {
    for (int y = 0; y < kWindow.height(); ++y) {
      for (int x = 0; x < kWindow.width(); ++x) {
        if (geometry_.is_surface(geometry_.surfaces.index(x, y)))
          visit(x, y, point_at(scene_, camera_, kWindow, x, y));
      }
    }
  }

 private:
  std::vector<Lamp> lamps_;
  Camera camera_;
  Surface scene_;
  Geometry geometry_;
  Solids solids_;
};

/// The light of a lamp on the floor against what is exact: in the mean, and the deviation of
/// blocks of 8 x 8 pixels, which a filter averages, and of pixels.
struct LampError {
  double mean, of_blocks, of_pixels;
};

LampError lamp_error(const LitFrame& frame, const Lamp& lamp, const Products& out) {
  double found = 0, exact = 0, pixels = 0, count = 0;
  Plane<double> sums(kWindow.width() / 8, kWindow.height() / 8 + 1, 0.0), truths = sums;
  frame.for_each_pixel([&](int x, int y, const Point& p) {
    if (std::abs(p.position.z) > 1e-6) return;
    const double light = double(out.bounce(x, y).y), right = lamp.light_at(p);
    found += light, exact += right, count += 1;
    pixels += (light / right - 1) * (light / right - 1);
    sums(x / 8, y / 8) += light, truths(x / 8, y / 8) += right;
  });
  double blocks = 0, block_count = 0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (truths[i] <= 0) continue;
    blocks += (sums[i] / truths[i] - 1) * (sums[i] / truths[i] - 1), block_count += 1;
  }
  return {found / exact, std::sqrt(blocks / block_count), std::sqrt(pixels / count)};
}

TEST(Emitters, AGlowingBallLightsTheFloorWhateverItsSize) {
  // 29, 11 and 6 pixels wide, wherever its rim passes through pixels.
  for (const Lamp& lamp : {Lamp{0.3, 0.8}, Lamp{0.12, 0.5}, Lamp{0.06, 0.4}}) {
    double mean = 0;
    constexpr int kPlaces = 3;
    for (int place = 0; place < kPlaces; ++place) {
      Camera projection = camera_from_fov(40, kWindow, 1);
      projection.cx += 0.35 * place, projection.cy += 0.25 * place;
      const LitFrame frame({lamp}, {}, projection);
      const LampError e = lamp_error(frame, lamp, frame.light({.slices = 2, .steps = 16}));
      fmt::print("ball of radius {}: light {:.3f} of right, blocks off by {:.3f}, pixels {:.3f}\n",
                 lamp.radius, e.mean, e.of_blocks, e.of_pixels);
      EXPECT_NEAR(e.mean, 1, 0.1) << lamp.radius;
      EXPECT_LT(e.of_blocks, 0.16) << lamp.radius;
      mean += e.mean / kPlaces;
    }
    EXPECT_NEAR(mean, 1, 0.07) << lamp.radius;
  }
}

/// Mean green over the pixels of the floor for which `in(point)` holds.
template <class In>
double mean_on_floor(const LitFrame& frame, const Products& out, const In& in) {
  double sum = 0, count = 0;
  frame.for_each_pixel([&](int x, int y, const Point& p) {
    if (std::abs(p.position.z) > 1e-6 || !in(p.position)) return;
    sum += double(out.bounce(x, y).y), count += 1;
  });
  return sum / count;
}

TEST(Emitters, WhatStandsBeforeALampThrowsAShadow) {
  const Lamp lamp{0.06, 0.5};
  // A low wall between the lamp and the camera, which sees the lamp above it.
  const Surface wall = cut(plane({0, -0.5, 0}, {0, -1, 0}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 0.5 && p.z > 0 && p.z < 0.3;
  });
  const LitFrame frame({lamp}, {wall}), open({lamp});
  const BitmaskRequest request{.slices = 2, .steps = 16};
  const Products shadowed = frame.light(request), lit = open.light(request);
  const auto in_shadow = [](const glm::dvec3& p) {
    return p.y > -0.9 && p.y < -0.6 && std::abs(p.x) < 0.4;
  };
  const auto beside = [](const glm::dvec3& p) { return p.x > 1 && p.x < 1.5 && p.y < 0; };
  const double dark = mean_on_floor(frame, shadowed, in_shadow),
               bright = mean_on_floor(open, lit, in_shadow),
               light_beside = mean_on_floor(open, lit, beside);
  fmt::print("before a wall {:.5f}, without it {:.5f}\n", dark, bright);
  EXPECT_LT(dark, 0.03 * bright);
  EXPECT_NEAR(mean_on_floor(frame, shadowed, beside), light_beside, 0.03 * light_beside);
}

/// A sheet that sends light on a floor that sends none, which is cut by the lower border of the
/// frame at y = `border`, beside a wall.
struct SheetLight {
  double found, of_seen;  ///< light on the wall, and what the seen part of the sheet gives
};

SheetLight light_of_sheet(double border) {
  const Window window{0, 0, 160, 120};
  const double near = -0.6, far = -0.2, half = 0.4;  // of the sheet; the wall is at y = 0
  const Surface scene = floor_and_wall();
  // From above, so that the lower border is a line on the floor.
  Camera camera = look_at(camera_from_ortho_width(2, window, 1), {0, -4, 4}, {0, 0, 0}, {0, 0, 1});
  // Moves the picture so that its last row shows y = border.
  const auto y_at = [&](double py) {
    const Ray ray = ray_through(camera, 80, py);
    return (ray.origin - ray.direction * (ray.origin.z / ray.direction.z)).y;
  };
  const double per_row = y_at(1) - y_at(0);
  camera.cy -= (border - y_at(120)) / per_row;
  const Geometry g = geometry_of(scene, camera, window);
  Plane<glm::vec3> radiance(window.width(), window.height(), glm::vec3(0));
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) {
      const glm::dvec3 p = point_at(scene, camera, window, x, y).position;
      if (p.z < 1e-6 && p.y > near && p.y < far && std::abs(p.x) < half)
        radiance(x, y) = glm::vec3(1);
    }
  }
  const Products out =
      run(g, {.radius = kNoLimit, .slices = 4, .steps = 32, .bounces = 1, .radiance = radiance});
  SheetLight light{0, 0};
  const double seen_near = std::max(near, border);
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) {
      const Point p = point_at(scene, camera, window, x, y);
      if (p.position.z < 0.1 || p.position.z > 0.5 || std::abs(p.position.x) > 0.3) continue;
      light.found += double(out.bounce(x, y).y);
      constexpr int kParts = 16;
      if (seen_near >= far) continue;
      for (int i = 0; i < kParts * kParts; ++i) {
        const glm::dvec3 q((i % kParts + 0.5) / kParts * 2 * half - half,
                           seen_near + (i / kParts + 0.5) / kParts * (far - seen_near), 0);
        const glm::dvec3 to = q - p.position;
        const double d2 = glm::dot(to, to), area = 2 * half * (far - seen_near) / (kParts * kParts);
        light.of_seen +=
            std::max(0.0, glm::dot(to, p.normal)) * p.position.z / (kPi * d2 * d2) * area;
      }
    }
  }
  return light;
}

TEST(Emitters, ASheetThatTheBorderCutsSendsNoMoreThanWhatIsSeen) {
  const double whole = light_of_sheet(-0.8).found;
  for (const double border : {-0.8, -0.6, -0.5, -0.4, -0.3, -0.22}) {
    const SheetLight light = light_of_sheet(border);
    fmt::print("border at {}: light {:.3f}, of what is seen {:.3f}\n", border, light.found / whole,
               light.of_seen / whole);
    EXPECT_NEAR(light.found, light.of_seen, 0.08 * whole) << border;
  }
}

}  // namespace
}  // namespace ssdo::test::emitters_test
