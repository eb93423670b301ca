// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "error.h"
#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

using Files = std::vector<const ExrReader*>;

constexpr float kSameAspect = 1e-4f;

Role lead_of(const LayerTable& table) {
  return table[Role::position] ? Role::position : Role::depth;
}

/// "part 2 'Albedo' of half.exr", or the file where it has no other part.
std::string text_of(const ExrReader& file, const ExrPart& part) {
  const std::string path = file.path().string();
  return file.parts().size() > 1 ? label(part) + " of " + path : path;
}

/// "albedo 'Albedo' in half.exr".
std::string text_of(const Files& files, Role role, const Layer& layer) {
  return fmt::format("{} '{}' in {}", role_name(role), layer.name,
                     text_of(*files[std::size_t(layer.file)], part_of(files, layer)));
}

/// Whether the frame shows a surface there, whatever the layers say that end before it.
bool shows_surface(const GBuffer& g, std::size_t i, Role role) {
  if (!row_of(role).background_outside || g.position.empty()) return g.valid[i] != 0;
  const glm::vec3 p = g.position[i];
  return std::isfinite(p.x + p.y + p.z) && p != glm::vec3(0);
}

void note_data_window(const Files& files, Role role, const Layer& layer, GBuffer& g) {
  const ExrPart& part = part_of(files, layer);
  const Window &all = g.window, own = has_size_of_outputs(part, g.downsampling)
                                          ? g.downsampling.large(part.data_window)
                                          : g.grid.of(part.data_window);
  std::size_t surfaces = 0, left_out = 0;
  for (std::size_t i = 0; i < g.valid.size(); ++i) {
    const int x = all.x0 + int(i % std::size_t(g.valid.width)),
              y = all.y0 + int(i / std::size_t(g.valid.width));
    const bool outside = !own.contains(x, y), surface = shows_surface(g, i, role);
    surfaces += surface;
    left_out += surface && outside;
    if (outside && role == Role::normal) g.normal[i] = glm::vec3(0);
  }
  if (left_out == 0) return;
  g.warnings.push_back(fmt::format("{} ends at its data window {}: {} of {} surfaces {}",
                                   text_of(files, role, layer), text_of(part.data_window), left_out,
                                   surfaces, row_of(role).outside));
}

bool is_rendered(Role role) {
  return std::find(kRendered.begin(), kRendered.end(), role) != kRendered.end();
}

/// What to do about a layer of role `role` with the display window `own` beside `wanted`.
std::string remedy(Role role, const Window& own, const Window& wanted,
                   const Downsampling& downsampling) {
  if (!is_rendered(role)) return "layers of a frame share one: render or resize them to one size";
  if (!downsampling.is_identity()) {
    return fmt::format("with --downsample {} it needs {} or {}: render or resize it to one of them",
                       downsampling.factor, text_of(wanted), text_of(downsampling.small(wanted)));
  }
  const int factor = own.width() > 0 ? wanted.width() / own.width() : 0;
  const bool fits = factor > 1 && Downsampling{factor, wanted}.small(wanted) == own;
  return fmt::format("layers of a frame share one: render or resize them to one size{}",
                     fits ? fmt::format(", or give --downsample {}", factor) : "");
}

}  // namespace

const ExrPart& part_of(const Files& files, const Layer& layer) {
  return files[std::size_t(layer.file)]->parts()[std::size_t(layer.part)];
}

Window window_of_outputs(const Files& files, const LayerTable& table, bool composites,
                         const Downsampling& downsampling) {
  Window all = part_of(files, *table[lead_of(table)]).data_window;
  for (const Role role : composites ? kRendered : std::vector<Role>()) {
    for (const Layer* layer : table.all(role)) {
      const ExrPart& part = part_of(files, *layer);
      const Window& own = part.data_window;
      all = hull(all, has_size_of_outputs(part, downsampling) ? downsampling.large(own) : own);
    }
  }
  return all;
}

Window window_of_frame(const ExrPart& lead, const Window& outputs) {
  const Window &own = lead.data_window, &display = lead.display_window;
  return {own.x0 == display.x0 ? own.x0 : outputs.x0, own.y0 == display.y0 ? own.y0 : outputs.y0,
          own.x1 == display.x1 ? own.x1 : outputs.x1, own.y1 == display.y1 ? own.y1 : outputs.y1};
}

bool has_size_of_outputs(const ExrPart& part, const Downsampling& downsampling) {
  return !downsampling.is_identity() &&
         part.display_window == downsampling.small(downsampling.display);
}

void check_display_windows(const Files& files, const LayerTable& table,
                           const std::vector<Role>& roles, const Downsampling& downsampling) {
  const Role lead = lead_of(table);
  const Window& wanted = part_of(files, *table[lead]).display_window;
  const auto check = [&](Role role, const Layer& layer) {
    const ExrPart& part = part_of(files, layer);
    const Window& own = part.display_window;
    if (own == wanted || (is_rendered(role) && has_size_of_outputs(part, downsampling))) return;
    throw Error(ExitCode::layer,
                fmt::format("{}: {} has the display window {}, and {} has {}; {}",
                            files[0]->path().string(), text_of(files, role, layer), text_of(own),
                            text_of(files, lead, *table[lead]), text_of(wanted),
                            remedy(role, own, wanted, downsampling)));
  };
  for (const Role role : roles)
    for (const Layer* layer : table.all(role)) check(role, *layer);
}

void note_data_windows(const Files& files, const LayerTable& table, const std::vector<Role>& roles,
                       GBuffer& g) {
  const float aspect = part_of(files, *table[lead_of(table)]).header.pixelAspectRatio();
  std::set<const ExrPart*> noted;
  const auto note = [&](Role role, const Layer& layer) {
    const ExrPart& part = part_of(files, layer);
    const bool unused = role == Role::depth && g.depth.empty();  // it contradicts P
    const Window own_window = g.grid.of(part.data_window), lead = g.lead_window.value_or(g.window);
    if (!unused && hull(own_window, lead) != own_window) note_data_window(files, role, layer, g);
    const float own = part.header.pixelAspectRatio();
    if (std::abs(own - aspect) <= kSameAspect * aspect || !noted.insert(&part).second) return;
    g.warnings.push_back(fmt::format(
        "{} has pixels of aspect {:.4g}, and {} those of {:.4g}; pixels are matched one to one",
        text_of(*files[std::size_t(layer.file)], part), own, role_name(lead_of(table)), aspect));
  };
  for (const Role role : roles)
    for (const Layer* layer : table.all(role)) note(role, *layer);
}

}  // namespace ssdo
