// SPDX-License-Identifier: Apache-2.0
//
// A box that travels over a floor before a camera that travels too, with exact motion.
#include "filters/shot/point_tracker.h"
#include "filters/shot/fusion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "scene/light/lamps/lamp.h"
#include "scene/light/light.h"
#include "support/boxes.h"

namespace ssdo::test::point_tracker_test {
namespace {

const Window kWindow{3, -2, 99, 70};
constexpr int kFrames = 7, kNow = 4;
const glm::dvec3 kStep(0.09, 0.05, 0.01);  ///< of the box in a frame

Camera camera_at(int frame) {
  const double x = 0.05 * frame;
  return look_at(camera_from_fov(45, kWindow, 1), {x, -4, 3}, {0.1 * x, 0, 0.3}, {0, 0, 1});
}

/// Where the middle of the box is.
glm::dvec3 middle_at(int frame) { return double(frame - kNow) * kStep + glm::dvec3(0, 0, 0.4); }

Surface scene_at(int frame) {
  const glm::dvec3 middle = middle_at(frame), half(0.45, 0.35, 0.3);
  return all_of({plane({}, {0, 0, 1}), Box{middle - half, middle + half}.surface()});
}

/// A value that belongs to a point of the box.
float pattern(const glm::dvec3& on_box) {
  return float(0.5 + 0.2 * std::sin(6 * on_box.x + 4 * on_box.y + 5 * on_box.z));
}

/// What a frame finds: the pattern on the box, 0.1 too high or too low from frame to frame. The
/// motion of the first frame leads to a frame that is not there.
struct AFrame {
  AFrame(int frame, const AFrame* before, float layer_scale = 1)
      : geometry(geometry_of(scene_at(frame), camera_at(frame), kWindow)) {
    const Surfaces& surfaces = geometry.surfaces;
    Products products;
    products.ao = Plane<float>(surfaces.width, surfaces.height, 0.5f);
    products.visibility.sources = {products.ao};
    layer = Plane<glm::vec2>(surfaces.width, surfaces.height);
    is_box = Plane<unsigned char>(surfaces.width, surfaces.height);
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const Camera& camera = geometry.camera;
      const glm::dvec3 p =
          glm::transpose(camera.rotation) * glm::dvec3(surfaces[i].position) + camera.origin;
      is_box[i] = p.z > 1e-4;
      const glm::dvec3 was = is_box[i] ? p - kStep : p;
      const Camera last = camera_at(frame - 1);
      layer[i] = layer_scale * glm::vec2(last.project(last.to_camera(was)) -
                                         camera.project(glm::dvec3(surfaces[i].position)));
      if (!is_box[i]) continue;
      products.ao[i] = pattern(p - middle_at(frame)) + (frame % 2 ? 0.1f : -0.1f);
      products.visibility.sources[0][i] = products.ao[i];
    }
    findings = take_findings(products, geometry, {});
    if (before)
      findings.motion = find_object_motion(layer, findings.surfaces, before->findings.surfaces);
  }

  Geometry geometry;
  Plane<glm::vec2> layer;
  Plane<unsigned char> is_box;
  Findings findings;
};

class AMovingBox : public testing::Test {
 protected:
  AMovingBox() {
    for (int frame = 1; frame <= kFrames; ++frame)
      frames.push_back(
          std::make_unique<AFrame>(frame, frames.empty() ? nullptr : frames.back().get()));
    Lamp lamp;
    lamp.position = {0, 0, 6}, lamp.radius = 0.1;
    light.sources = {make_source(lamp, {now().geometry.camera.rotation, glm::dvec3(0)}, 1e-4)};
  }

  AFrame& at(int frame) { return *frames[std::size_t(frame - 1)]; }
  AFrame& now() { return at(kNow); }

  std::vector<OtherFindings> others() {
    std::vector<OtherFindings> all;
    for (int frame = kNow - 1; frame >= 1; --frame)
      all.push_back({&at(frame).findings, frame - kNow, &nothing, &nothing});
    for (int frame = kNow + 1; frame <= kFrames; ++frame)
      all.push_back({&at(frame).findings, frame - kNow, &nothing, &nothing});
    return all;
  }

  /// How often each frame shows a point of the box.
  std::vector<int> counts() {
    const std::vector<OtherFindings> all = others();
    PointTracker followed(now().findings);
    followed.reach(all);
    std::vector<std::vector<TrackedPoint>> row(all.size());
    std::vector<int> count(all.size());
    for (int y = 0; y < kWindow.height(); ++y) {
      followed.row(y, true, row);
      for (std::size_t k = 0; k < all.size(); ++k) count[k] += int(row[k].size());
    }
    return count;
  }

  Products fused() {
    Fusion fusion(now().findings, light);
    fusion.add(others(), true);
    return finished(fusion);
  }

  Products finished(Fusion& fusion) {
    Products products;
    products.visibility.sources.resize(1);
    fusion.finish(now().geometry, products);
    return products;
  }

  std::vector<std::unique_ptr<AFrame>> frames;
  Light light = model_light(Environment::constant(glm::vec3(1)), glm::mat3(1));
  const std::vector<MovedPiece> nothing;
};

TEST_F(AMovingBox, IsFoundWhereItWasAndWhereItWillBe) {
  const std::vector<OtherFindings> all = others();
  PointTracker followed(now().findings);
  followed.reach(all);
  std::vector<std::vector<TrackedPoint>> row(all.size());
  int box = 0, whole = 0;
  for (int y = 0; y < kWindow.height(); ++y) {
    followed.row(y, true, row);
    for (int x = 0; x < kWindow.width(); ++x) box += now().is_box(x, y);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const KeptSurfaces& there = all[k].findings->surfaces;
      int last = -1;
      for (const TrackedPoint& point : row[k]) {
        EXPECT_LT(last, point.x);
        last = point.x;
        EXPECT_TRUE(now().is_box(point.x, y));
        const float* w = point.weight;
        EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-5);
        if (!(w[0] > 0 && w[1] > 0 && w[2] > 0 && w[3] > 0)) continue;
        ++whole;
        const Camera& camera = now().geometry.camera;
        const glm::dvec3 p = glm::transpose(camera.rotation) *
                                 glm::dvec3(now().geometry.surfaces(point.x, y).position) +
                             camera.origin + double(all[k].away) * kStep;
        const glm::dvec2 wanted = there.camera.project(there.camera.to_camera(p)),
                         found = there.centre(std::size_t(point.pixel)) +
                                 glm::dvec2(double(w[1] + w[3]), double(w[2] + w[3]));
        EXPECT_LT(glm::distance(found, wanted), 0.16) << point.x << " " << y << " " << k;
        const double way = std::abs(all[k].away) * glm::length(kStep),
                     from_camera = glm::length(now().geometry.surfaces(point.x, y).position),
                     share = way / (0.05 * from_camera);
        EXPECT_NEAR(point.confidence, std::exp(-share * share), 0.05);
      }
    }
  }
  EXPECT_GT(box, 400);
  EXPECT_GT(whole, 4 * box);
}

/// The nearer the more it counts, and nothing of sources, whose shadows do not move along.
TEST_F(AMovingBox, TakesTheMeanOfTheSamePoint) {
  const Products mean = fused();
  double error = 0, alone = 0;
  for (std::size_t i = 0; i < mean.ao.size(); ++i) {
    if (!now().is_box[i]) continue;
    const Camera& camera = now().geometry.camera;
    const glm::dvec3 p =
        glm::transpose(camera.rotation) * glm::dvec3(now().geometry.surfaces[i].position) +
        camera.origin;
    const double wanted = double(pattern(p - middle_at(kNow)));
    error += std::abs(double(mean.ao[i]) - wanted), alone += 0.1;
    EXPECT_NEAR(double(mean.visibility.sources[0][i]), wanted - 0.1, 2e-3);
  }
  EXPECT_LT(error, 0.4 * alone);
}

/// The same bits as without a layer on what stands still.
TEST_F(AMovingBox, LeavesTheFloorAsItIs) {
  const Products with = fused();
  for (const auto& frame : frames) frame->findings.motion = {};
  const Products without = fused();
  int changed = 0;
  for (std::size_t i = 0; i < with.ao.size(); ++i) {
    if (now().is_box[i])
      changed += with.ao[i] != without.ao[i];
    else
      EXPECT_EQ(with.ao[i], without.ao[i]);
  }
  EXPECT_GT(changed, 400);
}

TEST_F(AMovingBox, IsLostWhereAFrameHasNoMotion) {
  for (const int count : counts()) EXPECT_GT(count, 300);
  at(3).findings.motion = {};  // leads from 3 to 2
  at(6).findings.motion = {};  // leads from 6 to 5
  const std::vector<int> left = counts();
  for (std::size_t k = 0; k < left.size(); ++k) EXPECT_EQ(left[k] > 0, k == 0 || k == 3) << k;
}

/// As where frames wait on disk: they come one after the other, and only the last one stays.
TEST_F(AMovingBox, IsFollowedThroughFramesThatComeOneByOne) {
  const Products wanted = fused();
  Fusion fusion(now().findings, light);
  Findings slots[2];
  int slot = 0;
  for (const OtherFindings& other : others()) {
    slots[slot] = *other.findings;
    fusion.add({{&slots[slot], other.away, &nothing, &nothing}}, other.away == kFrames - kNow);
    slot = 1 - slot;
    slots[slot] = {};
  }
  EXPECT_EQ(finished(fusion).ao.pixels, wanted.ao.pixels);
}

/// Vectors to the next frame, which other renderers write.
TEST_F(AMovingBox, ALayerOfAnotherSignIsNotUsed) {
  EXPECT_FALSE(now().findings.motion.contradicts);
  EXPECT_TRUE(now().findings.motion.is_known);
  const AFrame other(kNow, &at(3), -1);
  EXPECT_TRUE(other.findings.motion.contradicts);
  EXPECT_FALSE(other.findings.motion.is_known);
}

}  // namespace
}  // namespace ssdo::test::point_tracker_test
