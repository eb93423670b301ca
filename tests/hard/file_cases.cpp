// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "hard/hard_cases.h"
#include "relight/frame.h"
#include "relight/relight.h"
#include "support/average_picture.h"
#include "support/temp_dir.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 48, 36};
constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNan = std::numeric_limits<float>::quiet_NaN();

/// A picture, and how its file is made of it.
struct Writing {
  Surface scene = hard_still_life();
  Window window = kWindow, display = kWindow;
  double pixel_aspect = 1;
  glm::dvec3 moved{0};  ///< from the world's origin
  Imf::PixelType type = Imf::FLOAT;
  double fov = 0;  ///< given with --fov
  double degrees = 50;
  bool depth = true, normals = true;
  float position_error = 1e-4f;
  std::function<void(Picture&)> change = {};
  std::function<void(FramePart&)> change_part = {};
};

HardFrame written(const Writing& how) {
  Camera camera = leaning(camera_from_fov(30, how.display, how.pixel_aspect), how.degrees);
  camera.origin += how.moved;
  const Surface scene = [&](const Ray& ray) {
    return how.scene({ray.origin - how.moved, ray.direction});
  };
  HardFrame frame = hard_frame(scene, camera, how.window);
  frame.shown = frame.geometry.surfaces;
  frame.position_error = how.position_error;
  Picture picture = take_picture(scene, camera, how.window);
  if (how.change) how.change(picture);
  FramePart part = frame_of(picture);
  part.display = how.display;
  part.type = how.type;
  part.extra.pixelAspectRatio() = float(how.pixel_aspect);
  if (!how.depth) part.channels.erase("ViewLayer.Depth.Z");
  if (!how.normals)
    for (const char c : {'X', 'Y', 'Z'}) part.channels.erase(std::string("ViewLayer.Normal.") + c);
  if (how.change_part) how.change_part(part);
  frame.geometry = read_through_file(part, how.fov, &frame.albedo);
  return frame;
}

Surface ball() { return sphere({0, 0, 0}, 1.2); }

/// A ball before nothing, whose background is this in P.
HardFrame background(float value) {
  Writing how;
  how.scene = ball();
  how.depth = false;
  how.change = [=](Picture& picture) {
    for (std::size_t i = 0; i < picture.valid.size(); ++i)
      if (!picture.valid[i]) picture.position[i] = glm::vec3(value);
  };
  return written(how);
}

/// An odd value in some pixels of one layer.
HardFrame broken(const std::string& layer, bool depth) {
  Writing how;
  how.depth = depth;
  how.change_part = [=](FramePart& part) {
    const float odd[] = {kNan, kInfinity, -kInfinity, 1e-40f, -1e-40f, 3e38f, -3e38f};
    std::size_t n = 0;
    for (auto& [name, plane] : part.channels) {
      if (name.find(layer) == std::string::npos) continue;
      for (std::size_t i = 11 + n; i < plane.size(); i += 37) plane[i] = odd[n++ % 7];
    }
  };
  HardFrame frame = written(how);
  return frame;
}

HardFrame changed_normals(const std::function<glm::vec3(const glm::vec3&, std::size_t)>& change) {
  Writing how;
  how.change = [&](Picture& picture) {
    for (std::size_t i = 0; i < picture.normal.size(); ++i)
      picture.normal[i] = change(picture.normal[i], i);
  };
  return written(how);
}

HardFrame windows(const Window& data, const Window& display) {
  Writing how;
  how.window = data, how.display = display;
  return written(how);
}

HardFrame averaged(const Surface& scene) {
  const Camera camera = usual_camera(kWindow);
  HardFrame frame = hard_frame(scene, camera, kWindow);
  Plane<unsigned char> ignored;
  FramePart part = frame_of(average_picture(scene, camera, kWindow, 4, ignored));
  part.channels.erase("ViewLayer.Depth.Z");
  frame.geometry = read_through_file(part);
  return frame;
}

HardFrame open_plane(Writing how) {
  how.scene = ground();
  how.fov = 30;
  HardFrame frame = written(how);
  frame.open_plane = true;
  return frame;
}

Writing rough(Imf::PixelType type, const glm::dvec3& moved, float position_error) {
  Writing how;
  how.type = type, how.moved = moved, how.position_error = position_error;
  return how;
}

}  // namespace

Geometry read_through_file(const FramePart& part, double fov, Plane<HalfColor>* albedo) {
  const TempDir dir;
  write_frame(dir / "frame.exr", part);
  FrameOptions options;
  if (fov > 0) options.camera.fov = fov;
  OtherPictures pictures;
  Frame frame = prepare_frame(options, Lighting(options.light), pictures,
                              {(dir / "frame.exr").string(), {}, {}});
  if (albedo) *albedo = std::move(frame.scene.senders.albedo);
  return std::move(frame.scene.geometry);
}

std::vector<HardCase> faithful_file_cases() {
  const glm::dvec3 far(60, -40, 50), farther(1e6, -1e6, 1e6);
  std::vector<HardCase> cases = {
      {"half_positions", [] { return written(rough(Imf::HALF, {}, 0.01f)); }},
      {"half_positions_far_from_the_origin", [=] { return written(rough(Imf::HALF, far, 0.1f)); }},
      {"origin_1e6_away",
       [=] {
         Writing how = rough(Imf::FLOAT, farther, 0.1f);
         how.fov = 30;  // steps of a pixel's size leave the focal length open
         return written(how);
       }},
      {"plane_of_half_positions", [] { return open_plane(rough(Imf::HALF, {}, 0.01f)); }},
      {"plane_of_half_positions_far_from_the_origin",
       [=] { return open_plane(rough(Imf::HALF, far, 0.1f)); }},
      {"plane_with_the_origin_1e6_away",
       [=] { return open_plane(rough(Imf::FLOAT, farther, 0.1f)); }},
      {"pixel_aspect_2_in_the_header",
       [] {
         Writing how;
         how.pixel_aspect = 2;
         return written(how);
       }},
      {"no_normals",
       [] {
         Writing how;
         how.scene = ground();
         how.fov = 30;
         how.normals = false;
         return written(how);
       }},
      {"data_window_beyond_the_display",
       [] {
         return windows({-9, -7, 60, 41}, kWindow);
       }},
      {"data_window_inside_the_display",
       [] {
         return windows({7, 5, 41, 33}, kWindow);
       }},
      {"data_window_across_the_display",
       [] {
         return windows({20, -11, 61, 30}, kWindow);
       }},
  };
  cases.push_back({"background_as_0", [] { return background(0); }});
  cases.push_back({"background_as_1e10", [] { return background(1e10f); }});
  cases.push_back({"background_as_infinity", [] { return background(kInfinity); }});
  cases.push_back({"background_as_nan", [] { return background(kNan); }});
  cases.push_back({"background_as_infinity_in_depth", [] {
                     Writing how;
                     how.scene = ball();
                     how.change_part = [](FramePart& part) {
                       for (float& z : part.channels["ViewLayer.Depth.Z"].pixels)
                         if (z > 1e9f) z = kInfinity;
                     };
                     return written(how);
                   }});
  cases.push_back({"normals_turned_round",
                   [] { return changed_normals([](auto& n, std::size_t) { return -n; }); }});
  cases.push_back({"normals_of_any_length", [] {
                     return changed_normals(
                         [](auto& n, std::size_t i) { return n * std::exp2(float(i % 13) - 6); });
                   }});
  cases.push_back({"normals_from_0_to_1", [] {
                     return changed_normals([](auto& n, std::size_t) { return n * 0.5f + 0.5f; });
                   }});
  cases.push_back({"normals_of_zero_length_here_and_there", [] {
                     return changed_normals(
                         [](auto& n, std::size_t i) { return i % 7 == 0 ? glm::vec3(0) : n; });
                   }});
  return cases;
}

std::vector<HardCase> file_cases() {
  std::vector<HardCase> cases = faithful_file_cases();
  cases.push_back({"averaged_silhouettes", [] { return averaged(hard_still_life()); }});
  cases.push_back({"averaged_silhouettes_before_nothing", [] { return averaged(ball()); }});
  for (const std::string layer : {"Position", "Normal", "DiffCol", "Depth"})
    cases.push_back({"broken_" + layer, [=] { return broken(layer, true); }});
  cases.push_back({"broken_Position_without_depth", [] { return broken("Position", false); }});
  return cases;
}

}  // namespace ssdo::test
