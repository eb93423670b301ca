// SPDX-License-Identifier: Apache-2.0
//
// The raster of a march: all of it blocks and sends, in as many layers as there are; a window of it
// gathers.
#include <gtest/gtest.h>

#include <cstring>

#include "estimators/bitmask/request.h"

namespace ssdo::test::raster_test {
namespace {

/// Neither begins nor ends with a vector or a pattern.
const Window kWindow{-3, 5, 128, 82};

Geometry still_life(bool orthographic) {
  const Surface things =
      all_of({floor_and_wall(), sphere({0.4, -0.7, 0.4}, 0.4), sphere({-0.6, -0.4, 0.25}, 0.25)});
  const Camera camera =
      orthographic ? camera_from_ortho_width(3.2, kWindow, 1) : camera_from_fov(35, kWindow, 1);
  return geometry_of(things, tilted(camera, 50, 5, {0, -0.4, 0.2}), kWindow);
}

Environment sky_with_a_sun() {
  auto map = std::make_shared<Plane<glm::vec3>>(64, 32, glm::vec3(0.4f, 0.6f, 1));
  (*map)(14, 8) = glm::vec3(2000);
  return Environment(map, {});
}

BitmaskRequest all_products(const Solids& solids) {
  return {.radius = kNoLimit,
          .environment = sky_with_a_sun(),
          .products = {.ao = true, .direct = true, .bent = true, .error = true},
          .slices = 3,
          .steps = 12,
          .solids = &solids,
          .bounces = 2};
}

template <class T>
std::size_t count_differences(const Plane<T>& part, const Plane<T>& whole, const Window& window) {
  EXPECT_EQ(part.width, window.width());
  EXPECT_EQ(part.height, window.height());
  std::size_t count = 0;
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      count +=
          std::memcmp(&part(x, y), &whole(window.x0 - kWindow.x0 + x, window.y0 - kWindow.y0 + y),
                      sizeof(T)) != 0;
    }
  }
  return count;
}

std::size_t count_differences(const Products& part, const Products& whole, const Window& window) {
  return count_differences(part.ao, whole.ao, window) +
         count_differences(part.direct, whole.direct, window) +
         count_differences(part.bounce, whole.bounce, window) +
         count_differences(part.bent, whole.bent, window) +
         count_differences(part.error, whole.error, window);
}

TEST(BitmaskRaster, ReceiversInAWindowGetTheBitsOfTheWholeRaster) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = still_life(orthographic);
    const Solids solids = guess_solids(g);
    BitmaskRequest request = all_products(solids);
    for (const bool radiance : {false, true}) {
      if (radiance)
        request.radiance = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0.3f));
      request.receivers = {};
      const Products whole = run(g, request);
      for (const Window& receivers : {Window{20, 20, 100, 60},
                                      {-3, 5, 40, 30},
                                      {61, 47, 62, 48},
                                      {97, 33, 128, 82},
                                      kWindow}) {
        request.receivers = receivers;
        EXPECT_EQ(count_differences(run(g, request), whole, receivers), 0)
            << receivers.x0 << ", " << receivers.y0 << ", radiance " << radiance;
      }
    }
  }
}

/// `solids` with a layer of nothing before the second.
Solids with_empty_layer(const Solids& solids) {
  Solids out = solids;
  SolidLayer nothing = solids.behind.front();
  for (float& distance : nothing.distance.pixels) distance = kNoLimit;
  out.behind.insert(out.behind.begin(), std::move(nothing));
  return out;
}

TEST(BitmaskRaster, ALayerBlocksAndSendsWhateverItsNumber) {
  for (const bool orthographic : {false, true}) {
    const Geometry g = still_life(orthographic);
    const Solids two = guess_solids(g), three = with_empty_layer(two);
    ASSERT_EQ(three.layers(), 3);
    EXPECT_EQ(count_differences(run(g, all_products(two)), run(g, all_products(three)), kWindow),
              0);
    const Solids one{two.thickness, {}, {}, {}};
    EXPECT_GT(count_differences(run(g, all_products(one)), run(g, all_products(two)), kWindow),
              100);
  }
}

/// A layer that lies where another one does hides nothing that the other has not hidden.
TEST(BitmaskRaster, ALayerIsHiddenByTheLayersBeforeIt) {
  const Geometry g = still_life(false);
  const Solids two = guess_solids(g);
  Solids again = two;
  again.behind.push_back(two.behind.front());
  for (int& sender : again.behind.back().sender.pixels) sender = sender < 0 ? -1 : 0;
  EXPECT_EQ(count_differences(run(g, all_products(two)), run(g, all_products(again)), kWindow), 0);
}

}  // namespace
}  // namespace ssdo::test::raster_test
