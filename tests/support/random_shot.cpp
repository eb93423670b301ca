// SPDX-License-Identifier: Apache-2.0
#include "support/random_shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "filters/registry.h"

namespace ssdo::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(),
                kNan = std::numeric_limits<float>::quiet_NaN();

/// Depth along the axis; where nothing is seen, that of the middle of what is.
double median_depth(const Plane<SeenPoint>& seen) {
  std::vector<double> depths;
  for (const SeenPoint& p : seen.pixels)
    if (p.surface) depths.push_back(-p.position.z);
  if (depths.empty()) return 1;
  std::nth_element(depths.begin(), depths.begin() + std::ptrdiff_t(depths.size() / 2),
                   depths.end());
  return depths[depths.size() / 2];
}

/// Width of the data window in the scene, at its median depth.
double width_of_view(const RandomShot& shot) {
  const Camera& camera = shot.lens.camera;
  return shot.lens.data.width() / camera.fx * (camera.orthographic ? 1 : median_depth(shot.seen));
}

void draw_pose(RandomNumbers& random, RandomShot& shot) {
  Pose& pose = shot.pose;
  if (random.chance(0.85)) pose.to_world = random_rotation(random);
  if (random.chance(0.15)) pose.to_world[0] = -pose.to_world[0];
  if (random.chance(0.5)) pose.unit = random.by_ratio(1e-4, 1e5);
  if (random.chance(0.7)) {
    const bool far = random.chance(0.2);
    const double away = far ? random.by_ratio(1, 1e6) : 10 * pose.unit;
    pose.origin = random.direction() * away;
  }
}

/// Displacement along the view rays, and pixels that show nothing.
void wear(RandomNumbers& random, const RandomLens& lens, Plane<SeenPoint>& seen) {
  const double noise = random.chance(0.25) ? random.by_ratio(1e-5, 0.5) : 0,
               holes = random.chance(0.25) ? random.by_ratio(0.01, 0.9) : 0;
  for (SeenPoint& p : seen.pixels) {
    const double by = std::exp(noise * random.between(-1, 1));
    if (lens.camera.orthographic)
      p.position.z *= by;
    else
      p.position *= by;
    if (random.chance(holes)) p = {};
  }
}

Plane<float> random_plane(RandomNumbers& random, const Window& window, double low, double high) {
  Plane<float> plane(window.width(), window.height());
  for (float& value : plane.pixels) value = float(random.between(low, high));
  return plane;
}

void add_color(RandomNumbers& random, RandomShot& shot, const std::string& layer, double low,
               double high) {
  for (const char c : {'R', 'G', 'B'})
    shot.colors[layer + (layer.empty() ? "" : ".") + c] =
        random_plane(random, shot.lens.data, low, high);
}

/// Layers beside the geometry, and which composite they are for.
void draw_colors(RandomNumbers& random, RandomShot& shot) {
  if (random.chance(0.9)) {
    const bool odd = random.chance(0.1);
    const double low = random.between(0, 1);
    add_color(random, shot, "albedo", odd ? -0.5 : low, odd ? 3 : random.between(low, 1));
  }
  if (random.chance(0.15)) shot.colors["A"] = random_plane(random, shot.lens.data, -0.05, 1.3);
  if (random.chance(0.2))
    shot.colors["roughness"] = random_plane(random, shot.lens.data, -0.2, 1.2);
  if (random.chance(0.1)) {
    add_color(random, shot, "", -0.1, 4);
    add_color(random, shot, "amb", 0, 2);
    shot.options.output.compose = random.one_of({Compose::occlude, Compose::add});
    shot.options.input.aovs.push_back(parse_layer_request("ambient=amb"));
  }
}

void draw_storage(RandomNumbers& random, RandomShot& shot) {
  if (random.chance(0.4)) {
    shot.options.input.gbuffer.space = Space::world;
    return;
  }
  if (random.chance(0.2)) shot.type = Imf::HALF;
  shot.has_position = random.chance(0.8);
  shot.has_depth = !shot.has_position || random.chance(0.2);
  shot.depth_kind = random.one_of({DepthKind::planar, DepthKind::ray, DepthKind::inverse});
  shot.normals =
      random.chance(0.6)
          ? StoredNormals::world
          : random.one_of({StoredNormals::camera, StoredNormals::colors, StoredNormals::none});
  shot.empty = random.one_of({0.0f, 0.0f, 1e10f, kInfinity, kNan});
  const bool has_lens = shot.lens.is_centred;
  if (random.chance(0.3)) shot.camera = GivenCamera::none;
  if (has_lens && random.chance(0.15)) shot.camera = GivenCamera::lens;
  if (!shot.has_position && shot.camera == GivenCamera::none) shot.camera = GivenCamera::file;
  GBufferOptions& reading = shot.options.input.gbuffer;
  if (shot.has_depth) reading.depth_kind = shot.depth_kind;
  const bool in_world = shot.normals == StoredNormals::world && shot.has_position;
  if (in_world && random.chance(0.8)) reading.space = Space::world;
}

void draw_broken(RandomNumbers& random, RandomShot& shot) {
  if (!random.chance(0.2)) return;
  const double share = random.by_ratio(0.003, 0.5);
  for (std::size_t pixel = 0; pixel < shot.seen.size(); ++pixel) {
    if (!random.chance(share)) continue;
    shot.broken.push_back({std::size_t(random.whole(0, 99)), pixel,
                           random.one_of({kNan, kInfinity, -kInfinity, 0.0f, 1e-40f, -1e-40f, 3e38f,
                                          -3e38f, 1e19f, -1e-30f, 5.0f, 65504.0f})});
  }
}

/// Six faces of a cube in a row, a column or a cross are no lat-long map, and are refused.
bool has_shape_of_faces(const Plane<glm::vec3>& map) {
  const int w = map.width, h = map.height;
  return w == 6 * h || h == 6 * w || 4 * w == 3 * h || 3 * w == 4 * h;
}

void draw_light(RandomNumbers& random, RandomShot& shot) {
  LightOptions& light = shot.options.light;
  if (random.chance(0.4)) {
    const double blue = random.one_of({0.0, 1.0, 1e4}), green = random.between(0, 2),
                 red = random.by_ratio(1e-3, 10);
    light.env = fmt::format("{:.6g},{:.6g},{:.6g}", red, green, blue);
    return;
  }
  const int height = random.whole(1, 8), width = random.whole(1, 16);
  shot.map = Plane<glm::vec3>(width, height);
  if (has_shape_of_faces(shot.map)) shot.map = Plane<glm::vec3>(16, 8);
  const double low = random.chance(0.05) ? -1 : random.between(0, 1);
  for (glm::vec3& texel : shot.map.pixels)
    for (int c = 0; c < 3; ++c) texel[c] = float(random.between(low, 1));
  for (int suns = random.chance(0.5) ? random.whole(1, 3) : 0; suns > 0; --suns)
    shot.map[std::size_t(random.bits() % shot.map.size())] = glm::vec3(random.by_ratio(3, 1e4));
  if (random.chance(0.05)) std::fill(shot.map.pixels.begin(), shot.map.pixels.end(), glm::vec3(0));
  light.up = random.one_of({UpAxis::y, UpAxis::z});
  if (random.chance(0.3)) light.rotate_degrees = random.between(-360, 360);
  if (random.chance(0.2)) light.exposure_stops = random.between(-10, 10);
}

/// The settings of a method's own parameters; rays and samples stay few.
std::vector<std::string> random_settings(RandomNumbers& random, const Method& method) {
  constexpr double kMostCount = 24;
  std::vector<std::string> set;
  if (method.is_reference) set.push_back(fmt::format("samples={}", random.whole(4, 16)));
  const bool unusual = random.chance(0.3);
  for (const Parameter& p : method.parameters) {
    if (p.name == kIndexOfRefraction.name) {
      // Takes no random number, so that all else of a seed stays as it was.
      if (unusual) set.push_back(fmt::format("{}=1.33", p.name));
      continue;
    }
    if (!unusual || !random.chance(0.4) || (method.is_reference && p.name == "samples")) continue;
    const double high = p.whole ? std::min(p.high, std::max(kMostCount, p.low)) : p.high;
    double value = random.chance(0.3) ? random.one_of({p.low, high}) : random.between(p.low, high);
    if (random.chance(0.5))
      value = std::min(high, std::max(p.low, p.value * random.by_ratio(0.3, 3)));
    if (p.whole) value = std::round(value);
    set.push_back(fmt::format("{}={:.9g}", p.name, value));
  }
  return set;
}

void draw_march(RandomNumbers& random, ModelOptions& model, const Method& method, double width) {
  if (method.supports.march) {
    model.quality = random.one_of({Quality::draft, Quality::standard});
    if (random.chance(0.4)) model.slices = random.whole(1, 5);
    if (random.chance(0.4)) model.steps = random.whole(1, 20);
    model.extend_offscreen = random.chance(0.7);
    if (random.chance(0.01)) model.error = random.by_ratio(0.02, 1);
  }
  if (method.supports.radius && random.chance(0.6)) {
    model.radius = width * random.by_ratio(0.02, 3);
    if (random.chance(0.1)) model.radius = random.one_of({1e-30, 1e-3, 1e4, 1e30}) * width;
    if (random.chance(0.1) && method.supports.infinite_radius) model.radius = kInfinity;
  }
  if (method.supports.thickness && random.chance(0.5))
    model.thickness = random.chance(0.3) ? kInfinity : width * random.by_ratio(1e-4, 3);
}

void draw_model(RandomNumbers& random, RandomShot& shot) {
  ModelOptions& model = shot.options.model;
  const Method& method = random.chance(0.4)
                             ? methods().front()
                             : methods()[std::size_t(random.whole(0, int(methods().size()) - 1))];
  model.method = method.name;
  model.set = random_settings(random, method);
  draw_march(random, model, method, width_of_view(shot));
  model.bounces = random.chance(0.5) ? 1 : random.whole(0, 8);
  model.seed = unsigned(random.bits() % 1000);
  const auto filter = std::size_t(random.whole(0, int(filters().size())));
  model.filter = filter < filters().size() ? filters()[filter].name : kPublishedFilter;
  OutputOptions& output = shot.options.output;
  if (random.chance(0.3)) output.products = {std::string(kAllProducts)};
  output.pixel_type = random.one_of({Imf::HALF, Imf::FLOAT});
  output.crop = random.chance(0.1);
  const Window& display = shot.lens.display;
  if (display.width() % 2 == 0 && display.height() % 2 == 0 && random.chance(0.1))
    output.downsample = 2;
}

void draw_further(RandomNumbers& random, const Surface& world, RandomShot& shot) {
  if (!random.chance(0.15)) return;
  FurtherLook further{random_lens(random), {}};
  const double depth = median_depth(shot.seen);
  const double away = depth * random.between(0, 1);
  const glm::dvec3 eye = random.direction() * away;
  const glm::dmat3 turn = random.chance(0.5) ? glm::dmat3(1) : random_rotation(random);
  further.seen = look(world, further.lens, turn, eye);
  shot.further = std::move(further);
}

template <class T>
Plane<T> part_of_plane(const Plane<T>& plane, const Window& from, const Window& to) {
  Plane<T> out(to.width(), to.height());
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) out(x, y) = plane(x + to.x0 - from.x0, y + to.y0 - from.y0);
  return out;
}

}  // namespace

bool RandomShot::is_plain() const {
  constexpr double kFarthest = 1e8;  // well before what counts as background
  const bool fits = std::all_of(seen.pixels.begin(), seen.pixels.end(), [&](const SeenPoint& p) {
    if (!p.surface) return true;
    const double farthest = glm::length(pose.origin) + pose.unit * glm::length(p.position),
                 depth = lens.camera.orthographic ? 1 : -p.position.z,
                 pixel = pose.unit * depth / std::max(lens.camera.fx, lens.camera.fy);
    return farthest < kFarthest && farthest / 16777216 < 1e-3 * pixel;
  });
  // Below the rounding of P, it is rounding that decides what is hidden.
  const auto& radius = options.model.radius;
  const bool reaches = !radius || *radius > 0.01 * width_of_view(*this);
  return fits && reaches && !further && type == Imf::FLOAT && has_position && !has_depth &&
         broken.empty() && camera == GivenCamera::file && options.input.gbuffer.space;
}

bool RandomShot::has_energy_of_nature() const {
  return std::all_of(map.pixels.begin(), map.pixels.end(), [](const glm::vec3& t) {
    return std::min({t.x, t.y, t.z}) >= 0;
  });
}

std::string RandomShot::describe() const {
  const auto window = [](const Window& w) {
    return fmt::format("{}x{}{:+}{:+}", w.width(), w.height(), w.x0, w.y0);
  };
  const Camera& c = lens.camera;
  std::string text = fmt::format(
      "{} in {}, {} fx {:.3g}, unit {:.3g}, origin {:.3g}, {} method {}", window(lens.data),
      window(lens.display), c.orthographic ? "ortho" : "persp", c.fx, pose.unit,
      glm::length(pose.origin), type == Imf::HALF ? "half" : "float", options.model.method);
  for (const std::string& setting : options.model.set) text += " " + setting;
  const ModelOptions& m = options.model;
  text +=
      fmt::format(", radius {}, thickness {}, bounces {}, filter {}, light {}",
                  m.radius ? fmt::format("{:.3g}", *m.radius) : "auto",
                  m.thickness ? fmt::format("{:.3g}", *m.thickness) : "auto", m.bounces, m.filter,
                  map.empty() ? options.light.env : window({0, 0, map.width, map.height}));
  if (m.slices) text += fmt::format(", {} slices", *m.slices);
  if (m.steps) text += fmt::format(", {} steps", *m.steps);
  if (!m.extend_offscreen) text += ", open";
  if (further) text += ", another view";
  if (!broken.empty()) text += fmt::format(", {} broken values", broken.size());
  if (options.output.downsample > 1) text += ", downsample 2";
  if (options.output.crop) text += ", crop";
  return text;
}

RandomShot random_shot(std::uint64_t seed, int finer) {
  RandomNumbers random(seed);
  RandomShot shot;
  shot.seed = seed;
  shot.lens = random_lens(random);
  const Surface world = random_world(random, shot.lens);
  shot.lens = test::finer(shot.lens, finer);
  shot.seen = look(world, shot.lens);
  draw_further(random, world, shot);
  wear(random, shot.lens, shot.seen);
  draw_pose(random, shot);
  draw_storage(random, shot);
  draw_colors(random, shot);
  draw_broken(random, shot);
  draw_light(random, shot);
  draw_model(random, shot);
  return shot;
}

RandomShot cropped(RandomShot shot, const Window& data) {
  const Window from = shot.lens.data;
  shot.seen = part_of_plane(shot.seen, from, data);
  for (auto& [name, plane] : shot.colors) plane = part_of_plane(plane, from, data);
  shot.lens.data = data;
  return shot;
}

}  // namespace ssdo::test
