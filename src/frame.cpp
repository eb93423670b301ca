// SPDX-License-Identifier: Apache-2.0
#include "frame.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <set>
#include <string_view>
#include <utility>

#include "composite_choice.h"
#include "error.h"
#include "estimators/registry.h"
#include "io/exr/kept_channels.h"
#include "io/transfer_curve.h"
#include "known_geometry.h"
#include "scene/camera/world_up.h"
#include "scene/layers/advice.h"
#include "scene/layers/windows.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

bool wants_reflection(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  return contains(output.products, "reflection") || contains(output.products, kAllProducts) ||
         std::any_of(output.saves.begin(), output.saves.end(),
                     [](const SaveRequest& save) { return save.product == "reflection"; }) ||
         (choose_compose(output, aovs) == Compose::occlude &&
          std::any_of(aovs.begin(), aovs.end(),
                      [](const LayerRequest& aov) { return aov.role == Role::specular; }));
}

/// The usual products that an EXR of the frame goes without, since it has no albedo; "" where it
/// has a composite all the same.
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
  for (const Surfel& s : g.surfel.pixels) {
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

/// Outputs cover rendered layers too, and kept parts are cropped as well.
void warn_of_idle_crop(Frame& frame, const OutputOptions& output) {
  const Window& display = frame.part().display_window;
  const auto reaches_beyond = [&](const ExrPart& part) {
    return intersection(part.data_window, display) != part.data_window;
  };
  bool has_effect = reaches_beyond(frame.part());
  for (const Role role : kRendered) {
    const auto& layer = frame.layers[role];
    if (layer)
      has_effect |=
          reaches_beyond(frame.files[std::size_t(layer->file)].parts()[std::size_t(layer->part)]);
  }
  for (const ExrPart& part : frame.files.front().parts())
    has_effect |= output.keep_channels && reaches_beyond(part);
  if (output.crop && !has_effect)
    frame.report.warnings.push_back(
        "--crop has no effect: the frame has no pixels beyond its display window");
}

/// Colours are not decoded: the outputs keep the header, which says how they are encoded.
void warn_of_encoded_colors(Frame& frame) {
  std::set<std::string> warned;
  for (const Role role :
       {Role::albedo, Role::beauty, Role::radiance, Role::ambient, Role::specular}) {
    const auto& layer = frame.layers[role];
    if (!layer) continue;
    const ExrReader& file = frame.files[std::size_t(layer->file)];
    const auto curve = curve_of(file.parts()[std::size_t(layer->part)].header);
    if (!curve || !warned.insert(curve->space).second) continue;
    frame.report.warnings.push_back(fmt::format(
        "the header says that colours are {}, which is not linear, and {} is taken as linear: "
        "convert its colours, or correct colorInteropID or oiio:ColorSpace",
        curve->space, role_name(role)));
  }
}

/// Bands have the rows of the frame.
void check_bands(const Frame& frame, bool composites) {
  std::vector<const ExrReader*> files;
  for (const ExrReader& file : frame.files) files.push_back(&file);
  if (window_of_outputs(files, frame.layers, composites, {}) == frame.gbuffer.file_window) return;
  throw Error(ExitCode::usage,
              fmt::format("{}: a rendered layer reaches beyond the display window, where the data "
                          "window of P ends, and takes all of the frame at once: render P with the "
                          "same overscan, or raise --mem-limit",
                          frame.input));
}

void warn_of_idle_depth_options(Frame& frame, const GBufferOptions& options) {
  if (frame.layers[Role::depth]) return;
  const auto warn = [&](std::string_view option) {
    frame.report.warnings.push_back(
        fmt::format("{} has no effect: the frame has no depth layer", option));
  };
  if (options.depth_kind) warn("--depth-kind");
  if (options.background_depth) warn("--background-depth");
}

void warn_of_idle_light_options(Frame& frame, const LightOptions& options) {
  if (!frame.scene.light.is_constant()) return;
  const auto warn = [&](std::string_view option) {
    frame.report.warnings.push_back(
        fmt::format("{} has no effect: the light is the same from everywhere", option));
  };
  if (options.rotate_degrees != 0) warn("--env-rotate");
  if (options.up) warn("--env-up");
}

/// What is in a file besides the render, as it is an output of ssdo.
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

}  // namespace

const Layer& Frame::lead() const {
  return layers[Role::position] ? *layers[Role::position] : *layers[Role::depth];
}

const ExrPart& Frame::part() const {
  return files[std::size_t(lead().file)].parts()[std::size_t(lead().part)];
}

std::vector<std::string> Frame::warnings() const {
  std::vector<std::string> all = gbuffer.warnings;
  all.insert(all.end(), report.warnings.begin(), report.warnings.end());
  return all;
}

std::vector<std::string> Frame::losses() const {
  std::vector<std::string> all;
  for (const ExrReader& file : files)
    for (const std::string& line : file.losses()) all.push_back(line);
  all.insert(all.end(), further_losses.begin(), further_losses.end());
  return all;
}

Frame prepare_frame(const FrameOptions& options, const Lighting& light, FurtherPictures& pictures,
                    const FrameFiles& files, int number) {
  Frame frame;
  frame.input = files.input;
  frame.view = files.view;
  Stopwatch watch;
  // Names that nothing asks for are no reason to refuse a frame.
  std::vector<Role> unused;
  if (!wants_reflection(options.output, files.aovs)) unused.push_back(Role::roughness);
  if (!options.model.temporal) unused.push_back(Role::motion);
  std::deque<ExrReader> opened = open_view(files.input, files.aovs, options.input.allow_partial);
  const double opening = watch.lap();
  InputOptions input = for_view(options.input, files);
  input.gbuffer.downsample = options.output.downsample;
  input.gbuffer.beauty = choose_compose(options.output, files.aovs) != Compose::relight;
  input.gbuffer.most_pixels = most_pixels_in(options.memory);
  View view = read_view(std::move(opened), files.aovs, input, options.camera, unused);
  frame.files = std::move(view.files);
  frame.layers = std::move(view.layers);
  frame.gbuffer = std::move(view.gbuffer);
  frame.report = std::move(view.report);
  frame.times.read = opening + view.read_ms;
  warn_of_encoded_colors(frame);

  Scene& scene = frame.scene;
  scene.geometry = std::move(view.geometry);
  scene.senders = {in_half(frame.gbuffer.albedo), std::move(frame.gbuffer.radiance)};
  frame.gbuffer.albedo = {};
  scene.roughness = std::move(frame.gbuffer.roughness);
  if (scene.geometry.camera.panorama) {
    throw Error(ExitCode::layer,
                fmt::format("{}: is a lat-long panorama, which shows no frame; give it with --also "
                            "to a frame of the same scene",
                            frame.input));
  }
  Stopwatch of_known;
  KnownGeometry known = read_known_geometry(frame, files, options, pictures, view.deep);
  frame.times.known = of_known.lap();
  if (known.deep.empty()) warn_of_idle_depth_options(frame, options.input.gbuffer);
  const bool world = scene.geometry.world_known;
  const Imf::Header& header = frame.part().header;
  WorldUp up;
  if (world && light.needs_up()) {
    const bool asks = options.up_of_shot && !header_tells_up(frame.gbuffer);
    up = find_world_up(frame.gbuffer, scene.geometry, asks ? options.up_of_shot() : std::nullopt);
  }
  const FrameEnvironment around = light.around(up.axis, chromaticities_of(header));
  scene.light = model_light(around.environment, scene.geometry.world_to_camera);
  frame.light = around.description;
  frame.report.warnings.insert(frame.report.warnings.end(), around.warnings.begin(),
                               around.warnings.end());
  if (!scene.light.is_constant() && world && !options.light.up) {
    frame.light += "; up " + up.source;
    if (!up.warning.empty()) frame.report.warnings.push_back(up.warning);
  }
  if (!scene.light.is_constant() && !world) {
    frame.report.warnings.push_back(
        "the frame knows no world space; the environment is taken in "
        "camera space: give --camera FILE.json to place it");
  }
  if (!scene.light.is_constant() && world && glm::determinant(scene.geometry.world_to_camera) < 0) {
    frame.report.warnings.push_back(
        "the world of P is left-handed: the map lies in its axes, and appears mirrored");
  }
  warn_of_idle_light_options(frame, options.light);
  ModelOptions model = options.model;
  if (model.temporal) model.seed += unsigned(number);
  of_known.lap();
  if (find_method(model.method).takes.thickness) {
    std::optional<float> thickness;
    if (model.thickness) thickness = float(*model.thickness);
    frame.views = use_known_geometry(known, scene, thickness, options.input.gbuffer);
  } else {
    const auto warn = [&](std::string_view option) {
      known.warnings.push_back(fmt::format(
          "{} has no effect: method {} does not look behind what is seen", option, model.method));
    };
    if (!files.also.empty()) warn("--also");
    if (!files.neighbours.empty()) warn("--neighbours");
  }
  if (!files.also.empty() || !files.neighbours.empty()) frame.times.known += of_known.lap();
  frame.report.warnings.insert(frame.report.warnings.end(), known.warnings.begin(),
                               known.warnings.end());
  frame.further_losses = std::move(known.losses);
  frame.plan = make_plan(model, options.output, scene, frame.gbuffer, frame.input);
  if (frame.gbuffer.grid.is_coarse()) {
    check_bands(frame, input.gbuffer.beauty);
    const Window& all = frame.gbuffer.file_window;
    frame.bands = plan_bands(frame.input, all, frame.part().display_window, scene, frame.plan,
                             options.output, options.memory);
    frame.plan.reasons.push_back(describe(*frame.bands, all));
  }
  warn_of_missing_layers(frame, options.output);
  warn_of_radius(frame, model);
  warn_of_idle_crop(frame, options.output);
  const std::vector<std::string> idle =
      idle_for_composite(frame.plan, options.output, frame.gbuffer);
  frame.report.warnings.insert(frame.report.warnings.end(), idle.begin(), idle.end());
  explain_earlier_products(frame);
  explain_views(frame.plan, frame.views);
  frame.advice = explain_guessed(frame.plan, scene);
  frame.times.prepare = watch.lap() - view.read_ms - frame.times.known;
  return frame;
}

ColorTags color_tags(const Frame& frame) {
  const Imf::Header& header = frame.part().header;
  ColorTags tags;
  tags.path = frame.input;
  tags.interop_id = string_attribute(header, "colorInteropID");
  tags.aces_container = int_attribute(header, "acesImageContainerFlag") == 1;
  tags.chromaticities = chromaticities_of(header);
  return tags;
}

}  // namespace ssdo
