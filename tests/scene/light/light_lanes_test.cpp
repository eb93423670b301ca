// SPDX-License-Identifier: Apache-2.0
//
// Light on vectors of surfaces against the same one by one, on every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scene/light/painted_map.h"
#include "support/chosen_isa.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/light/light_lanes_test.cpp"
#include <hwy/foreach_target.h>

#include "scene/light/light-inl.h"
#include "support/point_source.h"
#include "support/sun_of.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void light_surfaces(const Light& light, const std::vector<glm::vec3>& positions,
                    const std::vector<glm::vec3>& normals, glm::vec3* out) {
  for (std::size_t i = 0; i < normals.size(); i += std::size_t(kLanes))
    store(unoccluded(light, load(&positions[i]), load(&normals[i])), out + i);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(light_surfaces);

namespace test {
namespace {

TEST(LightLanes, AreTheSameAsOneByOne) {
  Light light = model_light(paint(256,
                                  [](const glm::vec3& d) {
                                    if (in_disc(d, direction_of(20, 50), 12))
                                      return glm::vec3(10, 8, 6);
                                    if (in_rectangle(d, direction_of(-100, 10), 40, 16))
                                      return glm::vec3(4, 5, 6);
                                    return glm::vec3(0.5f + 0.2f * d.z);
                                  }),
                            glm::mat3(1));
  ASSERT_EQ(light.sources.size(), 2u);
  std::mt19937 random(2);
  std::vector<glm::vec3> normals;
  for (int i = 0; i < 64 * kMostLanes; ++i) normals.push_back(random_direction(random));
  // Vectors all of whose surfaces have the first source at their horizon.
  for (int i = 0; i < 8 * kMostLanes; ++i) {
    const glm::vec3 side =
        glm::normalize(glm::cross(sun_of(light).direction, random_direction(random)));
    normals.push_back(glm::normalize(side + 0.01f * float(i % 30 - 15) * sun_of(light).direction));
  }
  std::vector<glm::vec3> positions;
  for (std::size_t i = 0; i < normals.size(); ++i) positions.push_back(random_direction(random));
  // One that is not endlessly far.
  light.sources.push_back(std::make_shared<PointSource>(glm::vec3(0.2f, 1.5f, -0.4f)));
  for (const char* isa : kIsas) {
    if (!has_isa(isa)) continue;
    const ChosenIsa chosen(isa);
    std::vector<glm::vec3> out(normals.size());
    HWY_DYNAMIC_DISPATCH(light_surfaces)(light, positions, normals, out.data());
    for (std::size_t i = 0; i < normals.size(); ++i)
      ASSERT_LT(glm::distance(out[i], light.unoccluded(positions[i], normals[i])), 1e-5)
          << isa << " " << i;
  }
}

}  // namespace
}  // namespace test
}  // namespace ssdo
#endif
