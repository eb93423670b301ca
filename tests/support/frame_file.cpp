// SPDX-License-Identifier: Apache-2.0
#include "support/frame_file.h"

namespace ssdo::test {

void FramePart::add(const std::string& layer, const Plane<glm::vec3>& values,
                    const std::string& components) {
  for (int c = 0; c < 3; ++c) {
    Plane<float> plane(values.width, values.height);
    for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = values[i][c];
    channels[layer + "." + components[std::size_t(c)]] = plane;
  }
}

FramePart frame_of(const Picture& picture, const std::string& prefix) {
  FramePart part{"", picture.window, picture.window, {}, Imf::FLOAT, {}};
  part.add(prefix + "Position", picture.position);
  part.add(prefix + "Normal", picture.normal);
  part.add(prefix + "DiffCol",
           Plane<glm::vec3>(picture.position.width, picture.position.height, glm::vec3(0.5f)),
           "RGB");
  Plane<float> depth(picture.position.width, picture.position.height, 1e10f);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (picture.valid[i])
      depth[i] = float(-picture.camera.to_camera(glm::dvec3(picture.position[i])).z);
  }
  part.channels[prefix + "Depth.Z"] = depth;
  return part;
}

void write_frame(const std::filesystem::path& path, const std::vector<FramePart>& parts) {
  std::vector<Imf::Header> headers;
  for (const FramePart& part : parts) {
    Imf::Header header = part.extra;
    header.displayWindow() = box_of(part.display);
    header.dataWindow() = box_of(part.data);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.setType(part.tile_size > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
    if (part.tile_size > 0)
      header.setTileDescription(
          Imf::TileDescription(unsigned(part.tile_size), unsigned(part.tile_size), Imf::ONE_LEVEL));
    if (!part.name.empty()) header.setName(part.name);
    for (const auto& [name, plane] : part.channels)
      header.channels().insert(name, Imf::Channel(part.type));
    headers.push_back(header);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    Imf::FrameBuffer buffer;
    std::vector<std::vector<half>> halves;
    halves.reserve(parts[p].channels.size());
    for (const auto& [name, plane] : parts[p].channels) {
      const void* base = plane.pixels.data();
      if (parts[p].type == Imf::HALF) {
        halves.emplace_back(plane.pixels.begin(), plane.pixels.end());
        base = halves.back().data();
      }
      buffer.insert(name, Imf::Slice::Make(parts[p].type, base, box_of(parts[p].data)));
    }
    if (parts[p].tile_size > 0) {
      Imf::TiledOutputPart part(file, int(p));
      part.setFrameBuffer(buffer);
      part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
      continue;
    }
    Imf::OutputPart part(file, int(p));
    part.setFrameBuffer(buffer);
    part.writePixels(parts[p].data.height());
  }
}

void write_frame(const std::filesystem::path& path, const FramePart& part) {
  write_frame(path, std::vector<FramePart>{part});
}

Picture small_picture(const Window& window, const Window& display) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)});
  const Camera camera =
      look_at(camera_from_fov(40, display, 1), {0, -4, 3}, {0, 0, 0.3}, {0, 0, 1});
  return take_picture(scene, camera, window);
}

Plane<float> channel(const std::filesystem::path& path, const std::string& name, int part) {
  return ExrReader(path).read(part, std::vector{name})[0];
}

std::vector<std::string> channel_names(const std::filesystem::path& path, int part) {
  const ExrReader file(path);
  std::vector<std::string> names;
  for (const ExrChannel& c : file.parts()[std::size_t(part)].channels) names.push_back(c.name);
  return names;
}

}  // namespace ssdo::test
