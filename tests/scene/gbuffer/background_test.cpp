// SPDX-License-Identifier: Apache-2.0
//
// What counts as background, and which depth may say so beside P.
#include "scene/gbuffer/background.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "scene/depth_model.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::background_test {
namespace {

const Window kWindow{0, 0, 64, 48};
constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

/// A ball on a disc before nothing, in a world whose origin is on the disc.
Picture ball_before_nothing(double away = 0) {
  const glm::dvec3 origin(away, -away, away);
  const Surface disc = cut(plane(origin, {0, 0, 1}),
                           [=](const glm::dvec3& p) { return glm::length(p - origin) < 1.3; });
  return take_picture(all_of({disc, sphere(origin + glm::dvec3(0.2, 0, 0.6), 0.6)}),
                      look_at(camera_from_fov(40, kWindow, 1), origin + glm::dvec3(0, -4, 3),
                              origin + glm::dvec3(0, 0, 0.3), {0, 0, 1}),
                      kWindow);
}

/// P, N and planar depth of the picture, as Blender writes them.
GBuffer frame_of(const Picture& picture) {
  GBuffer g = gbuffer_of(picture);
  g.valid = {};
  g.depth = Plane<float>(kWindow.width(), kWindow.height(), 1e10f);
  for (std::size_t i = 0; i < g.depth.size(); ++i) {
    if (picture.valid[i])
      g.depth[i] = float(-picture.camera.to_camera(glm::dvec3(picture.position[i])).z);
  }
  return g;
}

/// The frame with its depth changed, where it shows a surface and where not.
GBuffer with_depth(const Picture& picture, const std::function<float(float)>& surface,
                   float nothing) {
  GBuffer g = frame_of(picture);
  for (float& z : g.depth.pixels) z = z < kEmptyDepth ? surface(z) : nothing;
  return g;
}

std::size_t surfaces(const Picture& picture) {
  return std::size_t(std::count(picture.valid.pixels.begin(), picture.valid.pixels.end(), 1));
}

void expect_shows(GBuffer g, const Picture& picture) {
  find_background(g, std::nullopt);
  EXPECT_EQ(g.valid.pixels, picture.valid.pixels);
  EXPECT_EQ(g.background_pixels, kWindow.area() - surfaces(picture));
  EXPECT_EQ(g.bad_pixels, 0u);
}

const auto kAsItIs = [](float z) { return z; };

TEST(Background, IsWhatP0OrDepthSayWhateverTheFarClip) {
  const Picture picture = ball_before_nothing();
  ASSERT_LT(surfaces(picture), kWindow.area());
  for (const float nothing : {1e10f, 1e4f, 65504.0f, kInfinity, kNan, 0.0f, -1.0f}) {
    SCOPED_TRACE(nothing);
    GBuffer g = with_depth(picture, kAsItIs, nothing);
    find_background(g, std::nullopt);
    EXPECT_TRUE(g.warnings.empty());
    EXPECT_FALSE(g.depth.empty());
    expect_shows(with_depth(picture, kAsItIs, nothing), picture);
  }
}

TEST(Background, IsWhatN0SaysWherePHasAnyValue) {
  // A renderer that leaves P at the far clip, or at the camera, where a ray meets nothing.
  const Picture picture = ball_before_nothing();
  for (const bool depth : {false, true}) {
    for (const glm::vec3& nothing : {glm::vec3(300, 20, -5), glm::vec3(0, -4, 3)}) {
      GBuffer g = with_depth(picture, kAsItIs, 1e4f);
      for (std::size_t i = 0; i < g.position.size(); ++i)
        if (!picture.valid[i]) g.position[i] = nothing;
      if (!depth) g.depth = {};
      expect_shows(std::move(g), picture);
    }
  }
}

TEST(Background, IsWhatN0SaysBesideADepthAlone) {
  const Picture picture = ball_before_nothing();
  GBuffer g = with_depth(picture, kAsItIs, 1e4f), without_normals = g;
  g.position = without_normals.position = {};
  expect_shows(g, picture);
  for (glm::vec3& n : without_normals.normal.pixels) n = glm::vec3(0);
  find_background(without_normals, std::nullopt);
  EXPECT_EQ(without_normals.background_pixels, 0u);
}

TEST(Background, IsNoSurfaceOfWhichDepthAndPAreSure) {
  // A real position of 0, and normals that are missing here and there or everywhere.
  const Picture picture = ball_before_nothing();
  GBuffer at_origin = frame_of(picture), without_normals = at_origin, no_depth = at_origin;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < at_origin.position.size(); ++i) {
    if (picture.valid[i] &&
        glm::length(picture.position[i]) <
            glm::length(picture.position[nearest]) + (picture.valid[nearest] ? 0 : 1e9f))
      nearest = i;
  }
  for (glm::vec3& p : at_origin.position.pixels) p -= picture.position[nearest];
  for (std::size_t i = 0; i < at_origin.position.size(); ++i)
    if (!picture.valid[i]) at_origin.position[i] = glm::vec3(0);
  expect_shows(std::move(at_origin), picture);
  for (std::size_t i = 0; i < without_normals.normal.size(); i += 7)
    without_normals.normal[i] = glm::vec3(0);
  expect_shows(std::move(without_normals), picture);
  no_depth.depth = {};
  for (glm::vec3& n : no_depth.normal.pixels) n = glm::vec3(0);
  expect_shows(std::move(no_depth), picture);
}

TEST(Background, LeavesOutADepthThatContradictsP) {
  const Picture picture = ball_before_nothing();
  const std::vector<std::pair<std::string, GBuffer>> cases = {
      {"remapped, clipped at both ends",
       with_depth(
           picture, [](float z) { return std::clamp((z - 4.5f) / 1.5f, 0.0f, 1.0f); }, 1)},
      {"remapped, white is near", with_depth(
                                      picture, [](float z) { return 1 - (z - 3) / 4; }, 0)},
      {"another unit", with_depth(
                           picture, [](float z) { return 100 * z; }, 1e10f)},
      {"one over depth", with_depth(
                             picture, [](float z) { return 1 / z; }, 0)},
      {"never written", with_depth(
                            picture, [](float) { return 0.0f; }, 0)},
      {"not a number", with_depth(
                           picture, [](float) { return kNan; }, kNan)}};
  for (const auto& [name, frame] : cases) {
    SCOPED_TRACE(name);
    GBuffer g = frame;
    find_background(g, std::nullopt);
    EXPECT_TRUE(g.depth.empty());
    ASSERT_EQ(g.warnings.size(), 1u);
    EXPECT_NE(g.warnings[0].find("contradicts P"), std::string::npos);
    expect_shows(frame, picture);
  }
}

TEST(Background, KeepsADepthOfAnotherFrameOut) {
  const Picture picture = ball_before_nothing();
  GBuffer g = frame_of(picture);
  const Plane<float> depth = g.depth;
  for (int y = 0; y < kWindow.height(); ++y)
    for (int x = 0; x < kWindow.width(); ++x)
      g.depth(x, y) = 0.3f * depth(kWindow.width() - 1 - x, kWindow.height() - 1 - y);
  find_background(g, std::nullopt);
  EXPECT_TRUE(g.depth.empty());
  EXPECT_EQ(g.valid.pixels, picture.valid.pixels);
}

TEST(Background, TakesBothKindsOfDepthBesideRoughP) {
  // Rays or planes, 16 bits, far from the origin, a quarter of the pixels averaged away.
  for (const double away : {0.0, 90.0}) {
    const Picture picture = ball_before_nothing(away);
    for (const bool ray : {false, true}) {
      GBuffer g = frame_of(picture);
      g.position_step = away > 0 ? 1.0f / 2048 : 1.0f / 16777216;
      for (std::size_t i = 0; i < g.depth.size(); ++i) {
        if (!picture.valid[i]) continue;
        const glm::dvec3 p = picture.camera.to_camera(glm::dvec3(picture.position[i]));
        if (ray) g.depth[i] = float(glm::length(p));
        if (i % 4 == 0) g.depth[i] = float(g.depth[i] * (1.5 + 0.01 * double(i % 50)));
        if (away == 0) continue;
        for (int c = 0; c < 3; ++c) {
          const float step = std::exp2(std::floor(std::log2(std::abs(g.position[i][c]))) - 10);
          g.position[i][c] = std::round(g.position[i][c] / step) * step;
        }
      }
      EXPECT_TRUE(DepthModel::fit(g.position, g.depth, picture.valid, g.position_step));
      expect_shows(g, picture);
    }
  }
}

TEST(Background, CountsWhatIsNotANumberAsBrokenWhereDepthShowsASurface) {
  const Picture picture = ball_before_nothing();
  GBuffer g = frame_of(picture);
  std::size_t broken = 0;
  for (std::size_t i = 0; i < g.position.size(); i += 9) {
    g.position[i] = glm::vec3(kNan);
    broken += picture.valid[i];
  }
  find_background(g, std::nullopt);
  EXPECT_EQ(g.bad_pixels, broken);
  for (std::size_t i = 0; i < g.broken.size(); ++i)
    EXPECT_EQ(bool(g.broken[i]), i % 9 == 0 && picture.valid[i]) << i;
  EXPECT_EQ(g.broken.size(), g.valid.size());
  EXPECT_EQ(g.background_pixels, kWindow.area() - surfaces(picture));
}

/// Pixels around the window of P are background, whatever their memory held.
TEST(Background, IsNotBrokenAroundTheWindowOfP) {
  const Picture picture = ball_before_nothing();
  for (int round = 0; round < 20; ++round) {
    GBuffer g = frame_of(picture);
    const auto inside = [](std::size_t i) {
      return int(i % kWindow.width()) >= kWindow.width() / 2;
    };
    std::size_t hit = 0;
    while (!picture.valid[hit] || !inside(hit)) ++hit;
    g.position[hit].x = kNan;
    g.lead_window = Window{kWindow.x0 + kWindow.width() / 2, kWindow.y0, kWindow.x1, kWindow.y1};
    find_background(g, std::nullopt);
    ASSERT_EQ(g.broken.size(), g.valid.size());
    EXPECT_EQ(std::count(g.broken.pixels.begin(), g.broken.pixels.end(), 0),
              std::ptrdiff_t(g.broken.size() - 1));
    EXPECT_TRUE(g.broken[hit]);
  }
}

TEST(Background, FollowsAlphaAndTheDepthThatIsGiven) {
  const Picture picture = ball_before_nothing();
  GBuffer g = frame_of(picture);
  g.alpha = Plane<float>(kWindow.width(), kWindow.height(), 1.0f);
  g.alpha[g.alpha.index(32, 24)] = 0;
  find_background(g, 5.0f);
  EXPECT_FALSE(g.valid(32, 24));
  float farthest = 0;
  for (std::size_t i = 0; i < g.valid.size(); ++i)
    if (g.valid[i]) farthest = std::max(farthest, g.depth[i]);
  EXPECT_GT(farthest, 4.5f);
  EXPECT_LT(farthest, 5.0f);
}

}  // namespace
}  // namespace ssdo::test::background_test
