// SPDX-License-Identifier: Apache-2.0
//
// The product specular: what rays find of mirrored light, and what a filter leaves of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "estimators/specular/specular_scene.h"
#include "filters/light_visibility.h"

namespace ssdo::test::specular_test {
namespace {

Plane<glm::vec3> filtered(const std::string& method, const Scene& scene, double roughness) {
  const Method& by = find_method(method);
  return filter_visibility(find_filter("geometry"),
                           by.estimate(scene, request_of(by, roughness), {}), scene,
                           by.pattern_size)
      .specular;
}

TEST(Specular, NothingMirrorsMoreThanTheBrightestLight) {
  const auto sky = [](const glm::vec3& d) {
    const bool is_sun = glm::dot(d, glm::normalize(glm::vec3(0.5f, -1, 1))) > 0.9995f;
    return glm::vec3(is_sun ? 5000.0f : d.z > 0 ? 1.0f : 0.1f);
  };
  const Surface ball = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 1}, 1)});
  const Scene scene = scene_of(
      geometry_of(ball, tilted(camera_from_fov(30, kWindow, 1), 60), kWindow), painted(sky, 512));
  ASSERT_FALSE(scene.light.sources.empty());
  for (const double roughness : {0.0, 0.05, 0.2, 0.6}) {
    const Plane<glm::vec3> found = specular_of("bitmask", scene, roughness);
    float most = 0;
    for (const glm::vec3& light : found.pixels) {
      ASSERT_TRUE(std::isfinite(light.x) && light.x >= 0);
      most = std::max(most, light.x);
    }
    fmt::print("roughness {}: at most {:.1f} of 5000\n", roughness, most);
    EXPECT_LT(most, 5200) << roughness;
  }
}

TEST(Specular, AMirrorShowsTheWallInTheColourThatItSends) {
  const Surface corner = floor_and_wall();
  const Camera camera = tilted(camera_from_fov(50, kWindow, 1), 60, 4);
  Scene scene = scene_of(geometry_of(corner, camera, kWindow), Environment::constant(glm::vec3(0)));
  scene.solids = guess_solids(scene.geometry);
  scene.senders.radiance = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0));
  Plane<unsigned char> shows_wall(kWindow.width(), kWindow.height(), 0);
  const glm::vec3 color(2, 0.5f, 0.25f);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const Point p = point_at(corner, camera, kWindow, x, y);
      if (p.normal.y < -0.5) {
        scene.senders.radiance(x, y) = color;
        continue;
      }
      // Where the mirrored ray meets the wall, and whether the frame shows that.
      const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
      const glm::dvec3 to = glm::reflect(glm::normalize(ray.direction), p.normal);
      const glm::dvec3 at = p.position - p.position.y / to.y * to;
      if (to.y <= 0 || p.position.y > -0.1) continue;
      const glm::dvec2 pixel = camera.project(camera.to_camera(at));
      shows_wall(x, y) = pixel.x > 3 && pixel.x < kWindow.width() - 3 && pixel.y > 3 &&
                         pixel.y < kWindow.height() - 3;
    }
  }
  for (const char* method : {"bitmask", "trace"}) {
    for (const bool with_filter : {false, true}) {
      const Plane<glm::vec3> found =
          with_filter ? filtered(method, scene, 0) : specular_of(method, scene, 0);
      int count = 0, right = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (!shows_wall[i]) continue;
        ++count, right += glm::distance(found[i], color) < 0.02f * glm::length(color);
      }
      EXPECT_GT(count, 300);
      // The filter blurs the edges of what is mirrored.
      EXPECT_GT(right, (with_filter ? 0.8 : 0.97) * count) << method << " " << with_filter;
    }
  }
  scene.senders.radiance = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0));
  for (const glm::vec3& light : specular_of("bitmask", scene, 0).pixels)
    ASSERT_EQ(light, glm::vec3(0)) << "black surfaces send nothing";
}

TEST(Specular, AMirrorAboveTheHorizonShowsGroundThatLeavesThePicture) {
  // A wall that a camera looks down at mirrors nothing but ground, most of which no pixel shows.
  const Surface corner = floor_and_wall();
  const Camera camera = tilted(camera_from_fov(75, kWindow, 1), 75, 4, {0, 0, 1.5});
  const Environment sky = Environment::constant(glm::vec3(1), UpAxis::z);
  Scene scene = scene_of(geometry_of(corner, camera, kWindow), sky);
  scene.solids = guess_solids(scene.geometry);
  const Method& method = find_method("bitmask");
  const auto found = [&](bool extend) {
    Request request = request_of(method, 0.1);
    request.extend_offscreen = extend;
    Products products = method.estimate(scene, request, {});
    add_specular(products, scene);
    return products.specular;
  };
  const Plane<glm::vec3> with = found(true), without = found(false);
  double wall = 0, dark = 0, open = 0;
  for (int y = 0; y < kWindow.height(); ++y) {
    // Rays that leave the picture over the wall tell nothing of the ground.
    for (int x = kWindow.width() / 3; x < 2 * kWindow.width() / 3; ++x) {
      const Point p = point_at(corner, camera, kWindow, x, y);
      if (p.normal.y > -0.5 || ray_through(camera, x + 0.5, y + 0.5).direction.z > -0.15) continue;
      ++wall, dark += with(x, y).y<0.1f, open += without(x, y).y> 0.9f;
    }
  }
  EXPECT_GT(wall, 500);
  EXPECT_GT(open, 0.4 * wall) << "the picture alone shows little of it";
  EXPECT_GT(dark, 0.95 * wall);

  // That ground sends what it does where the border cuts it.
  scene.senders.radiance =
      Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0.5f, 0.25f, 2));
  const Plane<glm::vec3> lit = found(true);
  for (std::size_t i = 0; i < lit.size(); ++i) {
    const float dimmed = 1 - with[i].y;
    ASSERT_NEAR(lit[i].x - with[i].x, 0.5f * dimmed, 0.05f);
    ASSERT_NEAR(lit[i].z - with[i].z, 2 * dimmed, 0.2f);
  }
}

TEST(Specular, TheFilterLeavesHighlightsOfNormalMapsAlone) {
  Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(10, kWindow, 1), 0, 20), kWindow);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const double lean = glm::radians(15.0) * std::sin(2 * kPi * x / 8);
      g.surfaces.set_normal(g.surfaces.index(x, y), glm::vec3(std::sin(lean), 0, std::cos(lean)));
    }
  }
  const Scene scene = scene_of(std::move(g), painted([](const glm::vec3& d) {
                                 const glm::vec3 sun = glm::normalize(glm::vec3(0.3f, 0, 1));
                                 return glm::vec3(glm::dot(d, sun) > 0.9998f ? 3000.0f : 0.5f);
                               }));
  ASSERT_EQ(scene.light.sources.size(), 1u);
  const Plane<glm::vec3> plain = specular_of("bitmask", scene, 0.3),
                         averaged = filtered("bitmask", scene, 0.3), open = unoccluded(scene, 0.3);
  double sum = 0, squares = 0, lost = 0, count = 0;
  for (int y = 12; y < kWindow.height() - 12; ++y) {
    for (int x = 16; x < kWindow.width() - 16; ++x) {
      const double light = double(open(x, y).y);
      sum += light, squares += light * light, count += 1;
      lost += std::pow(double(averaged(x, y).y) - light, 2);
      EXPECT_LE(plain(x, y).y, 1.001 * light + 1e-4);
    }
  }
  const double contrast = std::sqrt(squares / count - std::pow(sum / count, 2));
  EXPECT_GT(contrast, sum / count) << "there are highlights";
  EXPECT_LT(std::sqrt(lost / count), 0.03 * contrast);
}

TEST(Specular, BitmaskIsTrace) {
  const Surface things =
      all_of({floor_and_wall(), sphere({-0.6, -1.2, 0.6}, 0.6), sphere({0.9, -0.8, 0.3}, 0.3)});
  Scene scene = scene_of(
      geometry_of(things, tilted(camera_from_fov(45, kWindow, 1), 60, 6, {0, -0.6, 0.4}), kWindow),
      painted([](const glm::vec3& d) {
        const bool is_sun = glm::dot(d, glm::normalize(glm::vec3(0.6f, -1, 1))) > 0.9995f;
        return glm::vec3(is_sun ? 1500.0f : 0.6f + 0.4f * d.z, 0.6f, 0.8f);
      }),
      0.6f);
  scene.solids = guess_solids(scene.geometry);
  for (const double roughness : {0.2, 0.5}) {
    const Plane<glm::vec3> fast = filtered("bitmask", scene, roughness),
                           exact = specular_of("trace", scene, roughness);
    glm::dvec3 square(0), bias(0), mean(0);
    for (std::size_t i = 0; i < fast.size(); ++i) {
      const glm::dvec3 d = glm::dvec3(fast[i]) - glm::dvec3(exact[i]);
      square += d * d / double(fast.size()), bias += d / double(fast.size());
      mean += glm::dvec3(exact[i]) / double(fast.size());
    }
    fmt::print("roughness {}: RMSE {:.3f}, bias {:+.3f} of the mean {:.4f}\n", roughness,
               std::sqrt(square.y) / mean.y, bias.y / mean.y, mean.y);
    EXPECT_LT(std::abs(bias.y), 0.04 * mean.y);
    EXPECT_LT(std::sqrt(square.y), 0.25 * mean.y);
  }
}

TEST(Specular, PartsOfAFrameAreAsInTheWhole) {
  const Method& method = find_method("bitmask");
  Scene scene = scene_of(
      geometry_of(all_of({floor_and_wall(), sphere({0, -1, 0.5}, 0.5)}),
                  tilted(camera_from_fov(45, kWindow, 1), 60), kWindow),
      painted([](const glm::vec3& d) { return glm::vec3(d.z > 0 ? 1 : 0, 0.5f, 0.2f); }), 0.7f);
  scene.solids = guess_solids(scene.geometry);
  Request request = request_of(method, 0.3);
  request.products.bounce = true, request.bounces = 1;
  const Products whole = method.estimate(scene, request, {});
  request.receivers = {13, 7, 61, 50};
  const Products part = method.estimate(scene, request, {});
  for (int y = 7; y < 50; ++y) {
    for (int x = 13; x < 61; ++x) {
      ASSERT_EQ(part.specular(x - 13, y - 7), whole.specular(x, y)) << x << " " << y;
      ASSERT_EQ(part.visibility.mirrored_sky(x - 13, y - 7), whole.visibility.mirrored_sky(x, y));
    }
  }
}

}  // namespace
}  // namespace ssdo::test::specular_test
