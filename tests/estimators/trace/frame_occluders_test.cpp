// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/frame_occluders.h"

#include <gtest/gtest.h>

#include <memory>

#include "estimators/bitmask/request.h"

namespace ssdo::test::frame_occluders_test {
namespace {

TEST(FrameOccluders, AreSharedByLampsThatNameTheSame) {
  const Window window{0, 0, 32, 24};
  Scene scene = scene_of(
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(45, window, 1), 50), window));
  scene.solids = guess_solids(scene.geometry);
  const auto one = std::make_shared<const Scene>(scene),
             other = std::make_shared<const Scene>(scene);
  scene.linked_occluders = {{0, one}, {1, other}, {2, one}};
  const FrameOccluders occluders(scene, kNoLimit);
  ASSERT_NE(occluders.named_by(0), nullptr);
  EXPECT_EQ(occluders.named_by(2), occluders.named_by(0));
  EXPECT_NE(occluders.named_by(1), occluders.named_by(0));
  EXPECT_EQ(occluders.named_by(3), nullptr);
}

}  // namespace
}  // namespace ssdo::test::frame_occluders_test
