// SPDX-License-Identifier: Apache-2.0
//
// Whatever the weights are: known directions stay as they are, values stay within 0..1, and nothing
// depends on threads, on the crop or on the unit.
#include "prior/prior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <set>
#include <utility>

#include "estimators/bitmask/request.h"
#include "estimators/guessed.h"
#include "filters/light_visibility.h"
#include "parallel/task_order.h"
#include "parallel/tiles.h"
#include "prior/inputs.h"
#include "scene/solids/solids.h"

namespace ssdo::test::prior_test {
namespace {

/// A third of the width of what the prior looks at as it is: squares of 2 x 2 pixels.
const Window kDisplay{0, 0, 720, 144};

/// A floor, a wall on the left, and a ball.
Surface room() {
  return all_of({plane({0, 0, 0}, {0, 0, 1}), plane({-3, 0, 0}, {1, 0, 0}),
                 plane({0, 6, 0}, {0, -1, 0}), sphere({0.5, 1, 0.7}, 0.7)});
}

Camera eye(double aside = 0, double unit = 1) {
  Camera camera = look_at(camera_from_fov(80, kDisplay, 1), unit * glm::dvec3(aside, -5, 1.6),
                          unit * glm::dvec3(aside, 1, 0.9), {0, 0, 1});
  return camera;
}

Scene scene_with(Geometry geometry) {
  geometry.median_depth = 6;
  Scene scene = scene_of(std::move(geometry));
  scene.solids = guess_solids(scene.geometry);
  return scene;
}

Scene room_seen(const Camera& camera = eye(), const Window& window = kDisplay) {
  Geometry geometry = geometry_of(room(), camera, window);
  geometry.display = kDisplay;
  return scene_with(std::move(geometry));
}

glm::vec3 up_of(const Scene& scene) {
  return glm::vec3(scene.geometry.camera.rotation * glm::dvec3(0, 0, 1));
}

/// ao by the rules and with the prior.
struct Found {
  Plane<float> rules, ao;
  PriorField field;
};

Found find(const Scene& scene, const std::optional<glm::vec3>& up, float radius = kNoLimit,
           const Window& receivers = {}) {
  const Method method = bitmask_method();
  Request request{.products = {.ao = true}, .radius = radius, .receivers = receivers};
  Found found;
  request.ask_prior = [&](const PriorQuestion& question) {
    found.field = find_prior(question, {up, radius, request.seed});
    return LearnedVisibility();
  };
  Products noisy = method.estimate(scene, request, {});
  if (receivers.area() > 0) {
    // As relight() does: a plane of the whole geometry.
    const Window& window = scene.geometry.window;
    Plane<float> whole(window.width(), window.height(), 1.0f);
    for (int y = 0; y < noisy.ao.height; ++y)
      for (int x = 0; x < noisy.ao.width; ++x)
        whole(receivers.x0 - window.x0 + x, receivers.y0 - window.y0 + y) = noisy.ao(x, y);
    noisy.ao = std::move(whole);
  }
  const Filter& filter = find_filter("geometry");
  found.ao = filter_visibility(filter, std::move(noisy), scene, 8, [&](Products& products) {
               found.rules = products.ao;
               apply_prior(found.field, scene, products);
             }).ao;
  return found;
}

TEST(Prior, IsFiniteWithinBoundsAndChangesWhatIsGuessed) {
  const Scene scene = room_seen();
  for (const auto& up : {std::optional(up_of(scene)), std::optional<glm::vec3>()}) {
    for (const float radius : {2.0f, kNoLimit}) {
      const Found found = find(scene, up, radius);
      double change = 0;
      for (std::size_t i = 0; i < found.ao.size(); ++i) {
        ASSERT_TRUE(found.ao[i] >= 0 && found.ao[i] <= 1) << found.ao[i];
        change += double(std::abs(found.ao[i] - found.rules[i])) / double(found.ao.size());
      }
      EXPECT_GT(change, 0.005);
    }
  }
}

TEST(Prior, KeepsWhatIsKnown) {
  // From above, with a radius: only along the border does anything lie where no picture looks.
  const Camera camera = look_at(camera_from_ortho_width(36, kDisplay, 1), {0, 0, 5}, {}, {0, 1, 0});
  const auto pit = cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.x > 0; });
  const Scene scene =
      scene_with(geometry_of(all_of({pit, plane({0, 0, -0.5}, {0, 0, 1})}), camera, kDisplay));
  const Found found = find(scene, glm::vec3(0, 0, 1), 1);
  int open = 0, kept = 0;
  for (int y = 64; y < kDisplay.height() - 64; ++y) {
    for (int x = 64; x < kDisplay.width() - 64; ++x) {
      const bool far_from_step = std::abs(x - 360) > 70;
      if (far_from_step) {
        EXPECT_EQ(found.ao(x, y), 1) << x << " " << y;
      }
      open += far_from_step;
      kept += found.ao(x, y) == found.rules(x, y);
    }
  }
  EXPECT_GT(open, 1000);
  EXPECT_GE(kept, open);
}

TEST(Prior, HasTheSameBitsWithAnyThreadsAndOrder) {
  const Scene scene = room_seen();
  const Found one = [&] {
    const ThreadLimit limit(1);
    return find(scene, up_of(scene));
  }();
  for (const unsigned seed : {1u, 2u}) {
    const ThreadLimit limit(3);
    const ShuffledOrder order{seed};
    EXPECT_EQ(find(scene, up_of(scene)).ao.pixels, one.ao.pixels);
  }
}

TEST(Prior, DependsOnNoCrop) {
  // An odd number of pixels beyond the display window, which begins within no square.
  const Window data{-101, -75, 821, 219};
  const Scene scene = room_seen(eye(), data);
  const Found whole = find(scene, up_of(scene));
  const int reach = kPriorReach + find_filter("geometry").reach;
  const Found cropped =
      find(scene, up_of(scene), kNoLimit, {-reach, -reach, 720 + reach, 144 + reach});
  int changed = 0;
  for (int y = 0; y < kDisplay.height(); ++y)
    for (int x = 0; x < kDisplay.width(); ++x)
      changed += whole.ao(101 + x, 75 + y) != cropped.ao(101 + x, 75 + y);
  EXPECT_EQ(changed, 0);
}

TEST(Prior, KnowsNoUnit) {
  const Scene scene = room_seen();
  Scene large = scene;
  constexpr float kUnit = 128;
  large.geometry.surfaces.change_each([&](Surfel& s) { s.position *= kUnit, s.rounding *= kUnit; });
  large.geometry.median_depth *= kUnit;
  large.solids = guess_solids(large.geometry);
  const Found a = find(scene, up_of(scene), 2), b = find(large, up_of(scene), 2 * kUnit);
  double sum = 0;
  for (std::size_t i = 0; i < a.ao.size(); ++i) sum += double(std::abs(a.ao[i] - b.ao[i]));
  EXPECT_LT(sum / double(a.ao.size()), 2e-3);
}

TEST(Prior, ChangesLittleWithALittleStepOfTheCamera) {
  const auto mean_step = [](const Plane<float>& a, const Plane<float>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += double(std::abs(a[i] - b[i]));
    return sum / double(a.size());
  };
  const Scene scene = room_seen();
  const Found found = find(scene, up_of(scene));
  for (const double step : {1e-2, 1e-3, 1e-4}) {
    const Found moved = find(room_seen(eye(step)), up_of(scene));
    const double by_rules = mean_step(found.rules, moved.rules);
    EXPECT_LT(mean_step(found.field.visibility_bias, moved.field.visibility_bias),
              3 * by_rules + 1e-4)
        << step;
    EXPECT_LT(mean_step(found.ao, moved.ao), 2 * by_rules + 1e-4) << step;
  }
}

TEST(PriorGrid, TogetherHaveTheMembersOfThePattern) {
  for (const int width : {480, 720, 1920}) {
    Geometry geometry;
    geometry.window = geometry.display = {0, 0, width, 64};
    geometry.surfaces = Surfaces(width, 64, {{0, 0, -1}, {0, 0, 1}, 0});
    const PriorGrid grid = make_prior_grid(geometry, geometry.window);
    EXPECT_EQ(grid.step, width / 480 > 1 ? 4 : width == 720 ? 2 : 1);
    std::set<std::pair<int, int>> members;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        members.emplace(grid.pixel(3 + x, 1 + y) % width % 8, grid.pixel(3 + x, 1 + y) / width % 8);
    EXPECT_EQ(members.size(), 64u) << width;
  }
}

TEST(PriorAxes, StandUprightAndTurnWithTheCameraWithoutAJump) {
  glm::mat3 before(0);
  for (double pitch = -89; pitch <= 89; pitch += 0.5) {
    // The way up, seen by a camera that looks up by `pitch`, with a little roll.
    const double p = glm::radians(pitch);
    const glm::vec3 up = glm::normalize(glm::vec3(0.1, std::cos(p), -std::sin(p)));
    const glm::mat3 axes = prior_axes(up);
    EXPECT_NEAR(glm::determinant(axes), 1, 1e-5);
    EXPECT_NEAR((axes * up).z, 1, 1e-5);
    if (pitch > -89) {
      for (int c = 0; c < 3; ++c) EXPECT_LT(glm::distance(axes[c], before[c]), 0.03) << pitch;
    }
    before = axes;
  }
  EXPECT_EQ(prior_axes({}) * glm::vec3(0, 0, -1), glm::vec3(0, 1, 0));
}

}  // namespace
}  // namespace ssdo::test::prior_test
