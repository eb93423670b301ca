// SPDX-License-Identifier: Apache-2.0
//
// Lamps on vectors of surfaces against the same one by one, on every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "scene/light/lamps/lamp_sum.h"
#include "support/chosen_isa.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/light/lamps/lamp_lanes_test.cpp"
#include <hwy/foreach_target.h>

#include "scene/light/light-inl.h"

namespace ssdo {

#ifndef SSDO_LAMP_LANES_
#define SSDO_LAMP_LANES_
struct LampLanes {
  std::vector<glm::vec3> positions, normals, to;
  std::vector<float> received, distance, weight, angle;

  void resize(std::size_t count) {
    to.resize(count);
    for (auto* of : {&received, &distance, &weight, &angle}) of->resize(count);
  }
};
#endif

}  // namespace ssdo

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void look_at_lamp(const Source& source, const glm::vec3& point, LampLanes& lanes) {
  for (std::size_t i = 0; i < lanes.positions.size(); i += std::size_t(kLanes)) {
    const V3 position = load(&lanes.positions[i]);
    store(received(source, position, load(&lanes.normals[i])), &lanes.received[i]);
    const SourcePoints points = seen(source, position, set(point));
    store(points.to, &lanes.to[i]);
    store(points.distance, &lanes.distance[i]);
    store(points.weight, &lanes.weight[i]);
    store(cones(source, position).angular_radius, &lanes.angle[i]);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(look_at_lamp);

namespace test {
namespace {

/// Lamps of all types, with and without a cone of either kind; one of one metre and one that is a
/// point.
std::vector<Lamp> lamps() {
  std::vector<Lamp> all;
  std::mt19937 random(3);
  for (const LampType type :
       {LampType::sphere, LampType::disk, LampType::rect, LampType::distant}) {
    for (const int kind : {0, 1, 2}) {
      const bool cone = kind > 0;
      Lamp lamp;
      lamp.type = type;
      lamp.width = 0.7, lamp.height = 1.5, lamp.angle = cone ? 250 : 40;
      lamp.axes = about(random_unit(random));
      lamp.position = random_unit(random);
      lamp.has_cone = cone && type != LampType::distant;
      lamp.cone_angle = 60, lamp.cone_softness = 0.4;
      lamp.cone_by_cosine = lamp.soft_falloff = kind == 2;
      all.push_back(lamp);
    }
  }
  all.front().radius = 0, all.front().normalize = true;
  return all;
}

TEST(LampLanes, AreTheSameAsOneByOne) {
  for (const Lamp& lamp : lamps()) {
    const auto source = make_source(lamp, WorldToCamera(), 0.01);
    Lamp open = lamp;
    open.has_cone = false;
    const auto without_cone = make_source(open, WorldToCamera(), 0.01);
    std::mt19937 random(4);
    LampLanes lanes;
    for (int i = 0; i < 100 * kMostLanes; ++i) {
      const double away = std::pow(10, between(random, -2, 2));
      lanes.positions.emplace_back(lamp.position + away * random_unit(random));
      lanes.normals.emplace_back(random_unit(random));
    }
    lanes.resize(lanes.positions.size());
    const glm::vec3 point = source->point({0.3f, 0.8f});
    for (const char* isa : kIsas) {
      if (!has_isa(isa)) continue;
      const ChosenIsa chosen(isa);
      HWY_DYNAMIC_DISPATCH(look_at_lamp)(*source, point, lanes);
      for (std::size_t i = 0; i < lanes.positions.size(); ++i) {
        const glm::vec3 &position = lanes.positions[i], &normal = lanes.normals[i];
        const std::string where =
            std::string(isa) + " type " + std::to_string(int(lamp.type)) + " " + std::to_string(i);
        float most = 0;
        for (int k = 0; k < 30; ++k)
          most = std::max(most, without_cone->received(position, glm::vec3(random_unit(random))));
        ASSERT_NEAR(lanes.received[i], source->received(position, normal), 1e-3f * most) << where;
        const SourcePoint seen = source->seen(position, point);
        ASSERT_NEAR(lanes.angle[i], source->cone(position).angular_radius, 1e-3f) << where;
        // Of one that faces the receiver. What is seen from its edge is rounded more.
        const float away = glm::distance(position, glm::vec3(lamp.position)),
                    facing = lamp.type == LampType::distant ? 1 : 1 / std::max(away * away, 0.25f);
        ASSERT_NEAR(lanes.weight[i], seen.weight, 0.01f * seen.weight + 5e-4f * facing) << where;
        if (!(seen.weight > 0.05f * facing)) continue;
        ASSERT_LT(glm::distance(lanes.to[i], seen.to), 0.01f) << where;
        if (lamp.type == LampType::distant)
          ASSERT_EQ(lanes.distance[i], seen.distance);
        else
          ASSERT_NEAR(lanes.distance[i], seen.distance, 0.02f * seen.distance) << where;
      }
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace ssdo
#endif
