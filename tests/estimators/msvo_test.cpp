// SPDX-License-Identifier: Apache-2.0
#include "estimators/msvo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "estimators/obscurance_request.h"
#include "estimators/slow_msvo.h"

namespace ssdo::test::msvo_test {
namespace {

const Window kWindow{0, 0, 210, 140};

Products run(const Geometry& g, const std::vector<std::string>& set = {}) {
  return obscure(msvo_method(), g, 1, set);
}

Geometry still_life_in(const Window& window, const Camera& projection) {
  return geometry_of(still_life(), look_at(projection, {1, -4, 3}, {0, 0.2, 0.4}, {0, 0, 1}),
                     window);
}

double mean(const Plane<float>& plane) {
  double sum = 0;
  for (const float v : plane.pixels) sum += v;
  return sum / double(plane.size());
}

/// All but the pixels in which three depths are in line or not by rounding alone.
void expect_the_slow_evaluation(const Plane<double>& slow, const Plane<float>& ao) {
  int off = 0;
  double worst = 0;
  for (std::size_t i = 0; i < ao.size(); ++i) {
    const double error = std::abs(double(ao[i]) - slow[i]);
    worst = std::max(worst, error);
    off += error > 2e-5;
  }
  EXPECT_LE(off, int(ao.size()) / 500) << "of " << ao.size();
  EXPECT_LT(worst, 0.02);
}

TEST(Msvo, IsTheSourcesEvaluation) {
  for (const Window& window : {kWindow, Window{-13, 22, 160, 151}}) {
    for (const Camera& projection :
         {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(5, kWindow, 1)}) {
      Geometry g = still_life_in(window, projection);
      g.display = {0, 0, 300, 200};
      const Products out = run(g);
      expect_the_slow_evaluation(SlowMsvo(g).ao(), out.ao);
      EXPECT_LT(mean(out.ao), 0.95);
      EXPECT_GT(mean(out.ao), 0.3);
    }
  }
}

TEST(Msvo, ItsParametersAreThoseOfTheSource) {
  const Geometry g = still_life_in(kWindow, camera_from_fov(50, kWindow, 1));
  SlowMsvo slow(g);
  slow.intensity = 1.7, slow.thickness = 4, slow.far = 20;
  slow.noise = -4, slow.blur = -2, slow.tolerance = -3;
  const Products out = run(g, {"intensity=1.7", "thickness=4", "far=20", "noise-tolerance=-4",
                               "blur-tolerance=-2", "upsample-tolerance=-3"});
  expect_the_slow_evaluation(slow.ao(), out.ao);
  // Each of them does something.
  for (const char* without : {"intensity=1", "thickness=1", "far=1000", "noise-tolerance=0",
                              "blur-tolerance=-4.6", "upsample-tolerance=-12"}) {
    const Products other = run(g, {"intensity=1.7", "thickness=4", "far=20", "noise-tolerance=-4",
                                   "blur-tolerance=-2", "upsample-tolerance=-3", without});
    double difference = 0;
    for (std::size_t i = 0; i < other.ao.size(); ++i)
      difference = std::max(difference, double(std::abs(other.ao[i] - out.ao[i])));
    EXPECT_GT(difference, 1e-3) << without;
  }
}

TEST(Msvo, AnOpenPlaneReadsOneInTheMiddleOfALargeFrame) {
  // 320 pixels away from the border, where the widest sphere ends.
  const Window window{0, 0, 720, 704};
  for (const Camera& projection :
       {camera_from_fov(40, window, 1), camera_from_ortho_width(6, window, 1)}) {
    for (const double tilt : {0.0, 30.0, 60.0, 80.0}) {
      const Geometry g = geometry_of(plane({}, {0, 0, 1}), tilted(projection, tilt), window);
      const Products out = run(g);
      // Seen in perspective, depth bends along a tilted plane: what the far side gains is more
      // than what the near side loses, and clamped.
      EXPECT_NEAR(out.ao(360, 352), 1, 1e-5) << tilt;
      if (tilt == 0) {
        EXPECT_NEAR(mean(out.ao), 1, 1e-6);
      }
    }
  }
}

TEST(Msvo, APlaneEndsWithTheFrame) {
  // At the lower border of a tilted plane nothing pays for what the far side takes away.
  const Geometry g = geometry_of(plane({}, {0, 0, 1}),
                                 tilted(camera_from_ortho_width(6, kWindow, 1), 60), kWindow);
  const Products out = run(g);
  EXPECT_NEAR(out.ao(105, 139), 1, 1e-4) << "below it would be nearer";
  EXPECT_LT(out.ao(105, 0), 0.9f) << "above it would be farther";
}

TEST(Msvo, TheFootOfAWallIsDarkerThanTheFloor) {
  const Geometry g = still_life_in(kWindow, camera_from_fov(50, kWindow, 1));
  const Products out = run(g);
  const auto at = [&](const glm::dvec3& p) {
    const glm::dvec2 px = g.camera.project(g.camera.to_camera(p));
    return out.ao(int(px.x), int(px.y));
  };
  EXPECT_LT(at({-0.7, 0.98, 0}), at({-0.7, 0.5, 0}) - 0.05f);
  EXPECT_LT(at({-0.7, 0.5, 0}), at({-0.7, -0.5, 0}));
}

/// A strip far in front of a floor.
Geometry strip_before_floor() {
  const Surface strip =
      cut(plane({0, 0, 100}, {0, 0, 1}), [](const glm::dvec3& p) { return std::abs(p.x) < 0.5; });
  return geometry_of(all_of({plane({}, {0, 0, 1}), strip}),
                     tilted(camera_from_ortho_width(10, kWindow, 1), 0, 200), kWindow);
}

TEST(Msvo, ADistantForegroundIsForgivenWhereItIsOutOfReach) {
  for (const float ao : run(strip_before_floor()).ao.pixels) EXPECT_NEAR(ao, 1, 1e-6);
  // A chord of the widest sphere is at most 30 units long: ten of them reach the strip.
  const Plane<float> halos = run(strip_before_floor(), {"thickness=10"}).ao;
  EXPECT_LT(*std::min_element(halos.pixels.begin(), halos.pixels.end()), 0.95f)
      << "the known fault";
}

TEST(Msvo, ConstantLightIsThatColourTimesAo) {
  const Geometry g = still_life_in(kWindow, camera_from_fov(50, kWindow, 1));
  const glm::vec3 color(0.25f, 1, 8);
  const Products out = obscure(msvo_method(), g, 1, {}, Environment::constant(color));
  for (std::size_t i = 0; i < out.ao.size(); ++i)
    EXPECT_EQ(out.direct[i], g.is_surface(i) ? out.ao[i] * color : glm::vec3(0));
}

TEST(Msvo, InstructionSetsAndThreadsDoNotMatter) {
  const Geometry g = still_life_in(kWindow, camera_from_fov(50, kWindow, 1));
  const auto ao = [&] { return run(g).ao; };
  expect_the_same_from_every_isa(ao);
  expect_the_same_from_any_threads(ao);
}

TEST(Msvo, ACropFarEnoughInsideIsThatPartOfTheWhole) {
  const Window window{-9, 3, 811, 93}, part{44, 3, 811, 93};
  Geometry g = still_life_in(window, camera_from_fov(50, Window{0, 0, 800, 100}, 1));
  const Products whole = run(g), cropped = run(crop(g, part));
  int occluded = 0;
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 352; x < part.width(); ++x) {
      ASSERT_EQ(cropped.ao(x, y), whole.ao(x + 53, y)) << x << "," << y;
      occluded += whole.ao(x + 53, y) < 0.95f;
    }
  }
  EXPECT_GT(occluded, 1000);
}

TEST(Msvo, FramesOfAnySize) {
  for (const Window& window : {Window{0, 0, 1, 1}, Window{0, 0, 1, 41}, Window{0, 0, 37, 1},
                               Window{3, 0, 20, 3}, Window{-5, -9, 60, 22}}) {
    for (const Camera& projection :
         {camera_from_fov(40, window, 1), camera_from_ortho_width(4, window, 1)}) {
      const Geometry g = geometry_of(still_life(), tilted(projection, 40), window);
      const Products out = run(g);
      expect_usable(out);
      expect_the_slow_evaluation(SlowMsvo(g).ao(), out.ao);
    }
  }
}

TEST(Msvo, NothingThatComesInMakesANaN) {
  const Geometry g = broken_geometry();
  expect_usable(run(g));
  for (const char* setting : {"thickness=10", "intensity=4", "far=1e-6", "far=1e9",
                              "noise-tolerance=-8", "blur-tolerance=-1", "upsample-tolerance=-1"}) {
    SCOPED_TRACE(setting);
    expect_usable(run(g, {setting}));
  }
}

}  // namespace
}  // namespace ssdo::test::msvo_test
