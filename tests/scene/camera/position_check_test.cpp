// SPDX-License-Identifier: Apache-2.0
//
// A P that no camera has seen, by what was done to it, and a P that is only rough.
#include "scene/camera/position_check.h"

#include <Imath/half.h>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <glm/common.hpp>

#include "scene/camera/fit.h"
#include "support/analytic_scene.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::position_check_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const Window kWindow{0, 0, 96, 72};

/// Balls on a floor at z = 0, in a world whose origin is in the middle of the picture.
Picture still_life() {
  return take_picture(
      all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6), sphere({-1, 0.5, 0.4}, 0.4)}),
      look_at(camera_from_fov(40, kWindow, 1), {1.5, -4, 3}, {0, 0, 0.3}, {0, 0, 1}), kWindow);
}

/// The fault of the picture's P after a change, under the camera that is found for it.
std::string fault_of(GBuffer g) {
  const auto camera = fit_camera(g.position, g.valid, g.window);
  return find_fault_of_positions(g, camera ? &*camera : nullptr);
}

std::string fault_of(const std::function<glm::vec3(const glm::vec3&)>& change) {
  GBuffer g = gbuffer_of(still_life());
  for (glm::vec3& p : g.position.pixels) p = change(p);
  return fault_of(g);
}

/// Each component by `change`, whose sign is kept.
std::function<glm::vec3(const glm::vec3&)> odd(float (*change)(float)) {
  return [=](glm::vec3 p) {
    for (int c = 0; c < 3; ++c) p[c] = std::copysign(change(std::abs(p[c])), p[c]);
    return p;
  };
}

float to_srgb(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

/// The box that the surfaces fill.
struct Bounds {
  glm::vec3 low{1e9f}, high{-1e9f};

  Bounds() {
    const GBuffer g = gbuffer_of(still_life());
    for (const glm::vec3& q : g.position.pixels) low = glm::min(low, q), high = glm::max(high, q);
  }
};

/// P to that box, each axis for itself or all by the longest.
glm::vec3 in_box(const glm::vec3& p, bool each) {
  static const Bounds box;  // a picture of it for every pixel took most of the time of these tests
  const glm::vec3 size = box.high - box.low;
  return (p - box.low) / (each ? size : glm::vec3(std::max({size.x, size.y, size.z})));
}

TEST(PositionCheck, AcceptsPositions) {
  EXPECT_EQ(fault_of([](const glm::vec3& p) { return p; }), "");
  EXPECT_EQ(fault_of([](const glm::vec3& p) { return glm::vec3(p.x, p.z, -p.y); }), "");
  EXPECT_EQ(fault_of([](const glm::vec3& p) { return 100.0f * p + glm::vec3(7e4f); }), "");
}

TEST(PositionCheck, NamesClippingEvenOfAFewSurfaces) {
  const auto clipped = [](const glm::vec3& low, const glm::vec3& high) {
    return fault_of([=](const glm::vec3& p) { return glm::clamp(p, low, high); });
  };
  const glm::vec3 far(1e9f);
  EXPECT_THAT(clipped(glm::vec3(0), far), StartsWith("looks clipped at 0: its "));
  EXPECT_THAT(clipped(glm::vec3(0), glm::vec3(1)), HasSubstr("clipped at 0"));
  EXPECT_THAT(clipped(-far, glm::vec3(1)), StartsWith("looks clipped at 1: its "));
  // The camera that fits nearly all of P has nothing to say of the rest.
  const std::string few =
      fault_of([](const glm::vec3& p) { return glm::vec3(std::max(p.x + 1.8f, 0.0f), p.y, p.z); });
  EXPECT_THAT(few, HasSubstr("clipped at 0: its x is 0 in "));
}

TEST(PositionCheck, NamesAnEncoding) {
  const std::pair<float (*)(float), std::string> encodings[] = {
      {[](float v) { return std::pow(v, 1 / 2.2f); }, "P^2.2"},
      {[](float v) { return std::pow(v, 2.2f); }, "P^(1/2.2)"},
      {[](float v) { return std::sqrt(v); }, "P^2 "},
      {to_srgb, "P decoded from sRGB"}};
  for (const auto& [encode, name] : encodings) {
    EXPECT_THAT(fault_of(odd(encode)), HasSubstr("looks gamma-encoded: " + name));
    EXPECT_THAT(fault_of([&, change = odd(encode)](const glm::vec3& p) {
                  return change(glm::max(p, glm::vec3(0)));
                }),
                HasSubstr("looks gamma-encoded: " + name))
        << "and clipped";
  }
}

TEST(PositionCheck, NamesNormalsAndOtherLayers) {
  GBuffer g = gbuffer_of(still_life());
  std::swap(g.position, g.normal);
  EXPECT_THAT(fault_of(g), HasSubstr("has length 1 everywhere: looks like normals"));
  for (glm::vec3& p : g.position.pixels) p = 0.5f * p + 0.5f;
  EXPECT_THAT(fault_of(g), HasSubstr("as 2P - 1: looks like normals"));
  EXPECT_THAT(fault_of([](const glm::vec3& p) { return glm::abs(glm::fract(3.0f * p)); }),
              HasSubstr("fits no camera"));
}

TEST(PositionCheck, NamesWhatWasScaledToABox) {
  EXPECT_THAT(fault_of([](const glm::vec3& p) { return in_box(p, true); }),
              HasSubstr("looks normalised to its bounding box"));
  EXPECT_EQ(fault_of([](const glm::vec3& p) { return in_box(p, false); }), "") << "another unit";
  EXPECT_THAT(fault_of([](const glm::vec3& p) {
                return glm::vec3(p.x + 0.3f * p.z, 2.0f * p.y, p.z - 0.4f * p.y);
              }),
              HasSubstr("looks stretched or sheared"));
}

TEST(PositionCheck, Names8Bits) {
  for (const bool each : {false, true}) {
    const std::string fault =
        fault_of([=](const glm::vec3& p) { return glm::round(255.0f * in_box(p, each)) / 255.0f; });
    EXPECT_THAT(fault, HasSubstr("looks stored in 8 bits"));
  }
}

TEST(PositionCheck, AcceptsRoughPositions) {
  const GBuffer right = gbuffer_of(still_life());
  // 16 bits, far from the origin.
  for (const float away : {0.0f, 60.0f}) {
    GBuffer g = right;
    g.position_step = 1.0f / 2048;
    for (glm::vec3& p : g.position.pixels)
      for (int c = 0; c < 3; ++c) p[c] = float(half(p[c] + away));
    EXPECT_EQ(fault_of(g), "") << away;
  }
  // Averages over silhouettes and over the shutter of a moving ball.
  GBuffer averaged = right;
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 4; x + 4 < kWindow.width(); ++x) {
      glm::vec3 sum(0);
      for (int k = -4; k <= 4; ++k) sum += right.position(x + k, y);
      if (right.normal(x, y).z < 0.99f) averaged.position(x, y) = sum / 9.0f;
    }
  }
  EXPECT_EQ(fault_of(averaged), "");
  // A lens that pulls the corners in by a tenth.
  GBuffer bent = right;
  const glm::vec2 middle(0.5f * glm::vec2(kWindow.width(), kWindow.height()));
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      const glm::vec2 from = (glm::vec2(x, y) - middle) / glm::length(middle);
      const glm::vec2 at = middle + glm::length(middle) * (1 - 0.1f * glm::dot(from, from)) * from;
      bent.position(x, y) = right.position(int(std::lround(at.x)), int(std::lround(at.y)));
    }
  }
  EXPECT_EQ(fault_of(bent), "");
}

}  // namespace
}  // namespace ssdo::test::position_check_test
