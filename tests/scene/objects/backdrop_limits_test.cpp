// SPDX-License-Identifier: Apache-2.0
//
// The limits of backdrops, each from both sides: surfaces are laid out by pixel or by sample, so
// that one share or distance alone differs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "scene/objects/backdrop.h"
#include "scene/objects/standing_backdrop.h"
#include "support/analytic_scene.h"

namespace ssdo::test::backdrop_limits_test {
namespace {

constexpr Window kWindow{0, 0, 160, 90};

Surfel surfel_at(const glm::dvec3& position, const glm::dvec3& normal) {
  return {glm::vec3(position), glm::vec3(glm::normalize(normal)), 0};
}

/// 0..1, the same in every run.
double noise(int x, int y) {
  std::uint32_t h = std::uint32_t(x) * 73856093u ^ std::uint32_t(y) * 19349663u;
  h = (h ^ (h >> 13)) * 0x5bd1e995u;
  return double((h ^ (h >> 15)) % 10007u) / 10007;
}

/// A normal of nothing flat.
glm::dvec3 rough(int x, int y, const glm::dvec3& to_viewer) {
  return to_viewer + glm::dvec3(noise(x, y + 1000), noise(x, y + 2000), noise(x, y + 3000)) * 2.4 -
         1.2;
}

/// What a pixel shows, by the unit direction that it looks in; nothing: sky.
using Paint = std::function<std::optional<Surfel>(int x, int y, const glm::dvec3& direction)>;

Geometry painted(const Paint& paint, double fov = 55) {
  Geometry g = geometry_of(
      all_of({}), look_at(camera_from_fov(fov, kWindow, 1), {0, -6, 2}, {0, 0, 2}, {0, 0, 1}),
      kWindow);
  for (int y = 0; y < kWindow.height(); ++y)
    for (int x = 0; x < kWindow.width(); ++x)
      if (const auto s = paint(x, y, glm::normalize(g.camera.ray({x + 0.5, y + 0.5}).direction)))
        g.surfaces.set(x, y, *s);
  return g;
}

/// A set `near` away in this share of the rows, the lower ones, before what `far` paints.
Geometry with_set(double share, double near, const Paint& far, double fov = 55) {
  return painted(
      [&](int x, int y, const glm::dvec3& d) -> std::optional<Surfel> {
        if (y >= (1 - share) * kWindow.height()) return surfel_at(near * d, rough(x, y, -d));
        return far(x, y, d);
      },
      fov);
}

/// A card this far ahead.
Paint card(double away) {
  return [away](int, int, const glm::dvec3& d) {
    return surfel_at(-away / d.z * d, glm::dvec3(0, 0, 1));
  };
}

bool is_far(const Geometry& g) {
  const auto found = find_backdrop(g);
  return found && found->is_far();
}

/// Four fifths of the far surfaces lie on a dome, within 2 % of its radius.
TEST(BackdropLimits, Domes) {
  const auto is_dome = [](const Geometry& g) {
    const auto found = find_backdrop(g);
    return found && found->what.starts_with("a dome");
  };
  const auto ragged = [](double off) {
    return with_set(
        0.5, 5,
        [off](int x, int y, const glm::dvec3& d) {
          const double at = noise(x, y) < off ? 465 + 15 * noise(x, y + 500) : 500;
          return surfel_at(at * d, -d);
        },
        110);
  };
  EXPECT_TRUE(is_dome(ragged(0.15)));
  EXPECT_FALSE(is_dome(ragged(0.3)));
  EXPECT_TRUE(is_far(with_set(
      0.5, 5,
      [](int x, int y, const glm::dvec3& d) {
        return surfel_at(((x + y) % 2 ? 492.5 : 507.5) * d, -d);
      },
      110)));
  // The inside of a sphere whose nearest part alone is seen.
  EXPECT_FALSE(is_dome(with_set(0.5, 5, [](int, int, const glm::dvec3& d) {
    const glm::dvec3 middle(0, 0, 350);
    const double along = glm::dot(d, middle),
                 t = along + std::sqrt(along * along + 500.0 * 500 - 350.0 * 350);
    return surfel_at(t * d, middle - t * d);
  })));
}

/// From a gap of two on a card is asked about; a fifth of the surfaces are before it, and one of
/// 200 may be in it.
TEST(BackdropLimits, Gaps) {
  const auto close = find_backdrop(with_set(0.5, 10, card(30)));
  ASSERT_TRUE(close);
  EXPECT_NEAR(close->clearance, 0.3, 0.01);
  EXPECT_FALSE(find_backdrop(with_set(0.5, 10, card(15))));
  EXPECT_TRUE(is_far(with_set(0.25, 10, card(600))));
  EXPECT_FALSE(is_far(with_set(0.15, 10, card(600))));
  const auto with_birds = [](int count) {
    return with_set(0.5, 10, [count](int x, int y, const glm::dvec3& d) {
      return x == 80 && y < count ? surfel_at(80.0 * d, rough(x, y, -d)) : *card(600)(x, y, d);
    });
  };
  EXPECT_TRUE(is_far(with_birds(44)));
  EXPECT_FALSE(is_far(with_set(0.5, 10, [](int x, int y, const glm::dvec3& d) {
    return x / 3 == 26 && y < 33 ? surfel_at(80.0 * d, rough(x, y, -d)) : *card(600)(x, y, d);
  })));
}

/// Sky above a tenth of its columns.
TEST(BackdropLimits, SkyAbove) {
  const auto open = [](int columns) {
    return with_set(0.5, 10, [columns](int x, int y, const glm::dvec3& d) {
      return x < columns && y < 5 ? std::nullopt : card(600)(x, y, d);
    });
  };
  EXPECT_TRUE(is_far(open(12)));
  EXPECT_FALSE(is_far(open(24)));
}

/// One of 64 samples is tried for a plane, and five planes are a box.
TEST(BackdropLimits, Planes) {
  SurfelSamples few;
  for (int i = 0; i < 1600; ++i) {
    const glm::dvec3 at(noise(i, 1) - 0.5, noise(i, 2) - 0.5, -10 - 0.01 * i);
    few.push_back(i >= 52 && i < 82 ? surfel_at({at.x, at.y, -5}, {0, 0, 1})
                                    : surfel_at(at, rough(i, 3, {0, 0, 1})));
  }
  const auto flat = flat_of(few);
  ASSERT_TRUE(flat);
  EXPECT_NEAR(flat->distance, 5, 0.1);
  SurfelSamples six;
  for (int i = 0; i < 180; ++i)
    six.push_back(surfel_at({0.01 * i, 0, -10 * std::pow(1.3, i / 30)}, {0, 0, 1}));
  SurfelSamples left = six;
  EXPECT_EQ(take_flats(left, 0.99, [](const Flat&) { return true; }).size(), 5u);
  EXPECT_EQ(left.size(), 30u);
}

/// A frame is looked at in 96 columns and rows.
TEST(BackdropLimits, SamplesOfAFrame) {
  Geometry g = painted(card(10));
  g.surfaces = Surfaces(288, 192, surfel_at({0, 0, -1}, {0, 0, 1}));
  EXPECT_EQ(samples_of(g).size(), 96u * 96u);
}

/// Half of the radius away from what is seen of a cylinder.
TEST(BackdropLimits, Cylinders) {
  for (const double away : {0.4, 0.6}) {
    const RoundShape round{{0, 1, 0}, {0, 0, 1 - away}, 1};
    SurfelSamples wall;
    for (int i = 0; i < 100; ++i) {
      const double a = 0.1 * (noise(i, 1) - 0.5);
      const glm::dvec3 on(std::sin(a), 0, -std::cos(a));
      wall.push_back(surfel_at(round.middle + on + glm::dvec3(0, noise(i, 2), 0), -on));
    }
    EXPECT_EQ(is_cylinder_around(round, wall, 0.8), away > 0.5);
  }
}

/// A ground 1 below the camera, and a card 200 ahead.
struct Stage {
  std::function<double(double)> height = [](double t) { return 60 * t; };  ///< of its samples
  double tilt = 0;  ///< of the card: slope against the vertical
  int ground = 500, card = 1000;
  int things = 0;  ///< samples of something in between
  double things_height = 0, things_away = 50;
};

std::optional<BackdropShape> found_on(const Stage& stage) {
  SurfelSamples out;
  for (int i = 0; i < stage.ground; ++i)
    out.push_back(
        surfel_at({noise(i, 1) - 0.5, -1, -2 - 90 * (i + 0.5) / stage.ground}, {0, 1, 0}));
  for (int i = 0; i < stage.card; ++i) {
    const double y = stage.height((i + 0.5) / stage.card) - 1;
    out.push_back(
        surfel_at({300 * noise(i, 2) - 150, y, -200 - stage.tilt * y}, {0, stage.tilt, 1}));
  }
  for (int i = 0; i < stage.things; ++i)
    out.push_back(surfel_at(
        {10 * noise(i, 3), stage.things_height - 1, -stage.things_away * (1 + 0.1 * noise(i, 4))},
        rough(i, 5, {0, 0, 1})));
  return find_standing_backdrop(out);
}

bool is_far(const Stage& stage) {
  const auto found = found_on(stage);
  return found && found->clearance >= 1;
}

/// Where the ground ends before it, a card is seen to half the height of the camera below it. One
/// sample of 200 may be lower.
TEST(BackdropLimits, CardsBelowTheGround) {
  const auto from = [](double lowest) {
    return Stage{.height = [=](double t) { return t < 0.02 ? lowest : 60 * t; }};
  };
  EXPECT_TRUE(is_far(from(-0.35)));
  EXPECT_FALSE(is_far(from(-0.7)));
  const auto strays = [](double share) {
    return Stage{.height = [=](double t) { return t < share ? -0.9 : 60 * t; }};
  };
  EXPECT_TRUE(is_far(strays(0.003)));
  EXPECT_FALSE(is_far(strays(0.008)));
}

/// Thirty heights of the camera at least, by what a twentieth of it exceeds, and twice as high as
/// all else but 2 %.
TEST(BackdropLimits, HeightsOfCards) {
  EXPECT_TRUE(is_far(Stage{.height = [](double t) { return 40 * t; }}));
  EXPECT_FALSE(is_far(Stage{.height = [](double t) { return 25 * t; }}));
  EXPECT_TRUE(is_far(Stage{.height = [](double t) { return t < 0.9 ? 10 * t : 60; }}));
  EXPECT_FALSE(is_far(Stage{.height = [](double t) { return t < 0.97 ? 10 * t : 60; }}));
  EXPECT_TRUE(is_far(Stage{.things = 100, .things_height = 20}));
  EXPECT_FALSE(is_far(Stage{.things = 100, .things_height = 40}));
  EXPECT_TRUE(is_far(Stage{.things = 24, .things_height = 60}));
}

/// 2 % of the samples are a ground. What is nearer than half of the farthest is no part of a
/// backdrop; a card is within 6 degrees of upright.
TEST(BackdropLimits, CardsAndTheirGround) {
  EXPECT_TRUE(is_far(Stage{.ground = 90, .card = 2910}));
  EXPECT_FALSE(is_far(Stage{.ground = 45, .card = 2955}));
  EXPECT_TRUE(is_far(Stage{.things = 350, .things_height = 5, .things_away = 70}));
  const auto is_card = [](double tilt) {
    const auto found = found_on(Stage{.tilt = tilt});
    return found && found->what.starts_with("a card");
  };
  EXPECT_TRUE(is_card(0.07));
  EXPECT_FALSE(is_card(0.15));
}

/// The arc of a sweep has one radius, within a tenth.
TEST(BackdropLimits, Sweeps) {
  const auto is_sweep = [](double off) {
    SurfelSamples out;
    for (int i = 0; i < 500; ++i)
      out.push_back(surfel_at({noise(i, 1) - 0.5, -1, -2 - 90 * (i + 0.5) / 500}, {0, 1, 0}));
    for (int i = 0; i < 600; ++i) {
      const double a = (i + 0.5) / 600 * 1.5707963, up = std::cos(a), front = std::sin(a),
                   radius = 80 * (1 + (i % 3 - 1) * off);
      out.push_back(
          surfel_at({40 * noise(i, 2) - 20, radius * (1 - up) - 1, radius * (1 - front) - 200},
                    {0, up, front}));
    }
    for (int i = 0; i < 400; ++i)
      out.push_back(surfel_at({40 * noise(i, 3) - 20, 80 + 70 * noise(i, 4), -200}, {0, 0, 1}));
    const auto found = find_standing_backdrop(out);
    return found && found->what.starts_with("a sweep");
  };
  EXPECT_TRUE(is_sweep(0));
  EXPECT_TRUE(is_sweep(0.07));
  EXPECT_FALSE(is_sweep(0.15));
}

}  // namespace
}  // namespace ssdo::test::backdrop_limits_test
