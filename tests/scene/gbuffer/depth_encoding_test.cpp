// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/depth_encoding.h"

#include <gmock/gmock.h>

#include <cmath>

#include "error.h"

namespace ssdo::test::depth_encoding_test {
namespace {

using testing::HasSubstr;

GBuffer depths(std::vector<float> values) {
  GBuffer g;
  g.window = g.display = {0, 0, int(values.size()), 1};
  g.depth = Plane<float>(int(values.size()), 1);
  for (std::size_t i = 0; i < values.size(); ++i) g.depth[i] = values[i];
  return g;
}

GBufferOptions kind(DepthKind kind, float near = 0, float far = 1) {
  GBufferOptions options;
  options.depth_kind = kind;
  options.depth_near = near;
  options.depth_far = far;
  return options;
}

TEST(DepthEncoding, TurnsTheSignOfACameraThatLooksAlongMinusZ) {
  GBuffer g = depths({-2, -3.5f, 0, -1e10f, INFINITY});
  undo_depth_encoding(g, {}, "test.exr");
  EXPECT_EQ(g.depth[0], 2);
  EXPECT_EQ(g.depth[1], 3.5f);
  EXPECT_EQ(g.depth[3], 1e10f);
  ASSERT_EQ(g.warnings.size(), 1u);
  EXPECT_THAT(g.warnings[0], HasSubstr("sign is turned"));
  // One positive depth: the others are broken.
  GBuffer mixed = depths({-2, -3.5f, 2});
  undo_depth_encoding(mixed, {}, "test.exr");
  EXPECT_EQ(mixed.depth[0], -2);
  EXPECT_TRUE(mixed.warnings.empty());
}

TEST(DepthEncoding, OfANormalizedDepthHasNothingAtItsFarEnd) {
  GBuffer g = depths({0, 0.5f, 0.999f, 1, 1.2f});
  undo_depth_encoding(g, kind(DepthKind::normalized, 2, 10), "test.exr");
  EXPECT_FLOAT_EQ(g.depth[0], 2);
  EXPECT_FLOAT_EQ(g.depth[1], 6);
  EXPECT_FLOAT_EQ(g.depth[2], 9.992f);
  EXPECT_EQ(g.depth[3], INFINITY);
  EXPECT_EQ(g.depth[4], INFINITY);
  // White is near: nothing is black.
  GBuffer inverted = depths({1, 0.5f, 0});
  undo_depth_encoding(inverted, kind(DepthKind::normalized, 10, 2), "test.exr");
  EXPECT_FLOAT_EQ(inverted.depth[0], 2);
  EXPECT_FLOAT_EQ(inverted.depth[1], 6);
  EXPECT_EQ(inverted.depth[2], INFINITY);
}

TEST(DepthEncoding, RefusesADepthWithoutUnitUnlessPIsThere) {
  GBuffer g = depths({0.2f, 0.9f, 1});
  EXPECT_THROW(undo_depth_encoding(g, {}, "test.exr"), Error);
  undo_depth_encoding(g, kind(DepthKind::planar), "test.exr");
  GBuffer beside_p = depths({0.2f, 0.9f, 1});
  beside_p.position = Plane<glm::vec3>(3, 1, glm::vec3(1));
  undo_depth_encoding(beside_p, {}, "test.exr");
  EXPECT_EQ(beside_p.depth[1], 0.9f);
}

TEST(DepthEncoding, OfOneOverDepthIsUndone) {
  GBuffer g = depths({0.5f, 0.125f, 0});
  undo_depth_encoding(g, kind(DepthKind::inverse), "test.exr");
  EXPECT_EQ(g.depth[0], 2);
  EXPECT_EQ(g.depth[1], 8);
  EXPECT_EQ(g.depth[2], INFINITY);
}

}  // namespace
}  // namespace ssdo::test::depth_encoding_test
