// SPDX-License-Identifier: Apache-2.0
//
// Pictures of back faces from the frame's own camera: told from other views, exact thicknesses, and
// what they are worth against rays through the scene.
#include "scene/further/back_faces.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "estimators/bitmask/request.h"
#include "scene/further/further_pictures.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test {
namespace {

using testing::ContainsRegex;
using testing::Not;

const Window kFrame{0, 0, 160, 120};
const Box kSlab{{-1, -0.8, 0.7}, {0.8, 0.6, 0.85}};
const glm::dvec3 kEye(0.5, -4, 3), kTarget(0, 0, 0.3), kBall(1.5, 0.8, 0.5);
constexpr double kBallRadius = 0.4;

/// What is left of a box when its front faces are culled.
Surface back_of(const Box& box) {
  return [box](const Ray& ray) -> std::optional<Hit> {
    const auto [enter, leave] = box.cross(ray);
    if (enter > leave || leave < 1e-9) return std::nullopt;
    const glm::dvec3 p = ray.origin + leave * ray.direction;
    Hit hit{leave, glm::dvec3(0)};
    for (int c = 0; c < 3; ++c) {
      if (std::abs(p[c] - box.low[c]) < 1e-9) hit.normal[c] = -1;
      if (std::abs(p[c] - box.high[c]) < 1e-9) hit.normal[c] = 1;
    }
    hit.normal = glm::normalize(hit.normal);
    return hit;
  };
}

/// How far a ray goes through a ball: none where it is missed.
std::optional<double> chord(const glm::dvec3& centre, double radius, const Ray& ray) {
  const glm::dvec3 way = centre - ray.origin, along = glm::normalize(ray.direction);
  const double middle = glm::dot(way, along),
               half2 = radius * radius - glm::dot(way, way) + middle * middle;
  if (half2 <= 0) return std::nullopt;
  return 2 * std::sqrt(half2);
}

Surface back_of_ball() {
  return [](const Ray& ray) -> std::optional<Hit> {
    const auto front = sphere(kBall, kBallRadius)(ray);
    const auto through = chord(kBall, kBallRadius, ray);
    if (!front || !through) return std::nullopt;
    const double t = front->distance + *through / glm::length(ray.direction);
    return Hit{t, glm::normalize(ray.origin + t * ray.direction - kBall)};
  };
}

Surface scene() {
  return all_of({plane({}, {0, 0, 1}), kSlab.surface(), sphere(kBall, kBallRadius)});
}

/// The ground is seen from its front, and culled.
Surface backs() { return all_of({back_of(kSlab), back_of_ball()}); }

Camera camera_of(const Window& window, bool orthographic = false) {
  return look_at(
      orthographic ? camera_from_ortho_width(4, window, 1) : camera_from_fov(45, window, 1), kEye,
      kTarget, {0, 0, 1});
}

Geometry frame_of_scene(const Camera& camera) {
  Geometry frame = geometry_of(scene(), camera, kFrame);
  frame.median_depth = float(glm::distance(kEye, kTarget));
  return frame;
}

class BackFaces : public testing::Test {
 protected:
  std::string write(const std::string& name, const Surface& shown, const Camera& camera,
                    const Window& window, bool turn_normals = false) {
    Picture picture = take_picture(shown, camera, window);
    if (turn_normals)
      for (glm::vec3& n : picture.normal.pixels) n = -n;
    FramePart part = frame_of(picture);
    part.display = {0, 0, window.x0 + window.x1, window.y0 + window.y1};
    write_frame(folder.path() / name, part);
    return folder.path() / name;
  }

  std::optional<Plane<float>> find(const std::string& file, const Geometry& frame) {
    return find_back_faces(place(FurtherPictures().also(file), frame), frame);
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
  solids.end = Plane<Origin>(kFrame.width(), kFrame.height(), Origin::guessed);
  solids.end[0] = Origin::measured;
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

/// The ground beside and below a slab sees the sky under it.
TEST_F(BackFaces, OpenWhatIsBelowASlab) {
  const Camera camera = camera_of(kFrame);
  const std::string frame = write("frame.exr", scene(), camera, kFrame),
                    back = write("back.exr", backs(), camera, kFrame),
                    out = folder.path() / "out.exr";
  const auto ao = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {
        frame, "-o",           out,     "--overwrite", "--products",
        "ao",  "--pixel-type", "float", "--quality",   "final"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished run = run_tool(arguments);
    EXPECT_EQ(run.code, 0) << run.err;
    return channel(out, "ao.Y");
  };
  const auto rmse = [&](const Plane<float>& found) {
    double sum = 0;
    int count = 0;
    for (int y = 12; y < kFrame.height() - 12; y += 6) {
      for (int x = 12; x < kFrame.width() - 12; x += 6) {
        const Point p = point_at(scene(), camera, kFrame, x, y);
        if (p.position.z > 1e-6 || std::abs(p.position.x) > 1.6 || std::abs(p.position.y) > 1.6)
          continue;
        sum += std::pow(double(found(x, y)) - ao_by_rays(scene(), p, kNoLimit, 2048), 2);
        ++count;
      }
    }
    EXPECT_GT(count, 40);
    return std::sqrt(sum / count);
  };
  for (const std::string method : {"bitmask", "trace"}) {
    const double alone = rmse(ao({"--method", method})),
                 known = rmse(ao({"--method", method, "--also", back})),
                 given = rmse(ao({"--method", method, "--also", back, "--thickness", "3"}));
    fmt::print("{}: RMSE {:.4f} alone, {:.4f} with back faces, {:.4f} with a thickness given too\n",
               method, alone, known, given);
    EXPECT_LT(known, 0.5 * alone) << method;
    EXPECT_LT(given, 0.7 * alone) << method << ": what is measured wins";
  }
  EXPECT_EQ(ao({"--also", back, "--threads", "1"}).pixels,
            ao({"--also", back, "--threads", "3"}).pixels);
  EXPECT_THAT(run_tool({"info", frame, "--also", back}).out,
              ContainsRegex("back.exr: back faces .* in [1-9][0-9]* pixels"));
  EXPECT_THAT(run_tool({"info", frame, "--also", frame}).out, Not(ContainsRegex("back faces")));
}

}  // namespace
}  // namespace ssdo::test
