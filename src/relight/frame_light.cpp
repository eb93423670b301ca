// SPDX-License-Identifier: Apache-2.0
#include "relight/frame_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "io/pictures/primaries.h"
#include "relight/lamp_links.h"
#include "relight/lamp_warnings.h"
#include "relight/read_frame.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {
namespace {

WorldUp find_up(const Frame& frame, const FrameOptions& options) {
  const bool asks = options.up_of_shot && !header_tells_up(frame.gbuffer);
  return find_world_up(frame.gbuffer, frame.scene.geometry,
                       asks ? options.up_of_shot() : std::nullopt);
}

/// The colour of a black body in the primaries of the frame, which are Rec. 709 where its header
/// names none; colours outside of them are cut off.
glm::dvec3 in_primaries_of(const Frame& frame, const glm::dvec3& rec709) {
  const auto primaries = chromaticities_of(frame.part().header);
  if (!primaries || same_chromaticities(*primaries, kRec709)) return rec709;
  const auto matrix = conversion_of_primaries(kRec709, *primaries);
  return matrix ? glm::max(glm::dmat3(*matrix) * rec709, glm::dvec3(0)) : rec709;
}

/// The sources of lamps in camera space, after those of the map.
void add_lamps(Frame& frame, std::vector<Lamp> lamps, int number, bool allow_partial) {
  if (lamps.empty()) return;
  Scene& scene = frame.scene;
  const Geometry& geometry = scene.geometry;
  std::string names;
  for (Lamp& lamp : lamps) {
    lamp.temperature = in_primaries_of(frame, lamp.temperature);
    const double depth = -geometry.camera.to_camera(lamp.position).z;
    const double pixel =
        depth > 0 ? geometry.frame_height_at(float(depth)) / geometry.display.height() : 0;
    const WorldToCamera placed{geometry.camera.rotation, geometry.camera.origin};
    const auto make = [lamp, placed, pixel] { return make_source(lamp, placed, pixel / 2); };
    const auto source = make();
    source->receivers = find_receivers(frame, lamp, number, allow_partial);
    source->receive = lamp.receive.text;
    frame.warn(warnings_of(lamp, *source, geometry));
    frame.lamps.emplace(lamp.name,
                        LampOfFrame{lamp.given_by, lamp.type != LampType::distant,
                                    scene.light.sources.size(), lamp.cast, lamp.receive, make});
    scene.light.sources.push_back(source);
    names += (names.empty() ? "" : ", ") + lamp.name;
  }
  frame.light +=
      fmt::format("; {} {}: {}", lamps.size(), lamps.size() > 1 ? "lamps" : "lamp", names);
  if (geometry.world_known) return;
  frame.warn(
      {"the frame knows no world space; lamps are taken in camera space: give --camera "
       "FILE.json to place them"});
}

}  // namespace

void light_frame(Frame& frame, const Lighting& lighting, const FrameOptions& options,
                 const FrameFiles& files, int number) {
  Scene& scene = frame.scene;
  const bool world = scene.geometry.world_known;
  WorldUp up;
  const bool asks_prior = prior_of(options.model) == Prior::learned && !options.light.up;
  // Mirrors show ground that goes on beyond the frame.
  const bool mirrors = !options.light.up && wants_reflection(options.output, files.aovs);
  if (world && (lighting.needs_up() || asks_prior || mirrors)) up = find_up(frame, options);
  if (world && (options.light.up || (asks_prior && up.known))) {
    const UpAxis axis = options.light.up.value_or(up.axis);
    frame.up = scene.geometry.world_to_camera[axis == UpAxis::z ? 2 : 1];
  }
  const FrameEnvironment around = lighting.around(up.axis, chromaticities_of(frame.part().header));
  scene.light = model_light(around.environment, scene.geometry.world_to_camera);
  frame.light = around.description;
  frame.warn(around.warnings);
  const bool has_directions = !around.environment.is_constant();
  if (has_directions && world && !options.light.up) {
    frame.light += "; up " + up.source;
    if (!up.warning.empty()) frame.warn({up.warning});
  }
  if (has_directions && !world) {
    frame.warn(
        {"the frame knows no world space; the environment is taken in "
         "camera space: give --camera FILE.json to place it"});
  }
  if (has_directions && world && glm::determinant(scene.geometry.world_to_camera) < 0)
    frame.warn({"the world of P is left-handed: the map lies in its axes, and appears mirrored"});
  add_lamps(frame, lighting.lamps(), number, options.input.allow_partial);
}

}  // namespace ssdo
