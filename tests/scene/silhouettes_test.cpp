// SPDX-License-Identifier: Apache-2.0
//
// Averages over an edge are told from rounding.
#include "scene/silhouettes.h"

#include <gtest/gtest.h>

#include <random>

#include "scene/build_geometry.h"
#include "support/average_picture.h"
#include "support/gbuffer_of.h"

namespace ssdo::test::silhouettes_test {
namespace {

const Window kWindow{0, 0, 200, 150};

Camera usual_view() {
  return look_at(camera_from_fov(40, kWindow, 1), {0, -6, 2.5}, {0, 0, 0.5}, {0, 0, 1});
}

std::size_t mended(const Picture& picture) {
  GeometryReport report;
  Geometry geometry = build_geometry(gbuffer_of(picture), {}, "test", report);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < geometry.surfaces.size(); ++i) {
    if (!geometry.is_surface(i)) continue;
    const glm::dvec3 p = geometry.camera.to_camera(glm::dvec3(picture.position[i]));
    moved += glm::length(glm::dvec3(geometry.surfaces[i].position) - p) > 1e-4 * glm::length(p);
  }
  return moved;
}

/// Ground behind a grid of wires, each a pixel or two wide.
Surface wires() {
  std::vector<Surface> scene = {plane({}, {0, 0, 1})};
  for (int wire = 0; wire < 30; ++wire) {
    const double x = -2 + 4 * wire / 29.0, y = -1 + 0.07 * (wire * 7 % 30);
    scene.push_back(cut(plane({0, y, 0}, {0, -1, 0}), [=](const glm::dvec3& p) {
      return std::abs(p.x - x) < 0.018 && p.z > 0 && p.z < 1.5;
    }));
  }
  return all_of(scene);
}

TEST(Silhouettes, OfWiresWithOneSamplePerPixelAreLeftAlone) {
  // Long thin triangles leave P off its ray by some thousandths of a pixel here and there.
  Picture picture = take_picture(wires(), usual_view(), kWindow);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> off(-1e-4f, 1e-4f);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < picture.position.size(); ++i) {
    if (picture.normal[i].z > 0.5f || random() % 8) continue;
    picture.position[i].x += off(random);
    ++changed;
  }
  ASSERT_GT(changed, 100u);
  EXPECT_EQ(mended(picture), 0u);
}

TEST(Silhouettes, ThatAreAveragedAreMendedHoweverFew) {
  Plane<unsigned char> averaged;
  const Surface card = cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) {
    return std::abs(p.x) < 0.119 && std::abs(p.z - 1) < 0.097;
  });
  const Surface one = all_of({plane({}, {0, 0, 1}), card});
  const std::size_t of_one = mended(average_picture(one, usual_view(), kWindow, 4, averaged));
  EXPECT_GT(of_one, 5u);
  EXPECT_LT(double(of_one), 5e-3 * double(kWindow.area()));
  EXPECT_GT(mended(average_picture(wires(), usual_view(), kWindow, 4, averaged)), 200u);
}

}  // namespace
}  // namespace ssdo::test::silhouettes_test
