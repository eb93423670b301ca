// SPDX-License-Identifier: Apache-2.0
#include "filters/temporal.h"
#include "filters/continuity.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "estimators/bitmask.h"
#include "filters/filter_products.h"
#include "filters/registry.h"
#include "parallel/tiles.h"
#include "support/analytic_scene.h"
#include "support/random_frame.h"
#include "support/scene_of.h"

namespace ssdo::test::temporal_test {
namespace {

const Window kWindow{0, 0, 64, 48};

/// A wall at z = 0, and before it the front of a card that is 1 wide, around x = `middle`.
Surface card_before_wall(double height, double middle = 0) {
  return all_of({plane({}, {0, 0, 1}),
                 cut(plane({0, 0, height}, {0, 0, 1}),
                     [=](const glm::dvec3& p) { return std::abs(p.x - middle) < 0.5; })});
}

Surface ground_and_ball() { return all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)}); }

Camera camera_at(const glm::dvec3& eye, const glm::dvec3& target = {},
                 const Window& window = kWindow) {
  return look_at(camera_from_fov(40, window, 1), eye, target, {0, 1, 0.1});
}

/// Feeds frames one after another.
class Sequence {
 public:
  const History& feed(const Geometry& geometry, const Products& now,
                      const Plane<glm::vec2>& motion = {}) {
    const bool first = history_.frames.empty();
    History next = accumulate(first ? nullptr : &history_, geometry, now, motion);
    history_ = std::move(next);
    history_.geometry = geometry;
    return history_;
  }

 private:
  History history_;
};

TEST(Temporal, ASequenceAtRestConvergesToTheMeanOfItsFrames) {
  const Geometry g = geometry_of(ground_and_ball(), camera_at({0, -4, 3}), kWindow);
  Sequence sequence;
  std::vector<Products> frames;
  History history;
  for (unsigned n = 0; n < 16; ++n) {
    frames.push_back(random_products(g, n));
    history = sequence.feed(g, frames.back());
  }
  // P in float lands on its pixel's centre to 1e-5 px, and the noise has steps of 2 beside it.
  constexpr double kRounding = 1e-4;
  const Products out = products_of(history);
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (!g.is_surface(i)) continue;
    double ao = 0, error = 0, reflection = 0;
    glm::dvec3 direct(0), bounce(0), bent(0);
    for (const Products& p : frames) {
      ao += p.ao[i] / 16.0, error += p.error[i] / 16.0, reflection += p.reflection[i] / 16.0;
      direct += glm::dvec3(p.direct[i]) / 16.0, bounce += glm::dvec3(p.bounce[i]) / 16.0;
      bent += glm::dvec3(p.bent[i]);
    }
    EXPECT_NEAR(out.ao[i], ao, kRounding);
    EXPECT_NEAR(out.reflection[i], reflection, kRounding);
    EXPECT_NEAR(out.error[i], error, kRounding);
    EXPECT_LT(difference(out.direct[i], direct), kRounding);
    EXPECT_LT(difference(out.bounce[i], bounce), kRounding);
    EXPECT_LT(difference(out.bent[i], glm::normalize(bent)), kRounding);
    EXPECT_NEAR(history.frames[i], 16, 1e-4);
  }
  // From then on it forgets: the 17th frame counts 1/16.
  const Products last = random_products(g, 99);
  const Products later = products_of(sequence.feed(g, last));
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    if (!g.is_surface(i)) continue;
    EXPECT_NEAR(later.ao[i], out.ao[i] * 15 / 16 + last.ao[i] / 16, kRounding);
  }
}

/// The formula at the top of temporal.cpp for ao, through the world and in double.
struct Expected {
  double ao, frames;
};
Expected slow(const History& before, const Geometry& g, const Products& now, std::size_t i,
              const Plane<glm::vec2>& motion) {
  const Geometry& b = before.geometry;
  const auto world = [](const Camera& c, const glm::vec3& p) {
    return c.origin + glm::transpose(c.rotation) * glm::dvec3(p);
  };
  const auto turned = [](const Camera& c, const glm::vec3& n) {
    return glm::transpose(c.rotation) * glm::dvec3(n);
  };
  const Surfel& s = g.surfaces[i];
  const glm::dvec3 p = world(g.camera, s.position), n = turned(g.camera, s.normal),
                   seen = b.camera.to_camera(p);
  glm::dvec2 at = b.camera.project(seen);
  const double pixel = b.camera.orthographic ? 1 / b.camera.fx : -seen.z / b.camera.fx;
  double way = 0;
  if (!motion.empty() && !std::isnan(motion[i].x)) {
    const glm::dvec2 told(g.window.x0 + int(i) % motion.width + 0.5 + double(motion[i].x),
                          g.window.y0 + int(i) / motion.width + 0.5 + double(motion[i].y));
    way = glm::length(told - at) * pixel;
    at = told;
  }
  double weights = 0, ao = 0, frames = 0;
  for (int y = 0; y < b.surfaces.height; ++y) {
    for (int x = 0; x < b.surfaces.width; ++x) {
      const double weight = std::max(0.0, 1 - std::abs(at.x - (b.window.x0 + x + 0.5))) *
                            std::max(0.0, 1 - std::abs(at.y - (b.window.y0 + y + 0.5)));
      const std::size_t k = b.surfaces.index(x, y);
      if (weight == 0 || !b.is_surface(k)) continue;
      const Surfel& q = b.surfaces[k];
      const glm::dvec3 away = world(b.camera, q.position) - p, m = turned(b.camera, q.normal);
      const double limit = pixel / 2 + s.rounding + q.rounding + 2 * way;
      if (glm::dot(n, m) < 0.9 || std::abs(glm::dot(n, away)) > limit ||
          std::abs(glm::dot(m, away)) > limit)
        continue;
      weights += weight;
      ao += weight * before.mean.ao[k];
      frames += weight * before.frames[k];
    }
  }
  if (weights < 0.1) return {now.ao[i], 1};
  const double count = std::min(frames / weights, 15.0);
  return {(count * ao / weights + now.ao[i]) / (count + 1), count + 1};
}

glm::dvec3 world(const Geometry& g, std::size_t i) {
  return g.camera.origin + glm::transpose(g.camera.rotation) * glm::dvec3(g.surfaces[i].position);
}

/// How far from its pixel a point of the world was in the picture before.
glm::vec2 motion_to(const Geometry& before, const glm::dvec3& point, const Geometry& g,
                    std::size_t i) {
  const glm::dvec2 centre(g.window.x0 + int(i) % g.surfaces.width + 0.5,
                          g.window.y0 + int(i) / g.surfaces.width + 0.5);
  return glm::vec2(before.camera.project(before.camera.to_camera(point)) - centre);
}

/// About what the cameras say, and a tenth of it unknown.
Plane<glm::vec2> random_motion(const Geometry& before, const Geometry& g, unsigned seed) {
  Random random(seed);
  Plane<glm::vec2> motion(g.surfaces.width, g.surfaces.height);
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const float size = between(random, 0, 1) < 0.5f ? 0.1f : 3;
    motion[i] = motion_to(before, world(g, i), g, i) + glm::vec2(vector_of(random, size));
    if (between(random, 0, 1) < 0.1f) motion[i] = glm::vec2(NAN);
  }
  return motion;
}

TEST(Temporal, IsItsFormulaUnderMovingCamerasAndThings) {
  for (const int variant : {0, 1, 2, 3}) {
    const bool orthographic = variant % 2, motion_layer = variant > 1;
    SCOPED_TRACE(variant);
    const auto camera = [&](int n) {
      const Camera projection =
          orthographic ? camera_from_ortho_width(4, kWindow, 1) : camera_from_fov(40, kWindow, 1);
      return look_at(projection, {0.23 * n, -4 + 0.1 * n, 3}, {0.1 * n, 0, 0.3}, {0.1 * n, 0, 1});
    };
    History before;
    std::size_t continued = 0, begun = 0;
    for (int n = 0; n < 4; ++n) {
      const Geometry g = geometry_of(ground_and_ball(), camera(n), kWindow);
      const Products now = random_products(g, unsigned(n));
      const Plane<glm::vec2> motion = motion_layer && n > 0
                                          ? random_motion(before.geometry, g, unsigned(n))
                                          : Plane<glm::vec2>();
      History after = accumulate(n > 0 ? &before : nullptr, g, now, motion);
      for (std::size_t i = 0; n > 0 && i < g.surfaces.size(); ++i) {
        if (!g.is_surface(i)) {
          EXPECT_EQ(after.mean.ao[i], now.ao[i]);
          continue;
        }
        const Expected expected = slow(before, g, now, i, motion);
        EXPECT_NEAR(after.mean.ao[i], expected.ao, 1e-4) << n << " " << i;
        EXPECT_NEAR(after.frames[i], expected.frames, 1e-4);
        (after.frames[i] > 1 ? continued : begun) += 1;
      }
      before = std::move(after);
      before.geometry = g;
    }
    EXPECT_GT(continued, 3000u);
    EXPECT_GT(begun, 100u);
  }
}

/// 0 on the card, 1 on the wall.
Products card_is_dark(const Geometry& g, double height) {
  Products p;
  p.ao = Plane<float>(g.surfaces.width, g.surfaces.height, 1.0f);
  const glm::dmat3 to_world = glm::transpose(g.camera.rotation);
  for (std::size_t i = 0; i < p.ao.size(); ++i) {
    const double z = (g.camera.origin + to_world * glm::dvec3(g.surfaces[i].position)).z;
    if (g.is_surface(i) && z > height / 2) p.ao[i] = 0;
  }
  return p;
}

TEST(Temporal, NothingIsLeftBehindASilhouetteThatMoves) {
  // The card is held a few pixels' width above the wall, and well above it; seen from above and at
  // a grazing angle, where a pixel's width spans more than the height.
  for (const double height : {0.3, 2.0}) {
    for (const glm::dvec3& eye : {glm::dvec3(0, -0.5, 6), glm::dvec3(0, -6, 2.5)}) {
      for (const bool card_moves : {false, true}) {
        SCOPED_TRACE(testing::Message() << height << " from " << eye.z << " " << card_moves);
        Sequence sequence;
        std::size_t begun = 0, continued = 0;
        for (int n = 0; n < 8; ++n) {
          const double step = 0.13 * n;
          const Geometry g =
              geometry_of(card_before_wall(height, card_moves ? step : 0),
                          camera_at(eye + glm::dvec3(card_moves ? 0 : step, 0, 0)), kWindow);
          const Products now = card_is_dark(g, height);
          const History& history = sequence.feed(g, now);
          EXPECT_EQ(history.mean.ao.pixels, now.ao.pixels) << "frame " << n;
          for (std::size_t i = 0; n == 7 && i < g.surfaces.size(); ++i)
            (history.frames[i] > 1 ? continued : begun) += g.is_surface(i);
        }
        EXPECT_GT(begun, height > 1 ? 20u : 2u) << "the silhouette reveals nothing";
        EXPECT_GT(continued, 1000u) << "there is no history at all";
      }
    }
  }
}

/// A ball over the ground, under a camera that moves too.
struct MovingBall {
  static constexpr double kSize = 0.8;
  glm::dvec3 step;  ///< per frame

  glm::dvec3 centre(int n) const { return glm::dvec3(-0.4, -0.3, 1) + double(n) * step; }
  Geometry geometry(int n) const {
    return geometry_of(all_of({plane({}, {0, 0, 1}), sphere(centre(n), kSize)}),
                       camera_at({0.05 * n, -4 + 0.1 * n, 3}, {0.04 * n, 0, 0.3}), kWindow);
  }
  bool shows_ball(const Geometry& g, std::size_t i, int n) const {
    return g.is_surface(i) && std::abs(glm::length(world(g, i) - centre(n)) - kSize) < 1e-4;
  }
  Plane<glm::vec2> motion(const Geometry& before, const Geometry& g, int n) const {
    Plane<glm::vec2> motion(g.surfaces.width, g.surfaces.height);
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const glm::dvec3 now = world(g, i);
      motion[i] = motion_to(before, shows_ball(g, i, n) ? now - step : now, g, i);
    }
    return motion;
  }
  /// A texture on the ball that moves with it, linear so that it can be interpolated.
  double texture(const Geometry& g, std::size_t i, int n) const {
    const glm::dvec3 on_ball = world(g, i) - centre(n);
    return 0.5 + glm::dot(on_ball, glm::dvec3(0.3, 0.1, 0.3));
  }
};

TEST(Temporal, MotionCarriesTheHistoryOfWhatMoves) {
  for (const glm::dvec3& step :
       {glm::dvec3(0.15, 0, 0), glm::dvec3(0, 0.05, 0.15), glm::dvec3(-0.1, -0.12, 0.05)}) {
    const MovingBall ball{step};
    Sequence with, without;
    Geometry before;
    double worst = 0, worst_without = 0;
    std::size_t kept = 0, kept_without = 0, inside = 0;
    for (int n = 0; n < 6; ++n) {
      const Geometry g = ball.geometry(n);
      Products now;
      now.ao = Plane<float>(g.surfaces.width, g.surfaces.height, 1.0f);
      for (std::size_t i = 0; i < now.ao.size(); ++i)
        if (ball.shows_ball(g, i, n)) now.ao[i] = float(ball.texture(g, i, n));
      const History& carried =
          with.feed(g, now, n > 0 ? ball.motion(before, g, n) : Plane<glm::vec2>());
      const History& rejected = without.feed(g, now);
      before = g;
      for (std::size_t i = 0; n == 5 && i < now.ao.size(); ++i) {
        if (!ball.shows_ball(g, i, n)) {
          EXPECT_EQ(carried.mean.ao[i], now.ao[i]) << "left behind on the ground";
          continue;
        }
        // Away from the rim, where the ball is seen at a grazing angle and turns into sight.
        if (g.surfaces[i].normal.z < 0.6f) continue;
        inside += 1;
        kept += carried.frames[i] > 5.9f;
        kept_without += rejected.frames[i] > 5.9f;
        worst = std::max(worst, std::abs(double(carried.mean.ao[i] - now.ao[i])));
        worst_without = std::max(worst_without, std::abs(double(rejected.mean.ao[i] - now.ao[i])));
      }
    }
    // 0.0027 of the texture is what interpolation on a curved thing costs in five steps.
    EXPECT_LT(worst, 0.004);
    EXPECT_GT(inside, 150u);
    EXPECT_GT(double(kept), 0.95 * double(inside));
    EXPECT_LT(double(kept_without), 0.5 * double(inside));
  }
}

TEST(Temporal, MotionOfOtherUnitsOrSignsContradictsTheCameras) {
  const MovingBall ball{{0.15, 0, 0.1}};
  const Geometry a = ball.geometry(0), b = ball.geometry(1);
  const Plane<glm::vec2> motion = ball.motion(a, b, 1);
  EXPECT_FALSE(contradicts_cameras(a, b, motion));
  for (const glm::vec2& scale : {glm::vec2(-1, 1), glm::vec2(1, -1), glm::vec2(-1, -1),
                                 glm::vec2(2, 2), glm::vec2(0.5f, 0.5f)}) {
    Plane<glm::vec2> wrong = motion;
    for (glm::vec2& to : wrong.pixels) to *= scale;
    EXPECT_TRUE(contradicts_cameras(a, b, wrong)) << scale.x << ", " << scale.y;
  }
  // A camera at rest says nothing of what moves.
  EXPECT_FALSE(contradicts_cameras(a, a, Plane<glm::vec2>(64, 48, glm::vec2(5, 5))));
}

TEST(Temporal, DirectionsTurnWithTheCamera) {
  const glm::dvec3 bent = glm::normalize(glm::dvec3(0.3, -0.2, 1));  // in the world
  Sequence sequence;
  for (int n = 0; n < 5; ++n) {
    const Camera camera =
        look_at(camera_from_fov(40, kWindow, 1), {0.2 * n, -4, 3}, {0, 0, 0.3}, {0.2 * n, 0, 1});
    const Geometry g = geometry_of(ground_and_ball(), camera, kWindow);
    Products now;
    now.bent = Plane<glm::vec3>(64, 48, glm::vec3(camera.rotation * bent));
    const Products out = products_of(sequence.feed(g, now));
    for (std::size_t i = 0; i < g.surfaces.size(); ++i)
      EXPECT_LT(difference(out.bent[i], camera.rotation * bent), 1e-6);
  }
}

TEST(Temporal, TakesNoHistoryThatItCannotPlace) {
  const Geometry g = geometry_of(ground_and_ball(), camera_at({0, -4, 3}), kWindow);
  Geometry lost = g;
  lost.world_known = false;
  const Products a = random_products(g, 1), b = random_products(g, 2);
  Products only_ao;
  only_ao.ao = b.ao;
  const auto second = [&](const Geometry& first, const Geometry& then, const Products& now) {
    Sequence sequence;
    sequence.feed(first, a);
    return sequence.feed(then, now).mean.ao.pixels;
  };
  EXPECT_NE(second(g, g, b), b.ao.pixels);
  EXPECT_EQ(second(lost, g, b), b.ao.pixels);
  EXPECT_EQ(second(g, lost, b), b.ao.pixels);
  EXPECT_EQ(second(g, g, only_ao), b.ao.pixels);
  Geometry behind = g;  // a camera that looks away sees none of it
  behind.camera.rotation = glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, -1) * g.camera.rotation;
  EXPECT_EQ(second(behind, g, b), b.ao.pixels);
}

TEST(Temporal, TakesNothingFromTheBackgroundBeItBroken) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Geometry g = geometry_of(sphere({}, 1), camera_at({0, 0, 6}), kWindow),
                 moved = geometry_of(sphere({}, 1), camera_at({0.2, 0, 6}), kWindow);
  Products p = random_products(g, 3);
  for (std::size_t i = 0; i < p.ao.size(); ++i) {
    if (!g.is_surface(i)) p.ao[i] = nan;
  }
  Sequence sequence;
  sequence.feed(g, p);
  const History& history = sequence.feed(moved, random_products(moved, 4));
  for (const float ao : history.mean.ao.pixels) EXPECT_TRUE(ao >= 0 && ao <= 1) << ao;
}

TEST(Temporal, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Sequence sequence;
    History last;
    for (int n = 0; n < 3; ++n) {
      const Geometry g = geometry_of(ground_and_ball(), camera_at({0.2 * n, -4, 3}), kWindow);
      last = sequence.feed(g, random_products(g, unsigned(n)));
    }
    return last;
  };
  const History one = run(1), four = run(4);
  EXPECT_EQ(one.mean.ao.pixels, four.mean.ao.pixels);
  EXPECT_EQ(one.mean.bent.pixels, four.mean.bent.pixels);
  EXPECT_EQ(one.frames.pixels, four.frames.pixels);
}

/// Root mean square of the difference between the pixels of a frame and the nearest ones of the
/// frame before that show the same point of the world.
class Flicker {
 public:
  void add(const Geometry& g, const Plane<float>& ao) {
    for (std::size_t i = 0; !before_.empty() && i < ao.size(); ++i) {
      if (!g.is_surface(i)) continue;
      const glm::dvec3 p = world(g, i);
      const glm::dvec2 at = geometry_.camera.project(geometry_.camera.to_camera(p));
      const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
      if (!geometry_.window.contains(x, y)) continue;
      const std::size_t k = ao.index(x, y);
      if (!geometry_.is_surface(k) || glm::length(world(geometry_, k) - p) > 0.1) continue;
      sum_ += (ao[i] - before_[k]) * (ao[i] - before_[k]);
      ++count_;
    }
    geometry_ = g;
    before_ = ao;
  }
  double rms() const { return std::sqrt(sum_ / double(count_)); }

 private:
  Geometry geometry_;
  Plane<float> before_;
  double sum_ = 0;
  std::size_t count_ = 0;
};

/// Occlusion as draft quality finds it, not filtered.
Products occlusion(const Geometry& g, unsigned seed) {
  Scene scene = scene_of(g);
  scene.solids = guess_solids(g);
  return bitmask_method().estimate(
      scene, {.products = {.ao = true}, .radius = 1.5f, .seed = seed, .slices = 2, .steps = 10},
      {});
}

TEST(Temporal, TakesTheFlickerOfNoiseAwayUnderAMovingCamera) {
  Flicker noisy, steady, noisy_filtered, steady_filtered;
  Sequence sequence, filtered_sequence;
  for (int n = 0; n < 12; ++n) {
    // Some pixels per frame, so that the pattern's members change places.
    const double x = -0.6 + 0.11 * n;
    const Camera camera =
        look_at(camera_from_fov(40, kWindow, 1), {x, -4, 3}, {x, 0, 0.3}, {0, 0, 1});
    const Geometry g = geometry_of(ground_and_ball(), camera, kWindow);
    // Without --temporal every frame has the same pattern.
    const Products alone = occlusion(g, 0), turned = occlusion(g, unsigned(n));
    noisy.add(g, alone.ao);
    noisy_filtered.add(g, filter_products(find_filter("geometry"), alone, g.surfaces, 4).ao);
    steady.add(g, sequence.feed(g, turned).mean.ao);
    steady_filtered.add(
        g,
        filtered_sequence.feed(g, filter_products(find_filter("geometry"), turned, g.surfaces, 4))
            .mean.ao);
  }
  EXPECT_LT(steady.rms(), noisy.rms() / 2.5) << noisy.rms();
  // What the filter leaves is for a good part no noise: shadows that move over the pixel grid.
  EXPECT_LT(steady_filtered.rms(), noisy_filtered.rms() / 1.4) << noisy_filtered.rms();
}

}  // namespace
}  // namespace ssdo::test::temporal_test
