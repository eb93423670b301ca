// SPDX-License-Identifier: Apache-2.0
#include "scene/light/environment_map.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "error.h"
#include "io/images/image_file.h"
#include "io/pictures/cube_map.h"
#include "io/pictures/picture_layers.h"
#include "io/size_guard.h"
#include "math/light_range.h"
#include "nearest_name.h"
#include "parallel/tiles.h"
#include "scene/layers/names.h"
#include "scene/light/map_reduction.h"

namespace ssdo {
namespace {

/// The layer restricted to the `wanted` components, given in lower case; nothing if it lacks one.
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

/// Rows that are read at a time: whole chunks of every compression.
constexpr int kRows = 256;

/// The curve to undo, with a note in `map`; null if colours are linear or are taken as they are.
std::optional<TransferCurve> choose_curve(const std::string& file,
                                          const std::optional<TransferCurve>& curve, bool integers,
                                          EnvironmentMap& map) {
  if (!curve) return std::nullopt;
  if (curve->kind == TransferCurve::Kind::unknown) {
    map.warnings.push_back(fmt::format(
        "{}: says that its colours are {}, whose curve is not known; they are taken as linear "
        "light: convert the map to a linear space",
        file, curve->space));
    return std::nullopt;
  }
  map.converted.push_back("decoded from " + curve->space);
  if (integers) {
    map.warnings.push_back(
        fmt::format("{}: stores integers, encoded as {}; decoded, they are light of at most 1: use "
                    "an EXR or Radiance HDR, which have the brightness of suns and lamps",
                    file, curve->space));
  }
  return curve;
}

/// Takes the rows of a file from top to bottom: makes colours linear, replaces values that are no
/// light by black, and reduces the rows to a map.
class Intake {
 public:
  /// Rows of `window` that never come are black. Errors: those of check_picture_size().
  Intake(const std::string& file, const Window& window, std::optional<TransferCurve> curve,
         int most_columns = MapReduction::kColumns)
      : file_(file),
        area_(checked_area(file, window, most_columns)),
        reduction_(window.width(), window.height(), most_columns),
        curve_(std::move(curve)) {}

  void add(int first, Plane<glm::vec3> rows) {
    for_each_row(curve_ ? rows.height : 0, [&](int row) {
      for (int x = 0; x < rows.width; ++x)
        for (int c = 0; c < 3; ++c) rows(x, row)[c] = curve_->to_linear(rows(x, row)[c]);
    });
    clear_broken(rows);
    reduction_.add(first, rows);
  }

  void finish(EnvironmentMap& map) {
    map.texels = reduction_.take();
    const auto warn = [&](std::size_t count, std::string_view what) {
      if (count == 0) return;
      map.warnings.push_back(fmt::format("{}: {} of {} texels {}", file_, count, area_, what));
    };
    warn(broken_, fmt::format("are not finite or above {:g}, and are taken as black", kBrightest));
    warn(negative_, "have negative channels, which are taken as 0");
  }

 private:
  /// The number of texels of the window, checked before memory is taken for them.
  static std::size_t checked_area(const std::string& file, const Window& window, int most_columns) {
    constexpr double kTexel = sizeof(glm::vec3), kStored = 3 * sizeof(float);
    const double strip = double(window.width()) * std::min(kRows, window.height());
    const glm::ivec2 out = MapReduction::size(window.width(), window.height(), most_columns);
    check_picture_size(file, double(window.area()) * kTexel,
                       double(out.x) * double(out.y) * kTexel + strip * (kTexel + kStored));
    return window.area();
  }

  void clear_broken(Plane<glm::vec3>& texels) {
    for (glm::vec3& texel : texels.pixels) {
      const glm::vec3 clamped = within_range(texel);
      if (texel != clamped) {
        texel = glm::vec3(0);
        ++broken_;
      } else if (std::min({texel.x, texel.y, texel.z}) < 0) {
        texel = glm::max(texel, glm::vec3(0));
        ++negative_;
      }
    }
  }

  const std::string& file_;
  std::size_t area_, broken_ = 0, negative_ = 0;  ///< in texels of the file
  MapReduction reduction_;
  std::optional<TransferCurve> curve_;
};

/// Rows of a layer that it has, over the columns of `rows`; black where it lacks these.
Plane<glm::vec3> read_rows(const LayeredPicture& picture, const PictureLayer& layer,
                           const Window& rows) {
  const Window data = picture.window(layer);
  const std::vector<Plane<float>> planes = picture.read(layer, {.y0 = rows.y0, .y1 = rows.y1});
  const std::array<const Plane<float>*, 3> rgb = {&planes.front(), &planes[planes.size() / 2],
                                                  &planes.back()};
  Plane<glm::vec3> out(rows.width(), rows.height());
  for (int y = 0; y < out.height; ++y) {
    for (int x = std::max(rows.x0, data.x0); x < std::min(rows.x1, data.x1); ++x) {
      const std::size_t from = rgb[0]->index(x - data.x0, y);
      for (int c = 0; c < 3; ++c) out(x - rows.x0, y)[c] = (*rgb[c])[from];
    }
  }
  return out;
}

/// Reads the layer over a window into a map of about `most_columns` at most.
void read_texels(const LayeredPicture& picture, const PictureLayer& layer, const Window& window,
                 int most_columns, EnvironmentMap& map) {
  const Window data = picture.window(layer);
  const bool alpha = layer.channels == std::vector<std::string>{"A"};
  Intake intake(picture.file(), window,
                choose_curve(picture.file(), alpha ? std::nullopt : picture.curve(layer),
                             picture.integers(), map),
                most_columns);
  for (int y = data.y0; y < data.y1; y += kRows) {
    const int last = std::min(y + kRows, data.y1);
    const int first = std::max(y, window.y0), end = std::min(last, window.y1);
    if (first < end)
      intake.add(first - window.y0, read_rows(picture, layer, {window.x0, first, window.x1, end}));
    else
      read_rows(picture, layer, {window.x0, y, window.x1, last});  // they may be damaged
  }
  intake.finish(map);
}

/// Reads the colours of a picture that is no EXR. Returns its window.
Window read_picture(const std::string& file, EnvironmentMap& map) {
  std::optional<Intake> intake;
  Window window;
  read_image_rows(file, [&](const Image& image, int first, const Plane<glm::vec3>& rows) {
    if (!intake) {
      window = {0, 0, image.color.width, image.color.height};
      intake.emplace(file, window, choose_curve(file, curve_of(image), image.integers, map));
    }
    intake->add(first, rows);
  });
  intake->finish(map);
  return window;
}

/// A ratio of width to height, and what a picture of this shape mostly is.
struct Shape {
  int width, height;
  std::string_view what;
};
constexpr Shape kFaces[] = {{1, 6, "six faces of a cube in a column"},
                            {6, 1, "six faces of a cube in a row"},
                            {3, 4, "six faces of a cube in a cross"},
                            {4, 3, "six faces of a cube in a cross"}};

/// Refuses the shapes of cube maps, and warns of other shapes that are not 2 to 1. A map of a
/// single colour may have any shape. Notes how much smaller the map has become. Errors:
/// ExitCode::input.
void check_shape(const std::string& file, const Window& window, EnvironmentMap& map) {
  const Plane<glm::vec3>& texels = map.texels;
  const int width = window.width(), height = window.height();
  if (texels.width < width)
    map.converted.push_back(fmt::format("averaged from {} x {}", width, height));
  const auto is_near = [&](double w, double h) {
    constexpr double kTolerance = 0.1;  // panoramas are cropped and padded
    const double wanted = height * w / h;
    return std::abs(width - wanted) <= std::max(2.0, kTolerance * wanted);
  };
  if (is_near(2, 1) || std::ranges::count(texels.pixels, texels[0]) == std::ssize(texels.pixels))
    return;
  for (const Shape& shape : kFaces) {
    if (std::int64_t(width) * shape.height != std::int64_t(height) * shape.width) continue;
    throw Error(ExitCode::input,
                fmt::format("{}: has {} x {} texels, the shape of {}, and light is read from a "
                            "lat-long map of 2 to 1: convert it; faces in OpenEXR's order, in a "
                            "column, are read where the header has envmap = cube",
                            file, width, height, shape.what));
  }
  map.warnings.push_back(fmt::format(
      "{}: has {} x {} texels, and a lat-long map of all directions is 2 to 1; {}", file, width,
      height,
      is_near(1, 1) ? "is it a light probe (a mirror ball or an angular map)? It is read as a "
                      "lat-long map: convert it to one"
                    : "it is stretched over all directions: if it shows a part of them, give it a "
                      "display window of 2 to 1"));
}

/// Makes a lat-long map of a cube map. Errors: ExitCode::input where it has not six faces.
void unfold(const std::string& file, EnvironmentMap& map) {
  const int width = map.texels.width, height = map.texels.height;
  if (height != 6 * width) {
    throw Error(ExitCode::input,
                fmt::format("{}: its header says envmap = cube, which has six square faces in a "
                            "column, and it has {} x {} texels; correct the attribute or the map",
                            file, width, height));
  }
  map.texels = lat_long_of_cube(map.texels);
  map.converted.push_back(fmt::format("from a cube map of {} x {}", width, height));
}

}  // namespace

EnvironmentMap read_environment_map(const std::string& text) {
  const PictureName name = parse_picture_name(text);
  EnvironmentMap map;
  if (name.layer.empty() && !reads_as_exr(name.file)) {
    check_shape(name.file, read_picture(name.file, map), map);
    return map;
  }
  const LayeredPicture picture(name.file);
  const PictureLayer layer =
      name.layer.empty() ? choose_layer(picture) : find_layer(picture, name.layer);
  bool cube = false;
  if (const auto& exr = picture.exr()) {
    if (name.layer.empty()) refuse_luminance_chroma(*exr, layer);
    const Imf::Header& header = exr->parts()[std::size_t(layer.part)].header;
    map.primaries = chromaticities_of(header);
    map.layer = layer.name.empty() ? layer.part_name : layer.name;
    cube = is_cube_map(header);
  }
  const Window window = cube ? picture.window(layer) : picture.display(layer);
  read_texels(picture, layer, window, cube ? window.width() : MapReduction::kColumns, map);
  if (cube)
    unfold(name.file, map);
  else
    check_shape(name.file, window, map);
  return map;
}

}  // namespace ssdo
