// SPDX-License-Identifier: Apache-2.0
#include "support/stored_shot.h"

#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>

#include <algorithm>

#include "io/exr/file/exr_parts.h"
#include "support/boxes.h"
#include "support/typed_frame.h"

namespace ssdo::test {
namespace {

constexpr Window kWindow{0, 0, 96, 72};

/// Around the surfaces, with a rim of a pixel.
constexpr Window kCrop{4, 10, 92, 70};

const Picture& picture() {
  static const Picture taken = [] {
    const auto on_disc = [](const glm::dvec3& p) { return glm::length(p) < 1.5; };
    const Surface scene = all_of({cut(plane({}, {0, 0, 1}), on_disc), sphere({0.4, 0.2, 0.5}, 0.5),
                                  Box{{-0.9, -0.4, 0}, {-0.3, 0.2, 0.6}}.surface()});
    const Camera camera =
        look_at(camera_from_fov(kShotFov, kWindow, 1), {0.5, -4, 3}, {0, 0, 0.2}, {0, 0, 1});
    return take_picture(scene, camera, kWindow);
  }();
  return taken;
}

ShotPixel pixel_at(std::size_t i) {
  const Picture& shot = picture();
  ShotPixel pixel;
  pixel.surface = shot.valid[i] != 0;
  if (!pixel.surface) return pixel;
  pixel.position = shot.position[i], pixel.normal = shot.normal[i];
  pixel.position_in_camera = glm::vec3(shot.camera.to_camera(glm::dvec3(pixel.position)));
  pixel.normal_in_camera = glm::vec3(shot.camera.rotation * glm::dvec3(pixel.normal));
  return pixel;
}

Content depth(const std::function<float(const ShotPixel&)>& of_surface, float empty) {
  return [=](const ShotPixel& p) { return glm::vec4(p.surface ? of_surface(p) : empty); };
}

TypedChannel channel_of(const StoredLayer& layer, int component, const Window& window) {
  std::vector<float> values;
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x)
      values.push_back(layer.content(pixel_at(picture().position.index(x, y)))[component]);
  }
  if (layer.type == Imf::FLOAT) return typed(Imf::FLOAT, values);
  return typed(Imf::HALF, std::vector<half>(values.begin(), values.end()));
}

}  // namespace

Content world_position(const glm::mat3& world, float empty) {
  return [=](const ShotPixel& p) {
    return p.surface ? glm::vec4(world * p.position, 1) : glm::vec4(glm::vec3(empty), 0);
  };
}

Content camera_position(const glm::vec3& signs, float empty) {
  return [=](const ShotPixel& p) {
    return p.surface ? glm::vec4(signs * p.position_in_camera, 1) : glm::vec4(glm::vec3(empty), 0);
  };
}

Content world_normal(const glm::mat3& world) {
  return [=](const ShotPixel& p) {
    const glm::vec3 n = world * p.normal;
    return glm::vec4(p.surface ? glm::normalize(n) : n, p.surface);
  };
}

Content camera_normal(const glm::vec3& signs) {
  return [=](const ShotPixel& p) { return glm::vec4(signs * p.normal_in_camera, p.surface); };
}

Content as_color(const Content& normal) {
  return [=](const ShotPixel& p) { return 0.5f * normal(p) + 0.5f; };
}

Content planar_depth(float empty, float unit) {
  return depth([=](const ShotPixel& p) { return -p.position_in_camera.z * unit; }, empty);
}

Content ray_depth(float empty, float unit) {
  return depth([=](const ShotPixel& p) { return glm::length(p.position_in_camera) * unit; }, empty);
}

Content remapped_depth(float zero, float one) {
  const auto map = [=](const ShotPixel& p) {
    return (-p.position_in_camera.z - zero) / (one - zero);
  };
  return depth(map, zero < one ? 1 : 0);
}

Content inverse_depth() {
  return depth([](const ShotPixel& p) { return -1 / p.position_in_camera.z; }, 0);
}

Content grey() {
  return
      [](const ShotPixel& p) { return p.surface ? glm::vec4(0.5f, 0.5f, 0.5f, 1) : glm::vec4(0); };
}

std::vector<std::string> channels(const std::string& layer, const std::string& components) {
  std::vector<std::string> names;
  for (const char c : components) names.push_back(layer + "." + c);
  return names;
}

void write_shot(const std::filesystem::path& path, const StoredShot& shot) {
  const Window data = shot.cropped ? kCrop : kWindow;
  std::vector<TypedFrame> parts;
  std::vector<std::string> names;
  for (const StoredLayer& layer : shot.layers) {
    const auto known = std::find(names.begin(), names.end(), layer.part);
    const auto index = std::size_t(known - names.begin());
    if (known == names.end()) {
      names.push_back(layer.part);
      parts.push_back(typed_frame({layer.part, data, kWindow, {}, Imf::FLOAT, {}}));
      for (const auto& [key, text] : shot.attributes)
        parts.back().header.insert(key, Imf::StringAttribute(text));
      if (shot.tiled) {
        parts.back().header.setType(Imf::TILEDIMAGE);
        parts.back().header.setTileDescription(Imf::TileDescription(32, 32));
      }
    }
    for (std::size_t c = 0; c < layer.channels.size(); ++c)
      parts[index].channels[layer.channels[c]] = channel_of(layer, int(c), data);
  }
  if (!shot.apart) {
    write_typed(path, parts);
    return;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    take_out(parts[i].header, "name");
    write_typed(i == 0 ? path : path.parent_path() / (names[i] + ".exr"), {parts[i]});
  }
}

StoredShot plain_shot() {
  return {{{Role::position, channels("P", "XYZ"), world_position()},
           {Role::normal, channels("N", "XYZ"), world_normal()},
           {Role::albedo, channels("albedo", "RGB"), grey()},
           {Role::depth, {"Z"}, planar_depth(1e10f)}}};
}

}  // namespace ssdo::test
