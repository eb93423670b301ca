// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/moved.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "filters/shot/fusion.h"
#include "filters/shot/moved_weights.h"
#include "scene/light/lamps/lamp.h"
#include "scene/light/light.h"
#include "support/analytic_scene.h"

namespace ssdo::test::moved_test {
namespace {

const Window kWindow{0, 0, 96, 72};

Surface ball_at(double x) { return all_of({plane({}, {0, 0, 1}), sphere({x, 0, 0.5}, 0.3)}); }

Camera camera() { return look_at(camera_from_fov(45, kWindow, 1), {0, -4, 3}, {}, {0, 0, 1}); }

std::vector<MovedPiece> find_moved(const Geometry& now, const Geometry& other) {
  const KeptSurfaces a = keep_surfaces(now), b = keep_surfaces(other);
  return moved_pieces(a.camera, b.camera, find_pieces(a, b), find_pieces(b, a));
}

TEST(Moved, ABallIsFoundWhereItWasAndWhereItIs) {
  const Geometry now = geometry_of(ball_at(0.8), camera(), kWindow),
                 other = geometry_of(ball_at(-0.8), camera(), kWindow);
  const std::vector<MovedPiece> pieces = find_moved(now, other);
  double area[2] = {0, 0};
  for (const MovedPiece& piece : pieces) {
    double nearest = 1e30;
    int which = 0;
    for (const int side : {0, 1}) {
      const glm::dvec3 centre = camera().to_camera(glm::dvec3(side ? 0.8 : -0.8, 0, 0.5));
      const double distance = glm::distance(centre, glm::dvec3(piece.centre));
      if (distance < nearest) nearest = distance, which = side;
    }
    EXPECT_LT(nearest, 0.35);
    EXPECT_LT(piece.radius, 0.4);
    area[which] += double(piece.area);
  }
  // Its disk, without an edge that one of both misses.
  for (const double found : area) EXPECT_NEAR(found, 3.14159 * 0.3 * 0.3, 0.25 * 3.14159 * 0.09);
  EXPECT_TRUE(find_moved(now, now).empty());
}

/// A still scene has no pieces, whatever the camera does.
TEST(Moved, ACameraMovesNothing) {
  const Geometry now = geometry_of(ball_at(0), camera(), kWindow);
  for (const double x : {-0.9, -0.1, 0.4, 1.3}) {
    const Camera moved = look_at(camera_from_fov(45, kWindow, 1), {x, -4, 3}, {}, {0, 0, 1});
    EXPECT_TRUE(find_moved(now, geometry_of(ball_at(0), moved, kWindow)).empty()) << x;
  }
}

TEST(Moved, WeightsAreThoseOfWhatTheBallMayHide) {
  const Geometry now = geometry_of(ball_at(0.8), camera(), kWindow),
                 other = geometry_of(ball_at(-0.8), camera(), kWindow);
  const MovedWeights weights(keep_surfaces(now), find_moved(now, other),
                             model_light(Environment::constant(glm::vec3(1)), glm::mat3(1)));
  const auto at = [&](const glm::dvec3& place) {
    const glm::dvec2 px = camera().project(camera().to_camera(place));
    float weight;
    weights.row(-1, {int(px.x), int(px.y), 1, 1}, &weight);
    return weight;
  };
  EXPECT_EQ(at({-0.8, 0, 0}), 0);
  EXPECT_EQ(at({0.8, 0.45, 0}), 0);
  EXPECT_GT(at({1.3, 2.2, 0}), 0.5f);
  EXPECT_GT(at({1.3, 2.2, 0}), at({1, 1, 0}));
}

/// A ball above a floor that the camera looks down on.
TEST(Moved, WeightsAreThoseOfTheFormFactor) {
  const Camera above = look_at(camera_from_fov(45, kWindow, 1), {0, 0, 4}, {}, {0, 1, 0});
  const KeptSurfaces floor = keep_surfaces(geometry_of(plane({}, {0, 0, 1}), above, kWindow));
  const float radius = 0.3f, height = 2;
  for (const float hidden : {0.02f, 0.05f, 0.09f, 0.2f}) {
    const float area = hidden * 3.14159265f * (height * height + radius * radius);
    const MovedWeights weights(floor, {{{0, 0, -2}, radius, area}},
                               model_light(Environment::constant(glm::vec3(1)), glm::mat3(1)));
    float weight;
    weights.row(-1, {kWindow.width() / 2, kWindow.height() / 2, 1, 1}, &weight);
    const float left = std::max(1 - hidden / 0.1f, 0.0f);
    EXPECT_NEAR(weight, left * left, 0.01f) << hidden;
  }
}

/// Receivers that move by 3 pixels in a frame below a ball that moves along, or stands still.
TEST(Moved, WhatMovesAlongHidesTheSame) {
  const Camera above = look_at(camera_from_fov(45, kWindow, 1), {0, 0, 4}, {}, {0, 1, 0});
  const KeptSurfaces floor = keep_surfaces(geometry_of(plane({}, {0, 0, 1}), above, kWindow));
  ObjectMotion motion;
  motion.is_known = true;
  motion.pixels.assign(floor.size(), pack_bf16x2(3.0f, 0.0f));
  const float radius = 0.3f, height = 2, hidden = 0.05f;
  const float area = hidden * 3.14159265f * (height * height + radius * radius);
  const auto weight_of = [&](const glm::vec3& velocity, int frames) {
    const std::vector<MovedPiece> pieces = {{{0, 0, -2}, radius, area, velocity}};
    MovedWeights weights(floor, pieces,
                         model_light(Environment::constant(glm::vec3(1)), glm::mat3(1)));
    weights.weigh_moving(floor, pieces, motion, frames);
    float weight;
    weights.row_of_moving({kWindow.width() / 2, kWindow.height() / 2, 1, 1}, &weight);
    return weight;
  };
  const glm::vec3 along =
      velocity_of(motion, floor, floor.index(kWindow.width() / 2, kWindow.height() / 2));
  EXPECT_NEAR(glm::length(along), 3 * 4 / above.fx, 1e-3);
  for (const int frames : {1, 2, 8, -8}) {
    EXPECT_NEAR(weight_of(along, frames), 1, 1e-3) << frames;
    const float way = glm::length(along) * float(std::abs(frames)),
                left = 1 - hidden / 0.1f * std::min(way / (2 * radius), 1.0f);
    EXPECT_NEAR(weight_of(glm::vec3(0), frames), left * left, 0.02f) << frames;
  }
}

/// The shadow of a ball is as wide as the ball and the penumbra of the lamp.
TEST(Moved, TheShadowOfAWideLampIsWider) {
  const Camera above = look_at(camera_from_fov(45, kWindow, 1), {0, 0, 4}, {}, {0, 1, 0});
  const KeptSurfaces floor = keep_surfaces(geometry_of(plane({}, {0, 0, 1}), above, kWindow));
  const std::vector<MovedPiece> pieces = {{{0, 0, -2}, 0.3f, 0.28f}};
  const glm::dvec2 px = above.project(above.to_camera({1.2, 0, 0}));  // 0.8 off the ball's middle
  const auto weight_under = [&](double radius) {
    Lamp lamp;
    lamp.position = {0, 0, 6}, lamp.radius = radius;
    Light light = model_light(Environment::constant(glm::vec3(0)), glm::mat3(1));
    light.sources = {make_source(lamp, {above.rotation, above.origin}, 1e-4)};
    float weight;
    MovedWeights(floor, pieces, light).row(0, {int(px.x), int(px.y), 1, 1}, &weight);
    return weight;
  };
  EXPECT_EQ(weight_under(0.01), 1);
  EXPECT_LT(weight_under(1), 0.5f);
}

Findings findings_of(double value, const Geometry& geometry) {
  Products products;
  products.ao = Plane<float>(kWindow.width(), kWindow.height(), float(value));
  return take_findings(products, geometry, {});
}

void fuse(const Findings& own, const std::vector<const Findings*>& others, const Light& light,
          const Geometry& geometry, Products& products) {
  Fusion fusion(own, light);
  const std::vector<MovedPiece> nothing;
  std::vector<OtherFindings> all;
  for (const Findings* other : others) all.push_back({other, 1, &nothing, &nothing});
  fusion.add(all, true);
  fusion.finish(geometry, products);
}

TEST(Fusion, IsTheMeanAndKeepsWhatIsConstant) {
  const Geometry now = geometry_of(ball_at(0), camera(), kWindow);
  const Light light = model_light(Environment::constant(glm::vec3(1)), glm::mat3(1));
  const Findings own = findings_of(0.75, now), same = findings_of(0.75, now),
                 darker = findings_of(0.25, now);
  Products products;
  fuse(own, {&same}, light, now, products);
  for (const float ao : products.ao.pixels) EXPECT_EQ(ao, 0.75f);
  fuse(own, {&same, &darker, &darker}, light, now, products);
  for (std::size_t i = 0; i < products.ao.size(); ++i)
    EXPECT_NEAR(products.ao[i], now.is_surface(i) ? 0.5f : 0.75f, 1e-6f);
}

/// Not every frame shows small bright senders, whose light filters keep apart.
TEST(Fusion, JoinsTheLightOfSmallSenders) {
  const Geometry now = geometry_of(ball_at(0), camera(), kWindow);
  const auto light = [&](float value) {
    return Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(value));
  };
  Products with, without, fused;
  with.bounce = light(0.5f), with.visibility.emitted = light(2);
  without.bounce = light(0.5f);
  for (Products* products : {&with, &without, &fused}) products->lights.resize(1);
  with.lights[0].bounce = light(0.25f), with.lights[0].emitted = light(1);
  without.lights[0].bounce = light(0.25f);
  const Findings own = take_findings(with, now, {}), other = take_findings(without, now, {});
  fuse(own, {&other}, model_light(Environment::constant(glm::vec3(1)), glm::mat3(1)), now, fused);
  for (std::size_t i = 0; i < fused.bounce.size(); ++i) {
    if (!now.is_surface(i)) continue;
    EXPECT_NEAR(fused.bounce[i].x, 1.5f, 1e-3f);
    EXPECT_NEAR(fused.lights[0].bounce[i].x, 0.75f, 1e-3f);
  }
}

/// A bent normal is a direction of the world: seen by a camera that has rolled, it is the same.
TEST(Fusion, TurnsDirectionsWithTheCamera) {
  const auto rolled = [](double degrees) {
    const double a = degrees * 0.0174533;
    return look_at(camera_from_fov(45, kWindow, 1), {0, -4, 3}, {}, {std::sin(a), 0, std::cos(a)});
  };
  const glm::vec3 in_world = glm::normalize(glm::vec3(0.4f, -0.1f, 0.9f));
  const auto bent_of = [&](const Camera& camera, Geometry& geometry) {
    geometry = geometry_of(plane({}, {0, 0, 1}), camera, kWindow);
    const glm::vec3 bent = glm::mat3(camera.rotation) * in_world,
                    n = glm::mat3(camera.rotation) * glm::vec3(0, 0, 1), z(0, 0, 1), both = n + z;
    // As N is turned to the view axis.
    const glm::vec3 deviation =
        bent - glm::dot(both, bent) / (1 + glm::dot(n, z)) * both + 2 * glm::dot(n, bent) * z;
    Products products;
    products.bent = Plane<glm::vec3>(kWindow.width(), kWindow.height(), deviation);
    return products;
  };
  Geometry now, other;
  Products own_products = bent_of(rolled(0), now), other_products = bent_of(rolled(40), other);
  const glm::vec3 wanted = own_products.bent[2000];
  const Findings own = take_findings(own_products, now, {}),
                 told = take_findings(other_products, other, {});
  Products products;
  fuse(own, {&told, &told, &told}, model_light(Environment::constant(glm::vec3(1)), glm::mat3(1)),
       now, products);
  for (int y = 20; y < 50; ++y)
    for (int x = 30; x < 60; ++x)
      EXPECT_LT(glm::distance(products.bent(x, y), wanted), 0.002f) << x << " " << y;
}

}  // namespace
}  // namespace ssdo::test::moved_test
