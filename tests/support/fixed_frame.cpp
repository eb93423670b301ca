// SPDX-License-Identifier: Apache-2.0
#include "support/fixed_frame.h"

#include "estimators/registry.h"
#include "support/analytic_scene.h"
#include "support/scene_of.h"

namespace ssdo::test {
namespace {

constexpr Window kWindow{0, 0, 130, 70};

Camera camera() {
  Camera lens;
  lens.fx = lens.fy = 150;
  lens.cx = 65, lens.cy = 35;
  return look_at(lens, {0.5, -4, 2.25}, {0, 0, 0.5}, {0, 0, 1});
}

Surface still_life() {
  const Surface wall =
      cut(plane({0, 1, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z < 1.25; });
  return all_of({plane({}, {0, 0, 1}), wall, sphere({0.5, 0.25, 0.5}, 0.5),
                 sphere({-0.75, -0.5, 0.25}, 0.25)});
}

/// Brighter upwards and redder to one side; with a hard sun and a wide one.
Environment sky() {
  const auto map = std::make_shared<Plane<glm::vec3>>(64, 32);
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) {
      (*map)(x, y) = float(32 - y) / 32 * glm::vec3(0.5f + float(x % 32) / 64, 0.5f, 0.75f);
      if (x == 20 && y == 8) (*map)(x, y) = glm::vec3(300, 280, 250);
      if (x / 2 == 24 && y / 2 == 5) (*map)(x, y) = glm::vec3(40, 60, 80);
    }
  }
  return {map, {.up = UpAxis::z}};
}

}  // namespace

Scene fixed_scene() {
  Scene scene = scene_of(geometry_of(still_life(), camera(), kWindow), sky());
  scene.solids = guess_solids(scene.geometry);
  scene.roughness = Plane<float>(kWindow.width(), kWindow.height());
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      scene.senders.albedo(x, y) = glm::vec3(0.75f, float(x % 8) / 8, float(y % 16) / 16);
      scene.roughness(x, y) = float(x % 16) / 16;
    }
  }
  return scene;
}

Request fixed_request(const Method& method, float radius) {
  return {.products = method.products,
          .radius = radius,
          .bounces = method.products.bounce ? 2 : 0,
          .parameters = resolve_parameters(method, method.is_reference
                                                       ? std::vector<std::string>{"samples=16"}
                                                       : std::vector<std::string>{})};
}

}  // namespace ssdo::test
