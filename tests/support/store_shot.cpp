// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <fstream>
#include <glm/matrix.hpp>
#include <iterator>

#include "relight/relight.h"
#include "support/frame_file.h"
#include "support/random_shot.h"
#include "support/temp_dir.h"

namespace ssdo::test {
namespace {

glm::dvec3 in_world(const Pose& pose, const glm::dvec3& p) {
  return pose.origin + pose.unit * (pose.to_world * p);
}

/// The planes of a vector, by letter.
void add_vectors(FramePart& part, const std::string& layer, const Plane<glm::dvec3>& vectors) {
  for (int c = 0; c < 3; ++c) {
    Plane<float>& plane = part.channels[layer + "." + "XYZ"[c]];
    plane = Plane<float>(vectors.width, vectors.height);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = float(vectors[i][c]);
  }
}

void add_positions(FramePart& part, const Plane<SeenPoint>& seen, const Pose& pose, float empty) {
  auto positions = Plane<glm::dvec3>::like(seen);
  for (std::size_t i = 0; i < seen.size(); ++i)
    positions[i] = seen[i].surface ? in_world(pose, seen[i].position) : glm::dvec3(empty);
  add_vectors(part, "P", positions);
}

void add_normals(FramePart& part, const Plane<SeenPoint>& seen, const Pose& pose,
                 StoredNormals kind) {
  if (kind == StoredNormals::none) return;
  auto normals = Plane<glm::dvec3>::like(seen);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    normals[i] = kind == StoredNormals::camera ? seen[i].normal : pose.to_world * seen[i].normal;
    if (kind == StoredNormals::colors) normals[i] = 0.5 * normals[i] + 0.5;
  }
  add_vectors(part, "N", normals);
}

void add_depth(FramePart& part, const RandomShot& shot) {
  Plane<float>& depth = part.channels["Z"];
  depth = Plane<float>(shot.seen.width, shot.seen.height);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const glm::dvec3 p = shot.pose.unit * shot.seen[i].position;
    const bool by_ray = shot.depth_kind == DepthKind::ray && !shot.lens.camera.orthographic;
    const double along = by_ray ? glm::length(p) : -p.z;
    depth[i] = float(shot.depth_kind == DepthKind::inverse ? 1 / along : along);
    if (!shot.seen[i].surface) depth[i] = shot.depth_kind == DepthKind::inverse ? 0 : shot.empty;
  }
}

void break_values(FramePart& part, const std::vector<BrokenValue>& broken) {
  for (const BrokenValue& b : broken) {
    auto channel = part.channels.begin();
    std::advance(channel, std::ptrdiff_t(b.channel % part.channels.size()));
    channel->second[b.pixel] = b.value;
  }
}

FramePart part_of(const RandomShot& shot) {
  FramePart part{"", shot.lens.data, shot.lens.display, shot.colors, shot.type, {}};
  part.extra.pixelAspectRatio() = float(shot.lens.pixel_aspect);
  if (shot.has_position) add_positions(part, shot.seen, shot.pose, shot.empty);
  if (shot.has_depth) add_depth(part, shot);
  add_normals(part, shot.seen, shot.pose, shot.normals);
  break_values(part, shot.broken);
  return part;
}

FramePart part_of(const FurtherLook& further, const Pose& pose) {
  const Window& data = further.lens.data;
  FramePart part{"", data, further.lens.display, {}, Imf::FLOAT, {}};
  part.extra.pixelAspectRatio() = float(further.lens.pixel_aspect);
  add_positions(part, further.seen, pose, 0);
  add_normals(part, further.seen, pose, StoredNormals::world);
  for (const char c : {'R', 'G', 'B'})
    part.channels[std::string("albedo.") + c] = Plane<float>(data.width(), data.height(), 0.5f);
  return part;
}

void write_camera(const std::filesystem::path& path, const RandomShot& shot) {
  const Camera& lens = shot.lens.camera;
  const glm::dmat3 rotation = glm::transpose(shot.pose.to_world);
  const glm::dvec3 moved = -(rotation * shot.pose.origin);
  const double per_unit = lens.orthographic ? shot.pose.unit : 1;
  std::string rows;
  for (int r = 0; r < 3; ++r)
    rows += fmt::format("[{:.17g},{:.17g},{:.17g},{:.17g}],", rotation[0][r], rotation[1][r],
                        rotation[2][r], moved[r]);
  const bool mirrors = glm::determinant(rotation) < 0;
  std::ofstream(path) << fmt::format(
      R"({{"type":"{}","fx":{:.17g},"fy":{:.17g},"cx":{:.17g},"cy":{:.17g},)"
      R"("world_handedness":"{}","world_to_camera":[{}[0,0,0,1]]}})",
      lens.orthographic ? "ortho" : "persp", lens.fx / per_unit, lens.fy / per_unit, lens.cx,
      lens.cy, mirrors ? "left" : "right", rows);
}

CameraOptions camera_of(const RandomShot& shot, const std::filesystem::path& folder) {
  CameraOptions options;
  const Camera& lens = shot.lens.camera;
  const int width = shot.lens.display.width();
  if (shot.camera == GivenCamera::file) {
    options.file = (folder / "camera.json").string();
    write_camera(options.file, shot);
  } else if (shot.camera == GivenCamera::lens) {
    if (lens.orthographic)
      options.ortho = width / lens.fx * shot.pose.unit;
    else
      options.fov = lens.hfov_degrees(width);
  }
  return options;
}

FramePart part_of(const Plane<glm::vec3>& map) {
  const Window window{0, 0, map.width, map.height};
  FramePart part{"", window, window, {}, Imf::FLOAT, {}};
  for (int c = 0; c < 3; ++c) {
    Plane<float>& plane = part.channels[std::string(1, "RGB"[c])];
    plane = Plane<float>(map.width, map.height);
    for (std::size_t i = 0; i < map.size(); ++i) plane[i] = map[i][c];
  }
  return part;
}

}  // namespace

StoredFrame store(const RandomShot& shot, const std::filesystem::path& folder) {
  StoredFrame stored{shot.options, {}};
  stored.files.input = (folder / "frame.exr").string();
  stored.files.aovs = shot.options.input.aovs;
  write_frame(stored.files.input, part_of(shot));
  FrameOptions& options = stored.options;
  options.camera = camera_of(shot, folder);
  ModelOptions& model = options.model;
  if (model.radius) *model.radius *= shot.pose.unit;
  if (model.thickness) *model.thickness *= shot.pose.unit;
  if (shot.further) {
    stored.files.also = {(folder / "further.exr").string()};
    write_frame(stored.files.also[0], part_of(*shot.further, shot.pose));
  }
  if (!shot.map.empty()) {
    options.light.env = (folder / "map.exr").string();
    write_frame(options.light.env, part_of(shot.map));
  }
  return stored;
}

Frame read_frame(const RandomShot& shot) {
  const TempDir dir;
  const StoredFrame stored = store(shot, dir.path());
  OtherPictures pictures;
  return prepare_frame(stored.options, Lighting(stored.options.light), pictures, stored.files);
}

}  // namespace ssdo::test
