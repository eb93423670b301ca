// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/read_gbuffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <map>

#include "error.h"
#include "io/exr/header_numbers.h"
#include "io/exr/pixel_filter.h"
#include "io/size_guard.h"
#include "math/light_range.h"
#include "parallel/tiles.h"
#include "scene/gbuffer/albedo_alpha.h"
#include "scene/gbuffer/background.h"
#include "scene/gbuffer/depth_encoding.h"
#include "scene/gbuffer/normal_encoding.h"
#include "scene/layers/groups.h"
#include "scene/layers/windows.h"

namespace ssdo {
namespace {

/// Relative rounding: float keeps 24 bits, PXR24 16 of them.
constexpr float kStepFloat = 1.0f / 16777216, kStepPxr24 = 1.0f / 65536;

/// Memory that a G-buffer and its geometry take.
constexpr double kBytesPerPixel = 100;

bool is_sane(float v) { return std::isfinite(v); }

bool is_sane(const glm::vec3& v) { return v == within_range(v); }

/// Lays planes that cover `from` onto the window `to`; pixels that they do not cover get `fill`.
Plane<float> lay_onto(const Window& to, const Window& from, const Plane<float>& plane, float fill) {
  Plane<float> out(to.width(), to.height(), fill);
  for (int y = std::max(to.y0, from.y0); y < std::min(to.y1, from.y1); ++y) {
    for (int x = std::max(to.x0, from.x0); x < std::min(to.x1, from.x1); ++x) {
      out(x - to.x0, y - to.y0) = plane(x - from.x0, y - from.y0);
    }
  }
  return out;
}

/// The channels of the layers that are used, each part read once: its channels share their chunks,
/// which would be decompressed again for every layer.
class LayerReader {
 public:
  LayerReader(const std::vector<const ExrReader*>& files, const LayerTable& table,
              const std::vector<Role>& roles, const Window& window, const PixelGrid& grid,
              const Plane<float>* deep)
      : files_(files), window_(window), grid_(grid) {
    std::map<Part, std::vector<std::string>> channels;
    for (const Role role : roles) {
      for (const Layer* layer : table.all(role)) {
        auto& names = channels[{layer->file, layer->part}];
        for (const std::string& name : layer->channels) {
          if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
        }
      }
    }
    for (const auto& [part, names] : channels) {
      if (files[std::size_t(part.first)]->parts()[std::size_t(part.second)].deep) {
        planes_[part][names[0]] = *deep;
        continue;
      }
      auto planes = files[std::size_t(part.first)]->read(part.second, names, grid);
      for (std::size_t i = 0; i < names.size(); ++i) planes_[part][names[i]] = std::move(planes[i]);
    }
  }

  Plane<float> scalar(const std::optional<Layer>& layer, float fill) const {
    Plane<float> laid;
    return layer ? plane(window_, *layer, 0, fill, laid) : laid;
  }

  Plane<glm::vec3> vector(const std::optional<Layer>& layer, float fill) const {
    return vector_over(window_, layer, fill);
  }

  Plane<glm::vec3> vector_over(const Window& window, const std::optional<Layer>& layer,
                               float fill) const {
    if (!layer) return {};
    Plane<float> laid[3];
    const Plane<float>&x = plane(window, *layer, 0, fill, laid[0]),
          &y = plane(window, *layer, 1, fill, laid[1]),
          &z = plane(window, *layer, 2, fill, laid[2]);
    auto out = Plane<glm::vec3>::like(x);
    for_each_row(out.height, [&](int row) {
      for (std::size_t i = out.index(0, row), end = out.index(0, row + 1); i < end; ++i)
        out[i] = {x[i], y[i], z[i]};
    });
    return out;
  }

  Plane<glm::vec2> motion(const std::optional<Layer>& layer) const {
    if (!layer) return {};
    Plane<float> laid[2];
    const Plane<float>&x = plane(window_, *layer, 0, NAN, laid[0]),
          &y = plane(window_, *layer, 1, NAN, laid[1]);
    auto out = Plane<glm::vec2>::like(x);
    for_each_row(out.height, [&](int row) {
      for (std::size_t i = out.index(0, row), end = out.index(0, row + 1); i < end; ++i)
        out[i] = {x[i], y[i]};
    });
    return out;
  }

 private:
  using Part = std::pair<int, int>;  ///< file and part

  /// A channel over `window`: as it was read where that is its own, else in `laid`.
  const Plane<float>& plane(const Window& window, const Layer& layer, std::size_t component,
                            float fill, Plane<float>& laid) const {
    const Window own = grid_.of(part_of(files_, layer).data_window);
    const Plane<float>& read = planes_.at({layer.file, layer.part}).at(layer.channels[component]);
    return own == window ? read : laid = lay_onto(window, own, read, fill);
  }

  const std::vector<const ExrReader*>& files_;
  Window window_;
  PixelGrid grid_;
  std::map<Part, std::map<std::string, Plane<float>>> planes_;
};

/// From this share of the surfaces on, a warning counts pixels whose values cannot be right.
constexpr double kManyPixels = 0.01;

/// "1234 pixels (44 % of the surfaces)"; nothing for few of them.
std::optional<std::string> many_pixels(const GBuffer& g, std::size_t count) {
  const double all = double(g.valid.size() - g.background_pixels);
  if (double(count) < kManyPixels * all || count == 0) return std::nullopt;
  return fmt::format("{} pixels ({:.0f} % of the surfaces)", count, 100 * double(count) / all);
}

/// Values that are not finite or out of range become 0: black, smooth, or a normal to be rebuilt.
/// The pixel counts as broken; a warning says what became of many of them.
template <class T>
void clear_broken(GBuffer& g, Plane<T>& values, std::string_view name, std::string_view fate) {
  std::atomic<std::size_t> bad = 0;
  for_each_row(values.height, [&](int y) {
    for (std::size_t i = values.index(0, y), end = values.index(0, y + 1); i < end; ++i) {
      if (is_sane(values[i])) continue;
      bad += g.valid[i];
      values[i] = T(0);
    }
  });
  if (const auto many = many_pixels(g, bad))
    g.warnings.push_back(fmt::format("{} is not finite in {}: {}", name, *many, fate));
  g.bad_pixels += bad;
}

/// Warns of surfaces that send more light than they get.
void note_bright_albedo(GBuffer& g) {
  constexpr float kRounding = 1.01f;
  std::vector<float> most_in(std::size_t(g.albedo.height), 0.0f);  // each row
  const std::size_t bright = count_over_rows(g.albedo.height, [&](int y) {
    std::size_t in_row = 0;
    for (std::size_t i = g.albedo.index(0, y); i < g.albedo.index(0, y + 1); ++i) {
      const float albedo = std::max({g.albedo[i].x, g.albedo[i].y, g.albedo[i].z});
      if (!g.valid[i] || albedo <= kRounding) continue;
      ++in_row, most_in[std::size_t(y)] = std::max(most_in[std::size_t(y)], albedo);
    }
    return in_row;
  });
  if (const auto many = many_pixels(g, bright)) {
    g.warnings.push_back(fmt::format(
        "albedo is above 1 in {}, {:.3g} at most: surfaces that send more light than they get; is "
        "this a layer of light?",
        *many, std::ranges::max(most_in)));
  }
}

/// Warns where the ambient layer is brighter than the beauty: occlusion may make it black.
void note_bright_ambient(GBuffer& g) {
  constexpr float kRounding = 0.02f;
  if (g.beauty.empty() || g.ambient.size() != g.beauty.size()) return;
  std::size_t brighter = 0, lit = 0;
  for (std::size_t i = 0; i < g.ambient.size(); ++i) {
    const glm::vec3 over = g.ambient[i] - (1 + kRounding) * g.beauty[i];
    lit += g.ambient[i] != glm::vec3(0);
    brighter += std::max({over.x, over.y, over.z}) > 1e-4f;
  }
  if (brighter == 0 || double(brighter) < kManyPixels * double(lit)) return;
  g.warnings.push_back(fmt::format(
      "ambient is brighter than the beauty in {} pixels ({:.0f} % of those that it lights), which "
      "occlusion may turn black: is it a part of this beauty, in the same exposure?",
      brighter, 100 * double(brighter) / double(lit)));
}

/// Reads the rendered layers, and brings them to the size of the outputs.
void take_rendered(GBuffer& g, const LayerReader& read, const std::vector<const ExrReader*>& files,
                   const LayerTable& table, bool has_beauty) {
  const auto read_layer = [&](const std::string& name, const std::optional<Layer>& layer) {
    Plane<glm::vec3> colors;
    if (!layer) return colors;
    if (has_size_of_outputs(part_of(files, *layer), g.downsampling)) {
      colors = read.vector_over(g.downsampling.small(g.window), layer, 0);
      for (glm::vec3& color : colors.pixels) color = is_sane(color) ? color : glm::vec3(0);
      return colors;
    }
    colors = read.vector(layer, 0);
    clear_broken(g, colors, name, "black there");
    return filter_pixels(colors, g.window, g.downsampling);
  };
  const auto take = [&](Role role, Plane<glm::vec3>& colors) {
    colors = read_layer(std::string(role_name(role)), table[role]);
  };
  if (has_beauty) take(Role::beauty, g.beauty);
  take(Role::ambient, g.ambient);
  take(Role::specular, g.specular);
  for (const auto& [name, layer] : table.lights)
    g.lights[name] = read_layer("light:" + name, layer);
  note_bright_ambient(g);
}

/// Errors: ExitCode::usage where the factor does not divide the size of the display window.
Downsampling make_downsampling(int factor, const Window& display, const std::string& file) {
  if (display.width() % factor != 0 || display.height() % factor != 0) {
    throw Error(ExitCode::usage,
                fmt::format("{}: --downsample {} does not divide the display window of {} x {}; "
                            "render the G-buffer at {} times the size of the output",
                            file, factor, display.width(), display.height(), factor));
  }
  return {factor, display};
}

/// Sets the precision of P, or of the depth that P is made from, and warns where it is poor.
void note_precision(GBuffer& g, const Layer& lead, const ExrPart& part, bool is_position) {
  const std::string_view name = role_name(is_position ? Role::position : Role::depth);
  g.position_step = lead.half ? kStepHalf : kStepFloat;
  if (lead.half) {
    g.warnings.push_back(
        fmt::format("{} is stored in 16 bits: steps of {:.2g} of its magnitude; export 32 bits",
                    name, kStepHalf));
  }
  const Imf::Compression compression = part.header.compression();
  const bool pxr24 = compression == Imf::PXR24_COMPRESSION && !lead.half,
             b44 = (compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION) &&
                   lead.half,
             dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
  if (pxr24) g.position_step = kStepPxr24;
  if (pxr24 || b44 || dwa) {
    g.warnings.push_back(
        fmt::format("{} is stored with lossy compression ({}), which moves surfaces; "
                    "export with ZIP or another lossless one",
                    name,
                    pxr24 ? "PXR24"
                    : b44 ? "B44"
                          : "DWA"));
  }
}

void clear_negative(Plane<glm::vec3>& colors) {
  for_each_row(colors.height, [&](int y) {
    for (std::size_t i = colors.index(0, y), end = colors.index(0, y + 1); i < end; ++i)
      colors[i] = glm::max(colors[i], glm::vec3(0));
  });
}

/// Which pixels of a frame are read.
PixelGrid grid_of(const GBufferOptions& options, const Window& frame, const Window& display) {
  if (frame.area() <= options.most_pixels) return options.grid;
  return {.stride = kOverviewStride, .origin_x = display.x0, .origin_y = display.y0};
}

/// Sets the windows and which of their pixels are read. `part` is that of the position or depth.
void find_windows(GBuffer& g, const std::vector<const ExrReader*>& files, const LayerTable& table,
                  const GBufferOptions& options, const ExrPart& part) {
  g.file_display = part.display_window;
  g.file_window = window_of_frame(
      part, window_of_outputs(files, table, options.beauty, {options.downsample, g.file_display}));
  g.grid = grid_of(options, g.file_window, g.file_display);
  g.window = g.grid.of(g.file_window);
  if (!g.grid.is_coarse() && g.window != g.file_window) g.part_of = g.file_window;
  if (g.file_window != part.data_window) {
    g.lead_window = g.grid.of(part.data_window);
    // Each part fits into memory; a window that holds parts far from each other may not.
    check_decoded_size(files[0]->path(), 0, 0, kBytesPerPixel * double(g.window.area()));
  }
  g.display = g.grid.is_coarse() ? g.grid.of(part.display_window) : part.display_window;
}

}  // namespace

Rendered read_rendered(const std::vector<const ExrReader*>& files, const LayerTable& table,
                       const Window& window, const Downsampling& downsampling) {
  check_decoded_size(files[0]->path(), 0, 0, sizeof(glm::vec4) * double(window.area()));
  const Role role = table[Role::beauty] ? Role::beauty : Role::ambient;
  const LayerReader read(files, table, {role, Role::alpha}, window, {}, nullptr);
  const auto sane = [](auto values) {
    for (auto& value : values.pixels)
      if (!is_sane(value)) value = {};
    return values;
  };
  const bool is_small = has_size_of_outputs(part_of(files, *table[role]), downsampling);
  const Window small = downsampling.small(window);
  Plane<float> alpha = sane(read.scalar(table[Role::alpha], 0));
  if (alpha.empty()) alpha = Plane<float>(window.width(), window.height());
  if (downsampling.is_identity()) return {sane(read.vector(table[role], 0)), std::move(alpha)};
  return {is_small ? sane(read.vector_over(small, table[role], 0))
                   : filter_pixels(sane(read.vector(table[role], 0)), window, downsampling),
          filter_pixels(alpha, window, downsampling)};
}

GBuffer read_gbuffer(const std::vector<const ExrReader*>& files, const LayerTable& table,
                     const GBufferOptions& options, const Plane<float>* deep) {
  const std::string file = files[0]->path().string();
  const auto& lead = table[Role::position] ? table[Role::position] : table[Role::depth];
  const ExrPart& part = part_of(files, *lead);
  GBuffer g;
  find_windows(g, files, table, options, part);
  g.downsampling = make_downsampling(options.downsample, g.display, file);
  g.pixel_aspect = part.header.pixelAspectRatio();
  if (!(g.pixel_aspect > 0) || !std::isfinite(g.pixel_aspect)) g.pixel_aspect = 1;
  const ExrReader& of_lead = *files[std::size_t(lead->file)];
  // A part of two views has one header, whose camera is that of the default view.
  if (in_view_of(of_lead, part, lead->channels[0], "A") == "A")
    g.header = header_numbers(of_lead, lead->part);
  g.by_blender = is_by_blender(part.header);
  note_precision(g, *lead, part, table[Role::position].has_value());

  std::vector<Role> roles = {Role::position, Role::depth,    Role::normal,    Role::albedo,
                             Role::radiance, Role::alpha,    Role::roughness, Role::motion,
                             Role::ambient,  Role::specular, Role::light,     Role::specular_color};
  if (options.beauty) roles.push_back(Role::beauty);
  check_display_windows(files, table, roles, g.downsampling);
  const LayerReader read(files, table, roles, g.window, g.grid, deep);
  g.position = read.vector(table[Role::position], NAN);
  g.depth = read.scalar(table[Role::depth], NAN);
  g.normal = read.vector(table[Role::normal], NAN);
  g.albedo = read.vector(table[Role::albedo], 0);
  g.radiance = read.vector(table[Role::radiance], 0);
  g.alpha = read.scalar(table[Role::alpha], 0);
  g.roughness = read.scalar(table[Role::roughness], 0);
  g.specular_color = read.vector(table[Role::specular_color], 0);
  g.motion = read.motion(table[Role::motion]);
  const glm::vec2 scale = options.motion_scale.value_or(glm::vec2(1));
  for (glm::vec2& to : g.motion.pixels) to = {scale.x * to.x, -scale.y * to.y};

  g.space = options.space;
  undo_depth_encoding(g, options, file, table[Role::depth] ? &*table[Role::depth] : nullptr);
  find_background(g, options.background_depth, options.known);
  undo_normal_encoding(g, options.known);
  note_data_windows(files, table, roles, g);
  clear_broken(g, g.normal, "normal", "rebuilt there");
  clear_broken(g, g.albedo, "albedo", "black there");
  clear_broken(g, g.radiance, "radiance", "black there");
  note_bright_albedo(g);
  take_rendered(g, read, files, table, options.beauty);
  clear_negative(g.albedo);
  clear_negative(g.radiance);
  if (const auto& albedo = table[Role::albedo])
    undo_alpha_of_albedo(g, albedo->premultiplied, options.known);
  clear_broken(g, g.roughness, "roughness", "smooth there");
  for (float& r : g.roughness.pixels) r = std::clamp(r, 0.0f, 1.0f);
  clear_broken(g, g.specular_color, "specular-color", "black there");
  for (glm::vec3& c : g.specular_color.pixels) c = glm::clamp(c, 0.0f, 1.0f);
  return g;
}

}  // namespace ssdo
