// SPDX-License-Identifier: Apache-2.0
//
// Light in frames whose deep images say what is hidden: occlusion by boxes that no pixel shows,
// against rays through the very boxes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "estimators/trace_request.h"
#include "parallel/tiles.h"
#include "scene/deep/join_measured.h"
#include "scene/light/painted_map.h"
#include "support/boxes.h"

namespace ssdo::test::deep_solids_test {
namespace {

const Window kWindow{0, 0, 240, 160};

/// A roof on nothing, and a box on the floor that it hides from above.
const Box kRoof{{-0.8, -0.9, 2.4}, {0.6, 0.9, 2.5}}, kHidden{{-0.4, -0.5, 0}, {0.4, 0.5, 0.7}};
Surface ground() { return plane({}, {0, 0, 1}); }
Surface scene() { return all_of({ground(), kRoof.surface(), kHidden.surface()}); }

Camera above(bool orthographic) {
  return tilted(
      orthographic ? camera_from_ortho_width(4.8, kWindow, 1) : camera_from_fov(24, kWindow, 1), 0,
      11);
}

Solids measured(const Geometry& g, const DeepPixels& pixels) {
  std::vector<std::string> warnings;
  const MeasuredSolids found =
      measure_solids(g, {image_of(pixels)}, {std::nullopt, 1e9f}, warnings);
  EXPECT_TRUE(warnings.empty());
  return join_measured(g, found, std::nullopt);
}

/// Merged elements, of which the roof has a ZBack, and the hidden box if `thick`.
DeepPixels deep_of(const Camera& camera, bool thick) {
  DeepPixels pixels = thick ? merged({ground()}, camera, kWindow)
                            : merged({ground(), kHidden.surface()}, camera, kWindow);
  add_box(kRoof, camera, pixels);
  if (thick) add_box(kHidden, camera, pixels);
  return pixels;
}

/// A pixel of the floor around the roof, and its ao by rays.
struct Expected {
  int x, y;
  double ao;
};

std::vector<Expected> expected_of(const Camera& camera) {
  std::vector<Expected> all;
  for (int y = 44; y < kWindow.height() - 44; y += 8) {
    for (int x = 20; x < kWindow.width() - 20; x += 8) {
      const Point p = point_at(scene(), camera, kWindow, x, y);
      if (p.position.z < 1e-6) all.push_back({x, y, ao_by_rays(scene(), p, kNoLimit, 4096)});
    }
  }
  EXPECT_GT(all.size(), 30u);
  return all;
}

double rmse(const Products& products, const std::vector<Expected>& expected) {
  double sum = 0;
  for (const Expected& e : expected) sum += std::pow(products.ao(e.x, e.y) - e.ao, 2);
  return std::sqrt(sum / double(expected.size()));
}

TEST(DeepSolids, HideWhatTheirBoxesHide) {
  for (const bool orthographic : {true, false}) {
    const Camera camera = above(orthographic);
    const Geometry g = geometry_of(scene(), camera, kWindow);
    const Solids guess = guess_solids(g), known = measured(g, deep_of(camera, true)),
                 front = measured(g, deep_of(camera, false));
    const std::vector<Expected> expected = expected_of(camera);
    const auto report = [&](const char* name, const Solids& solids) {
      const double bitmask = rmse(run(g, {.radius = kNoLimit, .steps = 128, .solids = &solids}),
                                  expected),
                   trace =
                       rmse(run_trace(g, {.radius = kNoLimit, .samples = 256, .solids = &solids}),
                            expected);
      fmt::print("{} {:<17} rmse of bitmask {:.4f}, of trace {:.4f}\n",
                 orthographic ? "ortho" : "persp", name, bitmask, trace);
      return std::pair(bitmask, trace);
    };
    const auto alone = report("guessed", guess), by_front = report("front of the box", front),
               exact = report("fronts and backs", known);
    EXPECT_LT(exact.first, 0.013);
    EXPECT_LT(exact.second, 0.01);
    EXPECT_LT(by_front.first, 0.6 * alone.first);
    EXPECT_LT(by_front.second, 0.6 * alone.second);
    EXPECT_GT(alone.second, 3 * exact.second) << "the frame alone cannot know";
  }
}

/// A low sun shines under the roof on the hidden box, whose shadow lies on the floor beside it.
TEST(DeepSolids, ThrowShadowsOfASun) {
  const double elevation = glm::radians(15.0);
  const glm::dvec3 to(std::cos(elevation), 0, std::sin(elevation));
  const Environment map = paint(
      1024, [&](const glm::vec3& d) { return glm::vec3(in_disc(d, to, 0.5f) ? 1 : 0); }, 2);
  for (const bool orthographic : {true, false}) {
    const Camera camera = above(orthographic);
    const Geometry g = geometry_of(scene(), camera, kWindow);
    const Solids known = measured(g, deep_of(camera, true));
    const BitmaskRequest request{.radius = kNoLimit,
                                 .environment = map,
                                 .products = {.direct = true},
                                 .slices = 2,
                                 .steps = 16,
                                 .solids = &known};
    const Products out = run(g, request);
    const float full = run(geometry_of(ground(), camera, kWindow), request).direct(120, 80).x;
    int lit = 0, shadow = 0, wrong = 0;
    for (int y = 20; y < kWindow.height() - 20; ++y) {
      for (int x = 0; x < kWindow.width(); ++x) {
        const Point p = point_at(scene(), camera, kWindow, x, y);
        if (p.position.z > 1e-6) continue;
        const bool open = is_open(scene(), p, to, kNoLimit);
        (open ? lit : shadow)++;
        wrong += (out.direct(x, y).x > 0.5f * full) != open;
      }
    }
    fmt::print("{} lit, {} in the shadow, {} wrong\n", lit, shadow, wrong);
    EXPECT_GT(shadow, 1500);
    EXPECT_GT(lit, 1500);
    EXPECT_LT(wrong, 0.05 * shadow);
  }
}

TEST(DeepSolids, GiveTheSameBitsOnAnyNumberOfThreads) {
  const Camera camera = above(false);
  const Geometry g = geometry_of(scene(), camera, kWindow);
  const auto products = [&](int threads) {
    const ThreadLimit limit(threads);
    const Solids solids = measured(g, deep_of(camera, false));
    return run(g, {.radius = kNoLimit, .slices = 2, .steps = 16, .solids = &solids, .bounces = 1});
  };
  const Products one = products(1), four = products(4);
  EXPECT_EQ(one.ao.pixels, four.ao.pixels);
  EXPECT_EQ(one.bounce.pixels, four.bounce.pixels);
}

/// The roof's shadow: the hidden box sends nothing, for nothing says what it would send; the floor
/// under the roof sends as the floor beside it.
TEST(DeepSolids, SendLightOnlyWhereAPixelShowsTheirSurface) {
  const Camera camera = above(true);
  const Geometry g = geometry_of(scene(), camera, kWindow);
  const Solids solids = measured(g, deep_of(camera, false));
  int box = 0, floor = 0;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    const Solid behind = solids.at(1, i);
    if (g.surfaces[i].position.z < -10 || !behind.exists()) continue;
    const bool is_box = std::abs(behind.distance - 1.8) < 1e-3;
    EXPECT_EQ(behind.sender >= 0, !is_box) << "pixel " << i;
    (is_box ? box : floor)++;
  }
  EXPECT_GT(box, 500);
  EXPECT_GT(floor, 500);
}

}  // namespace
}  // namespace ssdo::test::deep_solids_test
