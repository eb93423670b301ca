// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <memory>
#include <random>

#include "hard/hard_cases.h"

namespace ssdo::test {
namespace {

/// Two tiles of threads, and no whole number of vectors.
const Window kWindow{0, 0, 71, 36};
constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNan = std::numeric_limits<float>::quiet_NaN();

std::shared_ptr<Plane<glm::vec3>> sky_map() {
  auto map = std::make_shared<Plane<glm::vec3>>(32, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 32; ++x) (*map)(x, y) = glm::vec3(0.4f, 0.6f, 1) * (y < 8 ? 1.0f : 0.2f);
  (*map)(12, 4) = glm::vec3(20);
  return map;
}

HardFrame open(HardFrame frame) {
  frame.open_plane = true;
  return frame;
}

HardFrame plane_at(double degrees, bool orthographic, const Window& window = kWindow) {
  const Camera projection =
      orthographic ? camera_from_ortho_width(3.2, window, 1) : camera_from_fov(30, window, 1);
  return open(hard_frame(ground(), leaning(projection, degrees), window));
}

HardFrame still_life(const Camera& projection, double distance = 6) {
  return hard_frame(hard_still_life(), leaning(projection, 50, distance), kWindow);
}

/// A plane from 1e-3 in front of the viewer to 1e6 away.
HardFrame near_and_far() {
  const Camera camera =
      look_at(camera_from_fov(60, kWindow, 1), {0, 0, 1e-3}, {0, 1, 8e-4}, {0, 0, 1});
  HardFrame frame =
      hard_frame(cut(ground(), [](const glm::dvec3& p) { return p.y < 1e6; }), camera, kWindow);
  frame.radius = 0.01f;
  return open(std::move(frame));
}

/// Bars and a slanted wire, one pixel wide, before a wall.
HardFrame wires() {
  HardFrame frame = hard_frame(ground(), leaning(camera_from_fov(30, kWindow, 1), 10), kWindow);
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x < kWindow.width(); ++x) {
      if (x % 5 != 0 && x != y) continue;
      const Surfel s = frame.geometry.surfaces(x, y);
      frame.geometry.surfaces.set(x, y, {0.95f * s.position, {0, 0, 1}, s.rounding});
    }
  }
  return frame;
}

/// Pixels in the order of a shuffle that is the same everywhere.
std::vector<std::size_t> some_pixels(const Geometry& g, unsigned share) {
  std::mt19937 random(5);
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < g.surfaces.size(); ++i)
    if (random() % share == 0) pixels.push_back(i);
  return pixels;
}

/// Every odd number in every channel of a surfel, here and there.
HardFrame broken_values() {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  const std::array odd = {kNan,  kInfinity, -kInfinity, 0.0f,    1e-40f, -1e-40f,
                          3e38f, -3e38f,    1e19f,      -1e-30f, 5.0f};
  std::size_t n = 0;
  for (const std::size_t i : some_pixels(frame.geometry, 6)) {
    Surfel s = frame.geometry.surfaces[i];
    const float value = odd[n % odd.size()];
    const std::size_t channel = n++ / odd.size() % 9;
    if (channel < 3) s.position[int(channel)] = value;
    if (channel >= 3 && channel < 6) s.normal[int(channel) - 3] = value;
    if (channel == 6) s.rounding = value;
    if (channel == 7) s.position = glm::vec3(value), s.rounding = std::max(s.rounding, 0.0f);
    if (channel == 8) s.normal = glm::vec3(value), s.rounding = 1e-7f;
    frame.geometry.surfaces.set(i, s);
  }
  return frame;
}

/// Positions that no frame has, side by side: all of it is what a broken transform makes.
HardFrame all_positions(const glm::vec3& position) {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  for (std::size_t i = 0; i < frame.geometry.surfaces.size(); i += 3)
    frame.geometry.surfaces.set_position(i, position), frame.geometry.surfaces.rounding[i] = 0;
  return frame;
}

/// Smooth normals that lean away from the viewer.
HardFrame normals_away() {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  for (const std::size_t i : some_pixels(frame.geometry, 3)) {
    frame.geometry.surfaces.set_normal(i, -frame.geometry.surfaces[i].normal);
  }
  return frame;
}

HardFrame background_only() {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  frame.geometry.surfaces = Surfaces(kWindow.width(), kWindow.height());
  return open(std::move(frame));
}

Camera off_centre() {
  Camera camera = camera_from_fov(30, kWindow, 1);
  camera.cx += 60, camera.cy -= 25;
  return camera;
}

HardFrame lit_by(const std::function<void(Plane<glm::vec3>&)>& change) {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  const auto map = sky_map();
  change(*map);
  frame.environment = Environment(map, {});
  return frame;
}

HardFrame with_albedo(float albedo, int bounces) {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  frame.albedo = Plane<HalfColor>(kWindow.width(), kWindow.height(), glm::vec3(albedo));
  frame.bounces = bounces;
  return frame;
}

HardFrame with_radius(float radius) {
  HardFrame frame = still_life(camera_from_fov(30, kWindow, 1));
  frame.radius = radius;
  return frame;
}

void add_planes(std::vector<HardCase>& cases) {
  for (const double degrees : {0.0, 45.0, 85.0, 89.0, 89.9}) {
    for (const bool orthographic : {false, true}) {
      std::string name = fmt::format("plane_tilted_by_{:g}_degrees{}", degrees,
                                     orthographic ? "_in_parallel_view" : "");
      std::replace(name.begin(), name.end(), '.', '_');
      cases.push_back({name, [=] { return plane_at(degrees, orthographic); }});
    }
  }
  cases.push_back({"plane_from_1e_3_to_1e6_away", near_and_far});
}

void add_views(std::vector<HardCase>& cases) {
  const auto add = [&](const std::string& name, const Camera& projection, double distance) {
    cases.push_back({name, [=] { return still_life(projection, distance); }});
    cases.push_back(
        {"plane_" + name,
         [=] { return open(hard_frame(ground(), leaning(projection, 50, distance), kWindow)); }});
  };
  add("view_of_1_degree", camera_from_fov(1, kWindow, 1), 180);
  add("view_of_150_degrees", camera_from_fov(150, kWindow, 1), 1);
  add("view_off_centre", off_centre(), 6);
  add("view_without_perspective", camera_from_ortho_width(3.2, kWindow, 1), 6);
  add("pixels_twice_as_wide", camera_from_fov(30, kWindow, 2), 6);
}

void add_sizes(std::vector<HardCase>& cases) {
  for (const Window& window : {Window{0, 0, 1, 1}, Window{0, 0, 1, 40}, Window{0, 0, 40, 1},
                               Window{0, 0, 2, 3}, Window{7, -3, 24, 10}, Window{-5, 2, 28, 45}}) {
    const std::string size = fmt::format("{}_by_{}_pixels", window.width(), window.height());
    cases.push_back({size, [=] {
                       return hard_frame(hard_still_life(),
                                         leaning(camera_from_fov(20, window, 1), 40), window);
                     }});
    cases.push_back({"plane_of_" + size, [=] { return plane_at(40, false, window); }});
  }
}

}  // namespace

Surface ground() { return plane({}, {0, 0, 1}); }

Surface hard_still_life() {
  return all_of({cut(ground(), [](const glm::dvec3& p) { return p.y < 0; }),
                 cut(plane({}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; }),
                 sphere({0.4, -0.7, 0.4}, 0.4), sphere({-0.6, -0.4, 0.25}, 0.25)});
}

Environment plain_sky() { return {sky_map(), {}}; }

Camera leaning(const Camera& projection, double degrees, double distance) {
  const double t = glm::radians(degrees);
  return look_at(projection, distance * glm::dvec3(0, -std::sin(t), std::cos(t)), {},
                 {0, std::cos(t), std::sin(t)});
}

Camera usual_camera(const Window& display) { return leaning(camera_from_fov(30, display, 1), 50); }

HardFrame hard_frame(const Surface& scene, const Camera& camera, const Window& window) {
  HardFrame frame{geometry_of(scene, camera, window),
                  Plane<HalfColor>(window.width(), window.height(), glm::vec3(0.6f, 0.5f, 0.4f)),
                  plain_sky()};
  return frame;
}

std::vector<HardCase> scene_cases() {
  std::vector<HardCase> cases;
  add_planes(cases);
  add_views(cases);
  add_sizes(cases);
  cases.push_back({"wires_of_one_pixel", wires});
  cases.push_back({"broken_values", broken_values});
  int n = 0;
  for (const glm::vec3& p :
       {glm::vec3(kNan), glm::vec3(0), glm::vec3(1e30f, 0, -1e30f), glm::vec3(0, 0, -1e-40f),
        glm::vec3(0, 0, -1e-14f), glm::vec3(0, 0, 5), glm::vec3(3e38f, 3e38f, -1)})
    cases.push_back({fmt::format("broken_positions_{}", ++n), [=] { return all_positions(p); }});
  cases.push_back({"normals_that_face_away", normals_away});
  cases.push_back({"background_only", background_only});
  cases.push_back(
      {"sun_of_1e5", [] { return lit_by([](auto& map) { map(12, 4) = glm::vec3(1e5f); }); }});
  cases.push_back({"light_of_negative_lobes", [] {
                     return lit_by([](auto& map) {
                       for (std::size_t i = 0; i < map.size(); i += 3) map[i] *= -3.0f;
                     });
                   }});
  cases.push_back({"light_of_nothing", [] {
                     return lit_by([](auto& map) {
                       for (glm::vec3& c : map.pixels) c = glm::vec3(0);
                     });
                   }});
  cases.push_back({"albedo_3_and_8_bounces", [] { return with_albedo(3, 8); }});
  cases.push_back({"albedo_1e9_and_8_bounces", [] { return with_albedo(1e9f, 8); }});
  cases.push_back({"radius_below_a_pixel", [] { return with_radius(1e-3f); }});
  cases.push_back({"radius_of_almost_nothing", [] { return with_radius(1e-30f); }});
  cases.push_back({"radius_above_the_frame", [] { return with_radius(1e4f); }});
  cases.push_back({"radius_of_almost_everything", [] { return with_radius(1e30f); }});
  return cases;
}

}  // namespace ssdo::test
