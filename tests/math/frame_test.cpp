// SPDX-License-Identifier: Apache-2.0
#include "math/frame.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ssdo::test::frame_test {
namespace {

TEST(Frame, IsOrthonormalAndRightHandedAtThePolesToo) {
  for (const glm::vec3& axis :
       {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0.0f), glm::vec3(1, 0, -0.0f),
        glm::vec3(1e-4f, -1e-4f, -1), glm::vec3(-0.6f, 0.3f, 0.2f), glm::vec3(0.6f, 0.3f, -0.7f)}) {
    const glm::vec3 n = glm::normalize(axis);
    const glm::mat3 frame = frame_about(n);
    EXPECT_EQ(frame[2], n);
    const glm::mat3 product = glm::transpose(frame) * frame;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(product[i][j], i == j, 1e-6f) << i << j << n.z;
    EXPECT_NEAR(glm::determinant(frame), 1, 1e-6f);
  }
}

}  // namespace
}  // namespace ssdo::test::frame_test
