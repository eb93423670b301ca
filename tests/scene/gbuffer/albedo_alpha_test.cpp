// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/albedo_alpha.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace ssdo::test::albedo_alpha_test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kSize = 48;

/// Stripes from 0.2 to 0.8.
glm::vec3 rho(int x, int y) {
  return {0.2f + 0.6f * float(x % 6) / 5, 0.3f, 0.2f + 0.6f * float(y % 5) / 4};
}

/// A disc whose edge is one pixel wide, in front of nothing.
float coverage_of_disc(int x, int y, float radius = 18) {
  const float r = std::hypot(float(x) - 23.6f, float(y) - 23.3f);
  return std::clamp(radius - r, 0.0f, 1.0f);
}

/// Surfaces where a sample at the middle of the pixel hits them. `stored(alpha)` is what stands in
/// the layer in place of an albedo of 1.
template <class Stored>
GBuffer disc(const Stored& stored, float radius = 18) {
  GBuffer g;
  g.window = g.display = {0, 0, kSize, kSize};
  g.albedo = Plane<glm::vec3>(kSize, kSize);
  g.alpha = Plane<float>(kSize, kSize);
  g.valid = Plane<unsigned char>(kSize, kSize);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float a = coverage_of_disc(x, y, radius);
      g.alpha(x, y) = a;
      g.valid(x, y) = a > 0.5f;
      g.albedo(x, y) = stored(a) * rho(x, y);
    }
  }
  return g;
}

const auto kPremultiplied = [](float alpha) { return alpha; };
const auto kStraight = [](float alpha) { return alpha > 0 ? 1.0f : 0.0f; };

void expect_rho(const GBuffer& g) {
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (!g.valid(x, y)) continue;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(g.albedo(x, y)[c], rho(x, y)[c], 1e-6f) << x << " " << y;
    }
  }
}

TEST(AlbedoAlpha, OfAPremultipliedLayerIsDividedOut) {
  GBuffer g = disc(kPremultiplied);
  undo_alpha_of_albedo(g, std::nullopt, std::nullopt);
  EXPECT_EQ(g.encodings.albedo_premultiplied, 1);
  EXPECT_THAT(g.albedo_alpha, HasSubstr("is premultiplied by alpha"));
  expect_rho(g);
}

TEST(AlbedoAlpha, IsNotDividedOutOfAStraightLayer) {
  GBuffer g = disc(kStraight);
  undo_alpha_of_albedo(g, std::nullopt, std::nullopt);
  EXPECT_EQ(g.encodings.albedo_premultiplied, 0);
  EXPECT_THAT(g.albedo_alpha, HasSubstr("is not premultiplied by alpha"));
  expect_rho(g);
}

TEST(AlbedoAlpha, IsAsStatedOrAsInTheWholeFrame) {
  GBuffer straight = disc(kStraight), of_frame = disc(kPremultiplied);
  undo_alpha_of_albedo(straight, true, std::nullopt);
  EXPECT_EQ(straight.encodings.albedo_premultiplied, 1);
  EXPECT_THAT(straight.albedo_alpha, HasSubstr("by --aov"));
  Encodings known;
  known.albedo_premultiplied = 0;
  const Plane<glm::vec3> stored = of_frame.albedo;
  undo_alpha_of_albedo(of_frame, std::nullopt, known);
  EXPECT_EQ(of_frame.encodings.albedo_premultiplied, 0);
  EXPECT_EQ(of_frame.albedo.pixels, stored.pixels);
}

TEST(AlbedoAlpha, MakesNoDifferenceWhereAllIsCovered) {
  GBuffer g = disc([](float) { return 1.0f; });
  for (float& a : g.alpha.pixels) a = 1;
  const Plane<glm::vec3> stored = g.albedo;
  undo_alpha_of_albedo(g, std::nullopt, std::nullopt);
  EXPECT_THAT(g.albedo_alpha, IsEmpty());
  EXPECT_EQ(g.albedo.pixels, stored.pixels);
}

/// A sheet of glass: nothing is fully covered, and more is stored than a premultiplied layer can
/// hold.
TEST(AlbedoAlpha, OfASheetIsToldByWhatNoSurfaceReflects) {
  GBuffer g = disc([](float alpha) { return alpha > 0 ? 1.0f : 0.0f; });
  for (float& a : g.alpha.pixels) a *= 0.25f;
  undo_alpha_of_albedo(g, std::nullopt, std::nullopt);
  EXPECT_EQ(g.encodings.albedo_premultiplied, 0);
  expect_rho(g);
}

TEST(AlbedoAlpha, NeverMakesASurfaceReflectMoreThanAllLight) {
  GBuffer g = disc(kStraight);
  undo_alpha_of_albedo(g, true, std::nullopt);
  for (const glm::vec3& a : g.albedo.pixels) EXPECT_LE(std::max({a.x, a.y, a.z}), 1);
}

/// An edge that comes into the picture pixel by pixel: the documented convention holds at first,
/// and gives way by degrees.
TEST(AlbedoAlpha, OfFewPixelsTurnsByDegrees) {
  float before = 1;
  for (int rows = 0; rows <= kSize; ++rows) {
    GBuffer g = disc(kStraight);
    for (int y = rows; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) g.valid(x, y) = 0;
    undo_alpha_of_albedo(g, std::nullopt, std::nullopt);
    const float share = g.encodings.albedo_premultiplied;
    EXPECT_LE(share, before + 0.05f) << rows << " rows";  // a row may end between full pixels
    EXPECT_GE(share, before - 0.35f) << rows << " rows";
    if (rows < 6) {
      EXPECT_EQ(share, 1) << rows << " rows";
    }
    before = share;
  }
  EXPECT_EQ(before, 0);
}

}  // namespace
}  // namespace ssdo::test::albedo_alpha_test
