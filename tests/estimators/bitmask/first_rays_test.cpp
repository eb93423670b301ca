// SPDX-License-Identifier: Apache-2.0
//
// Rays to a sun that go first, and those that need not go after them, against a ray of each pixel.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "estimators/bitmask/march.h"
#include "estimators/bitmask/raster.h"
#include "estimators/bitmask/request.h"
#include "scene/solids.h"

namespace ssdo::test {
namespace {

/// A floor, a ball on it, and posts a pixel wide that stand in front of both.
Surface ball_and_posts() {
  const Surface posts = cut(plane({0, -0.8, 0}, {0, -1, 0}), [](const glm::dvec3& p) {
    return p.z > 0 && p.z < 0.5 && std::abs(p.x / 0.5 - std::round(p.x / 0.5)) < 0.02;
  });
  return all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5), posts});
}

/// Light of a disc of so many degrees beside the camera, 40 degrees high; else black.
Light disc(double degrees, const Geometry& g) {
  constexpr int kHeight = 256, kColumn = 2 * kHeight * 7 / 12, kRow = kHeight * 5 / 18;
  auto map = std::make_shared<Plane<glm::vec3>>(2 * kHeight, kHeight, glm::vec3(0));
  const double radius = 0.5 * degrees / 180 * kHeight, stretch = std::sin(kPi * kRow / kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < 2 * kHeight; ++x)
      if (std::hypot((x - kColumn) * stretch, y - kRow) <= radius) (*map)(x, y) = glm::vec3(8000);
  }
  EnvironmentFrame frame;
  frame.up = UpAxis::z;
  return model_light(Environment(map, frame), g.world_to_camera);
}

/// How the sun arrives at each pixel.
struct Found {
  Plane<float> share, weight;
};

Found find(const Geometry& g, const Solids& solids, const Sun& sun, bool some_go_first) {
  const MarchScene scene = make_march_scene(g, solids);
  const Raster raster(scene);
  const SlicePattern pattern(scene.layout, g.display, 2, 16, 0);
  const std::vector<DepthBounds> bounds = depth_bounds(scene);
  const std::vector<RayDirections> directions = directions_to(sun, 1, 0);
  InterleavedPlane first = raster.unknown();
  SunShares found(scene.layout);
  const SunJob job{{scene, pattern, kNoLimit, false}, bounds, directions, &sun, {},
                   some_go_first ? &first : nullptr,  &found};
  if (some_go_first) march_first_rays(job, scene.raster());
  march_sun(job, scene.raster());
  return {raster.picture(std::move(found.share), 1), raster.picture(std::move(found.weight), 1)};
}

struct Difference {
  double bias = 0, differs = 0, shadow = 0;  ///< shares of the sun's light, of pixels, of it
};

Difference difference(const Found& some, const Found& all) {
  Difference d;
  double weights = 0;
  for (std::size_t i = 0; i < all.share.size(); ++i) {
    const double w = double(all.weight[i]);
    weights += w;
    d.bias += w * double(some.share[i] - all.share[i]);
    d.shadow += w * double(1 - all.share[i]);
    d.differs += w > 0 && std::abs(some.share[i] - all.share[i]) > 0.5f;
  }
  d.bias /= weights, d.shadow /= weights, d.differs /= double(all.share.size());
  return d;
}

TEST(BitmaskFirstRays, OthersFindWhatTheyFind) {
  const Window window{0, 0, 320, 240};
  for (const double degrees : {0.5, 4.0, 8.0}) {
    const Camera camera = tilted(camera_from_fov(40, window, 1), 60);
    const Geometry g = geometry_of(ball_and_posts(), camera, window);
    const Solids solids = guess_solids(g);
    const Light light = disc(degrees, g);
    ASSERT_EQ(light.suns.size(), 1u);
    const Difference d =
        difference(find(g, solids, light.suns[0], true), find(g, solids, light.suns[0], false));
    fmt::print("a sun of {} degrees: {:.3f} of it in shadow, {:+.5f} more light, {:.3f} % differ\n",
               degrees, d.shadow, d.bias, 100 * d.differs);
    EXPECT_GT(d.shadow, 0.02);
    EXPECT_LT(std::abs(d.bias), 0.0006);
    EXPECT_LT(d.differs, 0.0006);
  }
}

}  // namespace
}  // namespace ssdo::test
