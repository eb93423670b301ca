// SPDX-License-Identifier: Apache-2.0
//
// Shadows of suns and softboxes, as the tool makes them at standard quality with its filter,
// against rays in double to many points of the source.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "estimators/bitmask/request.h"
#include "filters/light_visibility.h"
#include "filters/registry.h"
#include "scene/light/painted_map.h"
#include "support/boxes.h"

namespace ssdo::test::shadows_test {
namespace {

const Window kWindow{0, 0, 480, 270};

/// A disc in a map that is black else, with an irradiance over pi of 1.
struct Disc {
  glm::dvec3 middle;
  float radius;  ///< degrees

  Environment map() const {
    const glm::vec3 to(middle);
    const float wide = radius < 2 ? 2048 : 512;
    const double omega = 2 * kPi * (1 - std::cos(glm::radians(double(radius))));
    return paint(
        int(wide),
        [&](const glm::vec3& d) { return glm::vec3(in_disc(d, to, radius) ? kPi / omega : 0); }, 2);
  }

  /// Points of equal light, on a spiral.
  std::vector<glm::dvec3> points(int count) const {
    const glm::dvec3 side = std::abs(middle.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 t = glm::normalize(glm::cross(side, middle)), b = glm::cross(middle, t);
    std::vector<glm::dvec3> out;
    for (int i = 0; i < count; ++i) {
      const double c = 1 - (i + 0.5) / count * (1 - std::cos(glm::radians(double(radius))));
      const double s = std::sqrt(1 - c * c), a = i * kPi * (3 - std::sqrt(5.0));
      out.push_back(c * middle + s * (std::cos(a) * t + std::sin(a) * b));
    }
    return out;
  }
};

Products lit(const Geometry& g, const Environment& map, unsigned seed = 0) {
  Scene scene = scene_of(g, map);
  scene.solids = guess_solids(g);
  Products out = bitmask_method().estimate(scene,
                                           {.products = {.ao = true, .direct = true},
                                            .radius = kNoLimit,
                                            .seed = seed,
                                            .slices = 2,
                                            .steps = 16},
                                           {});
  return filter_visibility(find_filter("geometry"), std::move(out), scene, 8);
}

/// The share of a disc's light that arrives at each pixel: as found, and by rays. -1 where the
/// surface turns away from it.
struct Shadows {
  Plane<double> found, exact;

  Shadows(const Surface& scene, const Camera& camera, const Disc& disc, int rays = 48)
      : found(kWindow.width(), kWindow.height(), -1), exact(found) {
    const Products out = lit(geometry_of(scene, camera, kWindow), disc.map());
    const std::vector<glm::dvec3> points = disc.points(rays);
    for (int y = 0; y < found.height; ++y) {
      for (int x = 0; x < found.width; ++x) {
        if (!scene(ray_through(camera, x + 0.5, y + 0.5))) continue;
        const Point p = point_at(scene, camera, kWindow, x, y);
        double arrives = 0, all = 0;
        for (const glm::dvec3& to : points) {
          const double cosine = std::max(0.0, glm::dot(p.normal, to)) / rays;
          all += cosine;
          if (cosine > 0 && is_open(scene, p, to, kNoLimit)) arrives += cosine;
        }
        if (all < 0.05) continue;
        found(x, y) = out.direct(x, y).x / all, exact(x, y) = arrives / all;
      }
    }
  }

  /// Mean light where there is none at all.
  double leak() const {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < exact.size(); ++i)
      if (exact[i] == 0) sum += found[i], count += 1;
    EXPECT_GT(count, 50) << "there is an umbra";
    return sum / count;
  }

  /// Share of the pixels that are off by more than a half though all pixels within two agree.
  double far_off() const {
    double off = 0, count = 0;
    for (int y = 2; y < exact.height - 2; ++y) {
      for (int x = 2; x < exact.width - 2; ++x) {
        if (exact(x, y) < 0) continue;
        bool even = true;
        for (int dy = -2; dy <= 2; ++dy)
          for (int dx = -2; dx <= 2; ++dx) even &= exact(x + dx, y + dy) == exact(x, y);
        count += 1;
        off += even && std::abs(found(x, y) - exact(x, y)) > 0.5;
      }
    }
    return off / count;
  }
};

Camera from_above() {
  return look_at(camera_from_fov(50, kWindow, 1), {0, -8, 4}, {0, 0, 0.5}, {0, 0, 1});
}
Surface ground() { return plane({}, {0, 0, 1}); }

TEST(BitmaskShadows, AWallsShadowEndsWhereItEnds) {
  const Surface scene = all_of({ground(), Box{{-2, 0, 0}, {2, 0.25, 1.6}}.surface()});
  const Shadows s(scene, from_above(), {glm::normalize(glm::dvec3(0.3, 0.8, 1)), 0.4f});
  fmt::print("wall: {:.4f} leaks, {:.4f} off\n", s.leak(), s.far_off());
  EXPECT_LT(s.leak(), 0.01);
  EXPECT_LT(s.far_off(), 0.002);
}

TEST(BitmaskShadows, BoxesThrowTheirs) {
  const Surface scene = all_of({ground(), Box{{-1.5, -0.5, 0}, {-0.5, 0.5, 1}}.surface(),
                                Box{{0.6, 0.2, 0}, {1.4, 1, 1.4}}.surface()});
  for (const double elevation : {30.0, 50.0}) {
    const double c = std::cos(glm::radians(elevation));
    const glm::dvec3 to(0.6 * c, 0.8 * c, std::sin(glm::radians(elevation)));
    const Shadows s(scene, from_above(), {to, 0.4f});
    fmt::print("boxes, {:.0f} degrees: {:.4f} leaks, {:.4f} off\n", elevation, s.leak(),
               s.far_off());
    EXPECT_LT(s.leak(), 0.012);
    // A box that shows two sides is about as deep as it is; with one depth for all of it, 0.0055.
    EXPECT_LT(s.far_off(), 0.002);
  }
}

TEST(BitmaskShadows, ThinPostsKeepTheirs) {
  // Half a pixel aside, so that the middle of the post is that of a column.
  const double pixel = 8.5 / from_above().fx, x = 0.5 * pixel;
  const Camera camera =
      look_at(camera_from_fov(50, kWindow, 1), {x, -8, 4}, {x, 0, 0.5}, {0, 0, 1});
  for (const bool aside : {false, true}) {
    const glm::dvec3 to = aside ? glm::dvec3(-1, -0.35, 0.62) : glm::dvec3(0.38, 0.92, 0.6);
    for (const int wide : {3, 6, 12}) {
      const Surface scene = all_of({ground(), post(0.5 * wide * pixel, 2.5)});
      const Shadows s(scene, camera, {glm::normalize(to), 0.27f});
      fmt::print("post of {} px: {:.3f} leaks, {:.4f} off\n", wide, s.leak(), s.far_off());
      EXPECT_LT(s.leak(), 0.05) << aside << " " << wide;
      EXPECT_LT(s.far_off(), 0.002) << aside << " " << wide;
    }
  }
}

TEST(BitmaskShadows, ThinPostsKeepTheirsUnderSunsAllAround) {
  const Camera camera = from_above();
  double sum = 0;
  for (int i = 0; i < 8; ++i) {
    const double around = glm::radians(22.5 + 45 * i), pixel = 8.5 / camera.fx;
    const glm::dvec3 to(std::cos(around), std::sin(around), 0.6);
    // Another place in its column each time.
    const Camera moved =
        look_at(camera, {0.125 * i * pixel, -8, 4}, {0.125 * i * pixel, 0, 0.5}, {0, 0, 1});
    const Shadows s(all_of({ground(), post(1.5 * pixel, 2.5)}), moved, {glm::normalize(to), 0.27f},
                    16);
    fmt::print("post of 3 px, sun at {:.1f} degrees: {:.3f} leaks\n", 22.5 + 45 * i, s.leak());
    // Each edge of the post may be off by half a pixel, and its umbra is one or two wide.
    EXPECT_LT(s.leak(), 0.1);
    sum += s.leak() / 8;
  }
  EXPECT_LT(sum, 0.05);
}

TEST(BitmaskShadows, SoftBoxesThrowSoftOnes) {
  const Surface scene = all_of({ground(), Box{{-1, -0.5, 0}, {0.6, 0.9, 1.2}}.surface()});
  const glm::dvec3 to = glm::normalize(glm::dvec3(0.25, 0.7, 0.75));
  for (const float radius : {5.5f, 10.0f, 20.0f}) {
    const Shadows s(scene, from_above(), {to, radius}, 128);
    double error = 0, squares = 0, count = 0;
    for (std::size_t i = 0; i < s.exact.size(); ++i) {
      if (s.exact[i] <= 0 || s.exact[i] >= 1) continue;
      error += s.found[i] - s.exact[i], count += 1;
      squares += (s.found[i] - s.exact[i]) * (s.found[i] - s.exact[i]);
    }
    fmt::print("disc of {} degrees: {:.4f} leaks, penumbra {:+.3f}, RMS {:.3f} of {:.0f} pixels\n",
               radius, s.leak(), error / count, std::sqrt(squares / count), count);
    EXPECT_LT(s.leak(), 0.01) << radius;
    EXPECT_LT(std::abs(error / count), 0.03) << radius;
    EXPECT_LT(std::sqrt(squares / count), 0.13) << radius;
  }
}

TEST(BitmaskShadows, AHillThrowsNoneAlongTheBorder) {
  const Surface hill = sphere({0, 2, -18.5}, 19);
  const Camera camera = look_at(camera_from_fov(50, kWindow, 1), {0, -9, 5}, {0, 0, 0}, {0, 0, 1});
  const Shadows s(hill, camera, {glm::normalize(glm::dvec3(1, 0.1, 0.45)), 0.4f}, 8);
  double lost = 0, count = 0, worst = 1;
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = kWindow.width() - 8; x < kWindow.width(); ++x) {
      if (s.exact(x, y) < 1) continue;
      lost += 1 - s.found(x, y), count += 1;
      worst = std::min(worst, s.found(x, y));
    }
  }
  fmt::print("hill: {:.4f} of the sun is lost along the border, least {:.3f}\n", lost / count,
             worst);
  ASSERT_GT(count, 500);
  EXPECT_LT(lost / count, 0.003);
}

TEST(BitmaskShadows, AnOpenPlaneHasThePartOfASettingSunThatIsAbove) {
  const Geometry g = geometry_of(ground(), from_above(), kWindow);
  for (const float elevation : {-2.0f, 0.0f, 0.5f, 3.0f, 20.0f}) {
    for (const float radius : {4.5f, 15.0f}) {
      const Disc disc{glm::dvec3(direction_of(30, elevation)), radius};
      double exact = 0;
      const int count = 1 << 14;
      for (const glm::dvec3& to : disc.points(count)) exact += std::max(0.0, to.z) / count;
      const Products out = lit(g, disc.map());
      double worst = 0;
      for (int y = 100; y < 260; ++y)  // below the horizon
        for (int x = 0; x < kWindow.width(); ++x)
          worst = std::max(worst, std::abs(out.direct(x, y).x - exact));
      EXPECT_LT(worst, 2e-3) << elevation << " " << radius << ", exactly " << exact;
    }
  }
}

TEST(BitmaskShadows, EveryPixelLooksAtAPartOfASettingSunThatIsAbove) {
  const Geometry g = geometry_of(ground(), from_above(), kWindow);
  const Disc disc{glm::dvec3(direction_of(30, 0)), 4.5f};
  const Scene scene = scene_of(g, disc.map());
  const Products out = bitmask_method().estimate(
      scene,
      {.products = {.ao = true, .direct = true}, .radius = kNoLimit, .slices = 2, .steps = 8}, {});
  int dark = 0;
  for (int y = 100; y < 260; ++y)
    for (int x = 0; x < kWindow.width(); ++x) dark += out.direct(x, y).x == 0;
  EXPECT_EQ(dark, 0) << "without a filter";
}

TEST(BitmaskShadows, AnotherSeedLooksAtOtherPoints) {
  const Surface scene = all_of({ground(), Box{{-1, -0.5, 0}, {0.6, 0.9, 1.2}}.surface()});
  const Geometry g = geometry_of(scene, from_above(), kWindow);
  const Disc disc{glm::normalize(glm::dvec3(0.25, 0.7, 0.75)), 5};
  Scene lit_scene = scene_of(g, disc.map());
  const auto draw = [&](unsigned seed) {
    return bitmask_method().estimate(lit_scene,
                                     {.products = {.ao = true, .direct = true},
                                      .radius = kNoLimit,
                                      .seed = seed,
                                      .slices = 1,
                                      .steps = 8},
                                     {});
  };
  Plane<double> mean(kWindow.width(), kWindow.height(), 0);
  constexpr int kSeeds = 64;
  std::vector<Products> draws;
  for (int s = 0; s < kSeeds; ++s) draws.push_back(draw(unsigned(s)));
  for (const Products& d : draws)
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += d.direct[i].x / kSeeds;
  const auto rms = [&](int count) {
    double squares = 0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      double part = 0;
      for (int s = 0; s < count; ++s) part += draws[std::size_t(s)].direct[i].x / count;
      squares += (part - mean[i]) * (part - mean[i]) / double(mean.size());
    }
    return std::sqrt(squares);
  };
  fmt::print("of seeds: one {:.4f} from the mean, 16 {:.4f}\n", rms(1), rms(16));
  EXPECT_LT(rms(16), 0.3 * rms(1));
}

/// Noise of a filtered penumbra is seen as soft clouds as wide as the pattern.
TEST(BitmaskShadows, AWidePenumbraHasLittleNoise) {
  const Surface scene = all_of({ground(), Box{{-2, 0, 0}, {2, 0.25, 1.6}}.surface()});
  const Geometry g = geometry_of(scene, from_above(), kWindow);
  const Environment map = Disc{glm::normalize(glm::dvec3(0.3, 0.8, 0.8)), 20}.map();
  constexpr int kSeeds = 8;
  std::vector<Plane<glm::vec3>> of_seeds;
  for (unsigned k = 0; k < kSeeds; ++k) of_seeds.push_back(lit(g, map, 256 * k).direct);
  double variance = 0, sum = 0;
  for (std::size_t i = 0; i < of_seeds[0].size(); ++i) {
    double mean = 0;
    for (const auto& of_seed : of_seeds) mean += double(of_seed[i].x) / kSeeds;
    for (const auto& of_seed : of_seeds)
      variance += std::pow(double(of_seed[i].x) - mean, 2) / (kSeeds - 1);
    sum += mean;
  }
  const double pixels = double(of_seeds[0].size());
  const double noise = std::sqrt(variance / pixels) / (sum / pixels);
  fmt::print("noise of a wide penumbra: {:.4f} of the light\n", noise);
  EXPECT_LT(noise, 0.014);
}

}  // namespace
}  // namespace ssdo::test::shadows_test
