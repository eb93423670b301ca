// SPDX-License-Identifier: Apache-2.0
//
// Views in another unit, with other axes, or of another scene.
#include "scene/other_views/registration.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "scene/other_views/other_pictures.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/temp_dir.h"

namespace ssdo::test::registration_test {
namespace {

using testing::HasSubstr;

const Window kFrame{0, 0, 120, 90}, kPanorama{0, 0, 128, 64}, kView{0, 0, 64, 48};
const glm::dvec3 kEye(1.2, -5, 1.3);

/// p -> unit * axes * p.
struct World {
  double unit = 1;
  glm::dmat3 axes{1.0};
};

/// Rows of the matrix that takes z-up to y-up.
const glm::dmat3 kYUp = glm::transpose(glm::dmat3{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}),
                 kSwapped = glm::transpose(glm::dmat3{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}});

class Registers : public testing::Test {
 protected:
  Registers() : frame_(geometry_of(scene_, pinhole(kFrame, kEye, {0, 0, 0.4}), kFrame)) {
    frame_.world_known = true;
  }

  static Camera pinhole(const Window& window, const glm::dvec3& eye, const glm::dvec3& target) {
    return look_at(camera_from_fov(50, window, 1), eye, target, {0, 0, 1});
  }

  Registration registered(const Surface& scene, const Camera& camera, const Window& window,
                          const World& world = {}) {
    Picture picture = take_picture(scene, camera, window);
    for (std::size_t i = 0; i < picture.position.size(); ++i) {
      if (!picture.valid[i]) continue;
      picture.position[i] = glm::vec3(world.unit * (world.axes * glm::dvec3(picture.position[i])));
      picture.normal[i] = glm::vec3(world.axes * glm::dvec3(picture.normal[i]));
    }
    FramePart part = frame_of(picture);
    part.channels.erase("ViewLayer.Depth.Z");
    const auto path = folder_.path() / fmt::format("view{}.exr", ++count_);
    write_frame(path, part);
    return register_view(place(OtherPictures().also(path), frame_), frame_);
  }

  Registration panorama(const World& world = {}) {
    return registered(scene_, look_at(lat_long(kPanorama), kEye, {0, 0, 1}, {0, 0, 1}), kPanorama,
                      world);
  }

  /// Most that a view of this scene shows off the surfaces of the scene, in the frame's world.
  double off(const OtherView& view) const {
    double most = 0;
    const glm::dmat3 to_world = glm::transpose(frame_.camera.rotation);
    const Surfaces seen = view.surfels_in_frame();
    for (const Surfel& s : seen) {
      if (!s.is_surface()) continue;
      const glm::dvec3 p = to_world * glm::dvec3(s.position) + frame_.camera.origin;
      const glm::dvec3 way = p - kEye;
      const auto hit = scene_({kEye, glm::normalize(way)});
      most = std::max(most, hit ? std::abs(hit->distance - glm::length(way)) : 1e9);
    }
    return most;
  }

  const Box box_{{-0.6, -0.5, 0}, {0.5, 0.5, 1.1}}, wall_{{-4, 3, 0}, {5, 3.2, 2.5}};
  const Surface scene_ = all_of({plane({}, {0, 0, 1}), box_.surface(), wall_.surface()});
  Geometry frame_;
  TempDir folder_;
  int count_ = 0;
};

TEST_F(Registers, AViewOfTheSceneAsItIs) {
  const Registration found = panorama();
  ASSERT_TRUE(found.view);
  EXPECT_EQ(found.warning, "");
  EXPECT_LT(off(*found.view), 0.02);
}

TEST_F(Registers, AViewInAnotherUnitOrWithOtherAxesAsItFits) {
  for (const World& world :
       {World{100, glm::dmat3(1)}, World{0.01, glm::dmat3(1)}, World{1 / 0.3048, glm::dmat3(1)},
        World{1, kYUp}, World{1, kSwapped}, World{100, kYUp}}) {
    const Registration found = panorama(world);
    ASSERT_TRUE(found.view) << found.warning;
    EXPECT_LT(off(*found.view), 0.05) << found.warning;
    EXPECT_THAT(found.warning, HasSubstr("view" + std::to_string(count_) + ".exr: "));
    EXPECT_EQ(found.warning.find("times as large") != std::string::npos, world.unit != 1)
        << found.warning;
  }
}

TEST_F(Registers, NoViewOfAnotherScene) {
  const Surface other = all_of({plane({0, 0, -1}, {0, 0, 1}), sphere({1, -1, 0.5}, 1.2),
                                Box{{-2, -4, -1}, {-1, 4, 2}}.surface()});
  const Registration found =
      registered(other, look_at(lat_long(kPanorama), kEye, {0, 0, 1}, {0, 0, 1}), kPanorama);
  EXPECT_FALSE(found.view);
  EXPECT_THAT(found.warning, HasSubstr("left out"));
}

/// Turned by 180 degrees it would fit what the frame shows of a room that is the same to both
/// sides.
TEST_F(Registers, TheOtherSideOfARoomAsItIs) {
  const Surface room = all_of({plane({}, {0, 0, 1}), plane({0, 0, 2.6}, {0, 0, -1}),
                               plane({0, 4, 0}, {0, -1, 0}), plane({0, -4, 0}, {0, 1, 0}),
                               plane({3, 0, 0}, {-1, 0, 0}), plane({-3, 0, 0}, {1, 0, 0})});
  const glm::dvec3 eye(0, 0, 1.4);
  frame_ = geometry_of(room, pinhole(kFrame, eye, {0, 1, 1.3}), kFrame);
  frame_.world_known = true;
  const Registration found = registered(room, pinhole(kView, eye, {0, -1, 1.3}), kView);
  EXPECT_TRUE(found.view);
  EXPECT_EQ(found.warning, "");
}

TEST_F(Registers, AViewThatSharesLittleAsItIs) {
  // The other side of the wall.
  const Registration found = registered(scene_, pinhole(kView, {0, 6, 1.5}, {0, 3.2, 1}), kView);
  EXPECT_TRUE(found.view);
  EXPECT_EQ(found.warning, "");
}

}  // namespace
}  // namespace ssdo::test::registration_test
