// SPDX-License-Identifier: Apache-2.0
#include "relight/frame_warnings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <set>
#include <string_view>

#include "io/exr/kept_channels.h"
#include "io/pictures/transfer_curve.h"
#include "relight/ineffective_options.h"
#include "scene/layers/advice.h"
#include "scene/layers/windows.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Text that names the default products left out for lack of an albedo; "" if products were asked
/// for by name, if none is written, or if there is a composite all the same.
std::string left_out_without_albedo(const Plan& plan, const OutputOptions& output) {
  if (!output.products.empty() || plan.write.empty() || contains(plan.write, "composite"))
    return "";
  return makes(*plan.method, find_product("bounce")) ? ": no bounce and no composite"
                                                     : ": no composite";
}

/// Says what follows from layers that the frame lacks, and which may be meant for them.
void warn_of_missing_layers(Frame& frame, const OutputOptions& output) {
  const auto warn = [&](Role role, const std::string& effect) {
    if (frame.layers[role]) return;
    std::string remedy = hint_at(role, group_channels(frame.files.front(), 0, frame.view));
    if (remedy.empty() && effect.empty()) return;
    if (remedy.empty()) remedy = fmt::format("name one with --aov {}=LAYER", role_name(role));
    frame.report.warnings.push_back(
        fmt::format("no layer for {} found by name{}; {}", role_name(role), effect, remedy));
  };
  const bool has_surfaces = frame.report.placement.median_depth > 0;
  warn(Role::position, "");
  warn(Role::normal, frame.layers[Role::position] && has_surfaces
                         ? ": normals are rebuilt from the position"
                         : "");
  warn(Role::albedo, left_out_without_albedo(frame.plan, output));
}

/// A radius that is given in another unit than that of the scene leaves nothing to see, or is none.
void warn_of_radius(Frame& frame, const ModelOptions& model) {
  const Geometry& g = frame.scene.geometry;
  if (!model.radius || std::isinf(*model.radius) || g.median_depth <= 0) return;
  const double pixel =
      double(g.frame_height_at(g.median_depth)) / frame.gbuffer.display_of_file().height();
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const Surfel& s : g.surfaces) {
    if (!s.is_surface()) continue;
    low = glm::min(low, s.position), high = glm::max(high, s.position);
  }
  const double scene = glm::distance(low, high);
  const auto warn = [&](std::string_view how, std::string_view effect) {
    frame.report.warnings.push_back(fmt::format(
        "--radius {:g} is {}, and {}; is it in the unit of P?", *model.radius, how, effect));
  };
  if (*model.radius < pixel)
    warn(fmt::format("less than a pixel, which is {:.3g} wide at the median depth {:.4g}", pixel,
                     g.median_depth),
         "next to nothing occludes");
  else if (*model.radius > scene)
    warn(fmt::format("more than all that the frame shows, which is {:.3g} across", scene),
         "limits nothing");
}

/// Whether --crop leaves anything out. Outputs cover rendered layers too, and kept parts are
/// cropped as well.
bool has_overscan(const Frame& frame, const OutputOptions& output) {
  const Window& display = frame.part().display_window;
  const auto reaches_beyond = [&](const ExrPart& part) {
    return intersection(part.data_window, display) != part.data_window;
  };
  bool found = reaches_beyond(frame.part());
  for (const Role role : kRendered)
    for (const Layer* layer : frame.layers.all(role))
      found |=
          reaches_beyond(frame.files[std::size_t(layer->file)].parts()[std::size_t(layer->part)]);
  for (const ExrPart& part : frame.files.front().parts())
    found |= output.keep_channels && reaches_beyond(part);
  return found;
}

}  // namespace

void warn_of_encoded_colors(Frame& frame) {
  std::set<std::string> warned;
  for (const Role role :
       {Role::albedo, Role::beauty, Role::radiance, Role::ambient, Role::specular, Role::light}) {
    for (const Layer* layer : frame.layers.all(role)) {
      const ExrReader& file = frame.files[std::size_t(layer->file)];
      const auto curve = curve_of(file.parts()[std::size_t(layer->part)].header);
      if (!curve || !warned.insert(curve->space).second) continue;
      frame.report.warnings.push_back(fmt::format(
          "the header says that colours are {}, which is not linear, and {} is taken as linear: "
          "convert its colours, or correct colorInteropID or oiio:ColorSpace",
          curve->space, role_name(role)));
    }
  }
}

void warn_of_plan(Frame& frame, const FrameOptions& options, bool has_deep_pixels) {
  warn_of_missing_layers(frame, options.output);
  warn_of_radius(frame, options.model);
  frame.warn(
      ineffective_options(options, {.plan = frame.plan,
                                    .depth = has_deep_pixels || frame.layers[Role::depth],
                                    .position = frame.layers[Role::position].has_value(),
                                    .normal = frame.layers[Role::normal].has_value(),
                                    .ambient = !frame.gbuffer.ambient.empty(),
                                    .specular = !frame.gbuffer.specular.empty(),
                                    .lights = !frame.gbuffer.lights.empty(),
                                    .specular_color = !frame.scene.specular_color.empty(),
                                    .constant_light = frame.scene.light.environment.is_constant(),
                                    .lamps = has_lamps(frame.scene.light),
                                    .overscan = has_overscan(frame, options.output)}));
}

void explain_earlier_products(Frame& frame) {
  const EarlierProducts earlier = earlier_products(frame.part());
  if (earlier.empty()) return;
  std::string text = "an earlier run of ssdo made ";
  for (const auto& [name, moved] : earlier) text += name + ", ";
  text += "which are not used as layers of the render";
  if (const auto& beauty = frame.layers[Role::beauty])
    text += fmt::format("; its beauty is {}", fmt::join(beauty->channels, ", "));
  frame.plan.reasons.push_back(text);
}

}  // namespace ssdo
