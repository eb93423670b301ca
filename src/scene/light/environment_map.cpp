// SPDX-License-Identifier: Apache-2.0
#include "scene/light/environment_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "error.h"
#include "io/picture_layers.h"
#include "io/size_guard.h"
#include "math/light_range.h"
#include "nearest_name.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

/// The layer with these of its channels only, by their components in lower case; nothing where it
/// lacks one.
std::optional<PictureLayer> restrict_to(const PictureLayer& layer, const Components& wanted) {
  PictureLayer out = layer;
  out.channels.clear(), out.components.clear();
  for (const std::string& component : wanted) {
    const auto found =
        std::find_if(layer.components.begin(), layer.components.end(),
                     [&](const std::string& own) { return lower(own) == component; });
    if (found == layer.components.end()) return std::nullopt;
    out.channels.push_back(layer.channels[std::size_t(found - layer.components.begin())]);
    out.components.push_back(*found);
  }
  return out;
}

/// Red, green and blue of a layer, or its one channel of grey. A Y beside an X is a coordinate.
std::optional<PictureLayer> as_light(const PictureLayer& layer) {
  for (const Components& colors : row_of(Role::beauty).components) {
    if (auto found = restrict_to(layer, colors)) return found;
  }
  for (const char* other : {"x", "u", "g"}) {
    if (restrict_to(layer, {other})) return std::nullopt;
  }
  for (const char* grey : {"y", "v", "r"}) {
    if (auto found = restrict_to(layer, {grey})) return found;
  }
  return std::nullopt;
}

/// The names under which a beauty is looked for.
std::vector<std::string> keys_of(const PictureLayer& layer, bool only_part) {
  const std::string path = normalise(layer.name.empty() ? layer.part_name : layer.name);
  std::vector<std::string> keys = {path, path.substr(path.rfind('.') + 1)};
  if (layer.name.empty() && only_part) keys.emplace_back();
  return keys;
}

/// How well a layer of light suits; smaller is better: known names, then colours before grey.
std::size_t rank_of(const PictureLayer& layer, bool only_part) {
  constexpr std::size_t kUnknown = 1000;
  const std::size_t name = rank_of(Role::beauty, keys_of(layer, only_part)).value_or(kUnknown);
  return 2 * name + (layer.channels.size() == 1);
}

PictureLayer choose_layer(const LayeredPicture& picture) {
  const bool only_part = !picture.exr() || picture.exr()->parts().size() == 1;
  std::vector<PictureLayer> best;
  for (const PictureLayer& layer : picture.layers()) {
    const auto light = as_light(layer);
    if (!light) continue;
    const std::size_t rank = rank_of(*light, only_part);
    if (!best.empty() && rank > rank_of(best[0], only_part)) continue;
    if (!best.empty() && rank < rank_of(best[0], only_part)) best.clear();
    best.push_back(*light);
  }
  if (best.size() == 1) return best[0];
  if (best.empty()) {
    throw Error(ExitCode::layer,
                fmt::format("{}: has no layer with R, G and B, nor one of grey (Y), to take for "
                            "the environment; it has {}: name one with --env FILE:LAYER",
                            picture.file(), picture.names()));
  }
  std::vector<std::string> names;
  for (const PictureLayer& layer : best) names.push_back("'" + shown_name(layer) + "'");
  throw Error(ExitCode::layer,
              fmt::format("{}: {} layers could be the environment: {}; name one with --env "
                          "FILE:LAYER",
                          picture.file(), best.size(), some_of(names)));
}

PictureLayer find_layer(const LayeredPicture& picture, const std::string& name) {
  const PictureLayer layer = picture.find(name);
  if (layer.channels.size() == 1) return layer;
  if (const auto light = as_light(layer)) return *light;
  throw Error(ExitCode::layer,
              fmt::format("{}: layer '{}' has the channels {}; an environment takes R, G and B, or "
                          "one channel",
                          picture.file(), name, fmt::join(layer.channels, ", ")));
}

/// Luminance alone would light a coloured scene with grey.
void refuse_luminance_chroma(const ExrReader& exr, const PictureLayer& layer) {
  if (layer.channels != std::vector<std::string>{"Y"}) return;
  for (const ExrChannel& c : exr.parts()[std::size_t(layer.part)].channels) {
    if (c.name != "RY") continue;
    throw Error(ExitCode::layer,
                fmt::format("{}: stores luminance and chroma (Y, RY, BY); convert it to R, G, B",
                            exr.path().string()));
  }
}

Plane<glm::vec3> lay_out(const LayeredPicture& picture, const PictureLayer& layer) {
  const Window data = picture.window(layer), display = picture.display(layer);
  const double bytes = double(display.area()) * sizeof(glm::vec3),
               as_stored = double(data.area()) * sizeof(float) * double(layer.channels.size());
  check_picture_size(picture.file(), bytes, bytes + as_stored);
  const std::vector<Plane<float>> planes = picture.read(layer);
  const std::array<const Plane<float>*, 3> rgb = {&planes.front(), &planes[planes.size() / 2],
                                                  &planes.back()};
  Plane<glm::vec3> out(display.width(), display.height());
  for (int y = std::max(display.y0, data.y0); y < std::min(display.y1, data.y1); ++y) {
    for (int x = std::max(display.x0, data.x0); x < std::min(display.x1, data.x1); ++x) {
      const std::size_t from = rgb[0]->index(x - data.x0, y - data.y0);
      for (int c = 0; c < 3; ++c) out(x - display.x0, y - display.y0)[c] = (*rgb[c])[from];
    }
  }
  return out;
}

/// Makes texels black that are no light; says how many there were.
void clear_broken(EnvironmentMap& map, const std::string& file) {
  std::size_t broken = 0, negative = 0;
  for (glm::vec3& texel : map.texels.pixels) {
    const glm::vec3 held = within_range(texel);
    if (texel != held) {
      texel = glm::vec3(0);
      ++broken;
    } else if (std::min({texel.x, texel.y, texel.z}) < 0) {
      texel = glm::max(texel, glm::vec3(0));
      ++negative;
    }
  }
  const auto warn = [&](std::size_t count, std::string_view what) {
    if (count == 0) return;
    map.warnings.push_back(
        fmt::format("{}: {} of {} texels {}", file, count, map.texels.size(), what));
  };
  warn(broken, fmt::format("are not finite or above {:g}, and are taken as black", kBrightest));
  warn(negative, "have negative channels, which are taken as 0");
}

}  // namespace

EnvironmentMap read_environment_map(const std::string& text) {
  const PictureName name = parse_picture_name(text);
  const LayeredPicture picture(name.file);
  const PictureLayer layer =
      name.layer.empty() ? choose_layer(picture) : find_layer(picture, name.layer);
  EnvironmentMap map;
  if (const auto& exr = picture.exr()) {
    if (name.layer.empty()) refuse_luminance_chroma(*exr, layer);
    map.primaries = chromaticities_of(exr->parts()[std::size_t(layer.part)].header);
    map.layer = layer.name.empty() ? layer.part_name : layer.name;
  }
  map.texels = lay_out(picture, layer);
  clear_broken(map, name.file);
  if (picture.integers()) {
    map.warnings.push_back(
        fmt::format("{}: stores integers, which are mostly encoded for a display; they are taken "
                    "as linear light of at most 1: convert the map to EXR or Radiance HDR",
                    name.file));
  }
  return map;
}

}  // namespace ssdo
