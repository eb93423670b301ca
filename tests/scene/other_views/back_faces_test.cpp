// SPDX-License-Identifier: Apache-2.0
//
// Pictures of back faces from the frame's own camera: told from other views, with exact
// thicknesses.
#include "scene/other_views/back_faces.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "scene/other_views/other_pictures.h"
#include "support/slab_and_ball.h"
#include "support/temp_dir.h"

namespace ssdo::test::back_faces_test {
namespace {

Geometry frame_of_scene(const Camera& camera) {
  Geometry frame = geometry_of(scene(), camera, kFrame);
  frame.median_depth = float(glm::distance(kEye, kTarget));
  return frame;
}

class BackFaces : public testing::Test {
 protected:
  std::optional<Plane<float>> find(const std::string& file, const Geometry& frame) {
    return find_back_faces(place(OtherPictures().also(file), frame), frame);
  }

  std::string write(const std::string& name, const Surface& shown, const Camera& camera,
                    const Window& window, bool turn_normals = false) {
    return write_view(folder.path() / name, shown, camera, window, turn_normals);
  }

  TempDir folder;
};

TEST_F(BackFaces, GiveExactThicknessesWhicheverWayTheirNormalsPoint) {
  for (const bool orthographic : {false, true}) {
    const Camera camera = camera_of(kFrame, orthographic);
    const Geometry frame = frame_of_scene(camera);
    for (const bool turn : {false, true}) {
      const auto found = find(write("backs.exr", backs(), camera, kFrame, turn), frame);
      ASSERT_TRUE(found) << orthographic << turn;
      int measured = 0;
      for (int y = 0; y < kFrame.height(); ++y) {
        for (int x = 0; x < kFrame.width(); ++x) {
          const Ray ray = ray_through(camera, x + 0.5, y + 0.5);
          const auto hit = scene()(ray), back = backs()(ray);
          if (!hit) continue;
          const float distance = (*found)(x, y);
          // The ground before them is not theirs: its ray meets them behind it nowhere.
          if (!back) {
            EXPECT_TRUE(std::isinf(distance));
            continue;
          }
          const double expected = (back->distance - hit->distance) * glm::length(ray.direction);
          if (expected < 0.01) continue;
          EXPECT_NEAR(distance, expected, 1e-4) << x << " " << y;
          ++measured;
        }
      }
      EXPECT_GT(measured, 2000);
    }
  }
}

TEST_F(BackFaces, MayBeOfAnotherSizeAndWindow) {
  const Camera camera = camera_of(kFrame);
  const Geometry frame = frame_of_scene(camera);
  const Window half{0, 0, 80, 60}, wide{20, 15, 180, 135};
  Camera shifted = camera;
  shifted.cx += 20, shifted.cy += 15;
  const auto at_half = find(write("half.exr", backs(), camera_of(half), half), frame),
             in_wide = find(write("wide.exr", backs(), shifted, wide), frame),
             same = find(write("same.exr", backs(), camera, kFrame), frame);
  ASSERT_TRUE(at_half && in_wide && same);
  int close = 0, all = 0;
  for (std::size_t i = 0; i < same->size(); ++i) {
    if (std::isinf((*same)[i])) continue;
    EXPECT_NEAR((*in_wide)[i], (*same)[i], 1e-4);
    close += std::abs((*at_half)[i] - (*same)[i]) < 0.01;
    ++all;
  }
  fmt::print("{:.3f} of the pixels agree at half size\n", double(close) / all);
  EXPECT_GT(close, 0.9 * all) << "all but edges";
}

TEST_F(BackFaces, AreToldFromOtherViews) {
  const Camera camera = camera_of(kFrame),
               beside = look_at(camera_from_fov(45, kFrame, 1), {0.9, -4, 3}, kTarget, {0, 0, 1});
  const Geometry frame = frame_of_scene(camera);
  EXPECT_FALSE(find(write("same.exr", scene(), camera, kFrame), frame));
  EXPECT_FALSE(find(write("turned.exr", scene(), camera, kFrame, true), frame));
  EXPECT_FALSE(find(write("beside.exr", scene(), beside, kFrame), frame));
  EXPECT_FALSE(find(write("beside_backs.exr", backs(), beside, kFrame), frame));
  const Surface moved = all_of(
      {plane({}, {0, 0, 1}), kSlab.surface(), sphere(kBall + glm::dvec3(-0.2, 0, 0.1), 0.4)});
  EXPECT_FALSE(find(write("moved.exr", moved, camera, kFrame), frame));
  const Window around{0, 0, 512, 256};
  const Camera panorama = look_at(lat_long(around), kEye, kTarget, {0, 0, 1});
  FramePart part = frame_of(take_picture(scene(), panorama, around));
  part.channels.erase("ViewLayer.Depth.Z");
  write_frame(folder.path() / "around.exr", part);
  EXPECT_FALSE(find(folder.path() / "around.exr", frame));
}

/// Sheets that the frame sees from behind, as the walls of a hull from inside, stay guessed.
TEST_F(BackFaces, SayNothingAboutWhatTheFrameSeesFromBehind) {
  const Camera camera = camera_of(kFrame);
  const Geometry frame = frame_of_scene(camera);
  const auto found =
      find(write("hull.exr", all_of({backs(), plane({}, {0, 0, -1})}), camera, kFrame), frame);
  ASSERT_TRUE(found);
  const auto backs_only = find(write("backs.exr", backs(), camera, kFrame), frame);
  int sheets = 0;
  for (std::size_t i = 0; i < found->size(); ++i) {
    if (std::isfinite((*backs_only)[i]) || !frame.is_surface(i)) continue;
    EXPECT_TRUE(std::isinf((*found)[i]));
    ++sheets;
  }
  EXPECT_GT(sheets, 2000);
}

TEST_F(BackFaces, LeaveWhatADeepImageHasMeasured) {
  const Camera camera = camera_of(kFrame);
  const Geometry frame = frame_of_scene(camera);
  Solids solids = constant_thickness(frame, 0.5f);
  solids.end = Plane<Provenance>(kFrame.width(), kFrame.height(), Provenance::guessed);
  solids.end[0] = Provenance::measured;
  Plane<float> distance(kFrame.width(), kFrame.height(), 0.25f), nearer = distance;
  distance[2] = std::numeric_limits<float>::infinity();
  nearer[1] = 0.125f, nearer[2] = distance[2];
  end_at_back_faces(solids, {distance, nearer});
  EXPECT_EQ(solids.thickness[0], 0.5f);
  EXPECT_EQ(solids.thickness[1], 0.125f);
  EXPECT_EQ(solids.thickness[2], 0.5f);
  EXPECT_TRUE(solids.end_is_measured(1));
  EXPECT_FALSE(solids.end_is_measured(2));
}

}  // namespace
}  // namespace ssdo::test::back_faces_test
