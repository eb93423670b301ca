// SPDX-License-Identifier: Apache-2.0
//
// How much light comes through what may go on beyond the frame.
#include "estimators/bitmask/beyond.h"

#include <gtest/gtest.h>

#include "estimators/bitmask/request.h"
#include "scene/solids.h"

namespace ssdo::test {
namespace {

TEST(BitmaskBeyond, AnOpenFrameHasTheWholeSun) {
  EXPECT_FLOAT_EQ(sun_past_beyond(0), 0);
  EXPECT_FLOAT_EQ(sun_past_beyond(0.3f), 0.5f);
  EXPECT_FLOAT_EQ(sun_past_beyond(0.6f), 1);
  EXPECT_FLOAT_EQ(sun_past_beyond(1), 1);
}

TEST(BitmaskBeyond, TheMeanAoIsThatOfTheFrame) {
  const Window window{0, 0, 192, 144};
  const Camera camera =
      look_at(camera_from_fov(40, window, 1), {0, -3, 1.5}, {0, 0, 0.3}, {0, 0, 1});
  const Surface wall = all_of({plane({}, {0, 0, 1}), plane({0, 0.5, 0}, {0, -1, 0})});
  for (const Surface& scene : {plane({}, {0, 0, 1}), wall}) {
    const Geometry g = geometry_of(scene, camera, window);
    const Solids solids = guess_solids(g);
    const Products out = run(g, {.radius = kNoLimit,
                                 .products = {.ao = true},
                                 .slices = 8,
                                 .steps = 16,
                                 .solids = &solids});
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < out.ao.size(); ++i)
      if (g.is_surface(i)) sum += double(out.ao[i]), ++count;
    const float found = mean_ao(make_march_scene(g, solids), window, kNoLimit);
    EXPECT_NEAR(found, sum / count, 0.01);
    // Of a part of the pixels too: the frame decides, not who asks.
    EXPECT_EQ(mean_ao(make_march_scene(g, solids, {10, 20, 30, 40}), window, kNoLimit), found);
  }
}

}  // namespace
}  // namespace ssdo::test
