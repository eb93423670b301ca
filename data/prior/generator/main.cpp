// SPDX-License-Identifier: Apache-2.0
//
// generate [--turn DEGREES] FOLDER FIRST COUNT [FAMILY...]: frames FIRST.. of random scenes. The
// family of a frame is that of family_of(), or taken in turn from those that are named. Frames that
// exist are kept. With --turn the camera is turned about what it looks at, and the truth is that of
// the points that the frame shows without.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include "files.h"

namespace {
constexpr float kPixels = 256 * 144;

std::string path_of(const std::string& folder, const char* kind, int id, const char* ending) {
  char name[48];
  std::snprintf(name, sizeof name, "/%s_%05d.%s", kind, id, ending);
  return folder + name;
}

struct Size {
  int width, height;
};
Size frame_size(Random& r) {
  const float wide = 16.f / 9;
  const float aspects[] = {wide, wide, wide, wide, 1.85f, 2.39f, 1.5f, 4.f / 3, 1, 9.f / 16};
  const float a = aspects[r.count(0, 9)];
  return {2 * int(std::sqrt(kPixels * a) / 2 + .5f), 2 * int(std::sqrt(kPixels / a) / 2 + .5f)};
}

// The share of neighbours, eight pixels apart, between which the surface bends or breaks.
float share_of_edges(const Frame& f) {
  constexpr int kStep = 8;
  int pairs = 0, edges = 0;
  const auto compare = [&](size_t i, size_t k) {
    ++pairs;
    if (!f.valid[i] || !f.valid[k]) {
      edges += f.valid[i] != f.valid[k];
      return;
    }
    const Vec apart = f.position[k] - f.position[i];
    const float off = std::fabs(dot(f.facet[i], apart)) + std::fabs(dot(f.facet[k], apart));
    edges += off > .04f * f.depth[i] || dot(f.facet[i], f.facet[k]) < .9f;
  };
  for (int y = 0; y + kStep < f.height; y += kStep)
    for (int x = 0; x + kStep < f.width; x += kStep) {
      const size_t i = size_t(y) * size_t(f.width) + size_t(x);
      compare(i, i + kStep);
      compare(i, i + kStep * size_t(f.width));
    }
  return float(edges) / float(std::max(pairs, 1));
}

// A frame that teaches something: enough is seen, not through what touches the lens, and more than
// an empty wall or floor.
bool is_useful(const Frame& f, bool has_foreground, Random& r) {
  std::vector<float> depths;
  for (size_t i = 0; i < f.valid.size(); ++i)
    if (f.valid[i]) depths.push_back(f.depth[i]);
  const size_t n = depths.size();
  if (n < f.valid.size() / 8) return false;
  std::sort(depths.begin(), depths.end());
  const float near = depths[n / 50], middle = depths[n / 2];
  if (depths[0] < .02f || near < .015f * middle) return false;
  if (!has_foreground && near < .08f * middle && !r.chance(.2f)) return false;
  const float edges = share_of_edges(f);
  return edges > .12f || r.chance(edges > .06f ? .3f : .04f);
}

// Few frames are nearly dark under a white world: some light gets into what is rendered.
bool is_lit(const std::vector<Truth>& rows, Random& r) {
  double sum = 0;
  for (const Truth& t : rows) sum += t.moments[0];
  return sum > .05 * double(rows.size()) || r.chance(.05f);
}

Vec sun_direction(Random& r) {
  const float e = r(15, 70) * kPi / 180, a = r.angle();
  return {std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e)};
}

// The camera turned about the vertical through the middle of what `frame` shows.
Camera turned(const Camera& camera, const Frame& frame, float degrees) {
  const Vec middle = camera.eye + frame.forward * frame.mean_depth;
  const Rot turn = about_z(degrees * kPi / 180);
  Camera out = camera;
  out.eye = middle + turn * (camera.eye - middle);
  out.target = out.eye + turn * (camera.target - camera.eye);
  return out;
}

// The pixel of `f` that shows the point of pixel i of `before`; -1 if none does.
int find_point(const Frame& f, const Frame& before, size_t i) {
  const Vec p = before.position[i], way = p - f.eye;
  const float depth = f.ortho ? 1 : dot(way, f.forward);
  if (!(depth > 0)) return -1;
  const float across = dot(way, f.right) / (depth * f.half_width);
  const float up = dot(way, f.up) / (depth * f.half_height);
  const int x = int(std::floor((1 + across) / 2 * float(f.width)));
  const int y = int(std::floor((1 - up) / 2 * float(f.height)));
  if (x < 0 || y < 0 || x >= f.width || y >= f.height) return -1;
  const size_t k = size_t(y) * size_t(f.width) + size_t(x);
  if (!f.valid[k] || dot(f.facet[k], before.facet[i]) < .95f) return -1;
  const float pixel = 2 * f.half_width / float(f.width) * depth;
  const Vec apart = f.position[k] - p;
  const bool is_same =
      length(apart) < 3 * pixel && std::fabs(dot(apart, before.facet[i])) < .3f * pixel;
  return is_same ? int(k) : -1;
}

// Of `rows`, those of points that `f` shows too, at its pixels.
std::vector<Truth> shared_truth(const Frame& f, const Frame& before,
                                const std::vector<Truth>& rows) {
  std::vector<Truth> out;
  for (Truth t : rows) {
    const int pixel = find_point(f, before, size_t(t.pixel));
    if (pixel < 0) continue;
    t.before = t.pixel;
    t.pixel = float(pixel);
    out.push_back(t);
  }
  return out;
}

bool make_frame(RTCDevice device, const std::string& folder, int id, int family, int attempt,
                float degrees) {
  Random r(unsigned(id) * 7919u + unsigned(attempt) * 104729u + 17u);
  const Family& kind = families()[size_t(family)];
  Scene s;
  kind.make(r, s);
  if (kind.outdoor) surround(r, s, id);
  const bool close = has_foreground(r, id);
  if (close) foreground(r, s);
  const RayCaster rays(device, s.mesh);
  const Size size = frame_size(r);
  const float roll = r.chance(.12f) ? r(-.15f, .15f) : 0;
  Frame frame = render(rays, s.camera, size.width, size.height, roll);
  if (!is_useful(frame, close, r)) return false;
  // The radius is a share of the frame's size at its mean depth; the file's unit is the radius.
  const float extent =
      2 * std::sqrt(frame.half_width * frame.half_height) * (frame.ortho ? 1 : frame.mean_depth);
  const TruthPlan plan{extent * r.log(.03f, 1.5f), sun_direction(r), 3, 10};
  std::vector<Truth> rows = trace_truth(rays, frame, plan, r);
  if (!is_lit(rows, r)) return false;
  if (degrees != 0) {
    Frame next = render(rays, turned(s.camera, frame, degrees), size.width, size.height, roll);
    rows = shared_truth(next, frame, rows);
    frame = std::move(next);
  }
  FrameHeader h{};
  h.family = float(family);
  h.up_axis = r.chance(.5f) ? 1 : 2;
  h.ortho = frame.ortho ? 1 : 0;
  h.half_width = frame.half_width;
  h.half_height = frame.half_height;
  h.scale = 1 / plan.radius;
  const Vec sun = file_axes(plan.sun, h);
  h.sun[0] = sun.x;
  h.sun[1] = sun.y;
  h.sun[2] = sun.z;
  h.id = float(id);
  h.attempt = float(attempt);
  h.pixels = float(rows.size());
  write_frame(path_of(folder, "frame", id, "exr"), frame, h);
  write_truth(path_of(folder, "truth", id, "bin"), rows, h);
  return true;
}
}  // namespace

int main(int argc, char** argv) try {
  float degrees = 0;
  if (argc > 2 && std::string(argv[1]) == "--turn") {
    degrees = float(std::atof(argv[2]));
    argc -= 2;
    argv += 2;
  }
  if (argc < 4) {
    std::printf("usage: generate [--turn DEGREES] FOLDER FIRST COUNT [FAMILY...]\n");
    for (size_t i = 0; i < families().size(); ++i)
      std::printf("%zu %s%s\n", i, families()[i].name, families()[i].validation ? " *" : "");
    return 2;
  }
  const std::string folder = argv[1];
  const int first = std::atoi(argv[2]), count = std::atoi(argv[3]);
  const RTCDevice device = rtcNewDevice("threads=1");
  for (int id = first; id < first + count; ++id) {
    const int kinds = int(families().size());
    const int family = argc > 4 ? std::atoi(argv[4 + id % (argc - 4)]) : family_of(id);
    if (family < 0 || family >= kinds)
      throw std::runtime_error("family: 0 to " + std::to_string(kinds - 1));
    if (std::filesystem::exists(path_of(folder, "truth", id, "bin"))) continue;
    bool made = false;
    for (int attempt = 0; attempt < 60 && !made; ++attempt)
      made = make_frame(device, folder, id, family, attempt, degrees);
    if (!made) std::printf("%d %s: no frame\n", id, families()[size_t(family)].name);
  }
  rtcReleaseDevice(device);
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "generate: %s\n", e.what());
  return 1;
}
