// SPDX-License-Identifier: Apache-2.0
#include "relight/lamp_links.h"

#include <map>
#include <string>
#include <utility>

#include "scene/objects/read_object_masks.h"
#include "scene/objects/selected_coverage.h"
#include "scene/other_views/covered_pixels.h"

namespace ssdo {
namespace {

/// The scene that holds only what is selected of the frame and the views, without `out`.
std::shared_ptr<const Scene> selected_alone(Frame& frame, const KnownGeometry& known,
                                            const Selection& selection, const ExcludedObjects& out,
                                            const SolidOptions& options) {
  const GBuffer& from = frame.gbuffer;
  std::vector<std::string> warnings;
  ExcludedObjects rest = out;
  rest.cast = selection.text;
  rest.coverage =
      all_but(selected_coverage(selection, frame.selections(warnings), from.window, from.grid),
              out.coverage, frame.scene.geometry);
  frame.warn(warnings);
  auto scene = std::make_shared<Scene>();
  scene->geometry = frame.scene.geometry;
  KnownGeometry views;
  views.views = known.views;
  use_known_geometry(views, *scene, options.thickness, options.reading, &rest);
  scene->geometry = {};
  scene->views.clear();
  scene->other_surfaces.all = {};
  return scene;
}

}  // namespace

std::shared_ptr<const Plane<float>> find_receivers(Frame& frame, Lamp& lamp, int number,
                                                   bool allow_partial) {
  for (Selection* selection : {&lamp.receive, &lamp.cast}) {
    *selection = at_frame(*selection, number);
    open_mattes(*selection, frame.files, allow_partial);
  }
  if (lamp.receive.empty()) return nullptr;
  std::vector<std::string> warnings;
  Plane<float> coverage = selected_coverage(lamp.receive, frame.selections(warnings),
                                            frame.gbuffer.window, frame.gbuffer.grid);
  frame.warn(warnings);
  return std::make_shared<const Plane<float>>(std::move(coverage));
}

LampLinks links_of(const std::vector<Lamp>& lamps, int number) {
  LampLinks links;
  for (const Lamp& lamp : lamps) {
    if (!lamp.cast.empty()) links.cast.push_back(at_frame(lamp.cast, number));
    if (!lamp.receive.empty()) links.receive.push_back(at_frame(lamp.receive, number));
  }
  return links;
}

Plane<float> all_but(const Plane<float>& selected, const Plane<float>& out, const Geometry& frame) {
  const Surfaces& surfaces = frame.surfaces;
  const Plane<unsigned char> shown = covered_pixels(surfaces, frame.camera, selected);
  Plane<float> rest = out.empty() ? Plane<float>(surfaces.width, surfaces.height, 0.0f) : out;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (surfaces[i].is_surface() && !shown[i]) rest[i] = 1;
  return rest;
}

void find_linked_occluders(Frame& frame, const KnownGeometry& known, const ExcludedObjects& out,
                           const SolidOptions& options, Scene& scene) {
  std::map<std::string, std::shared_ptr<const Scene>> found;  // lamps share what they select alike
  for (const auto& [name, lamp] : frame.lamps) {
    if (lamp.cast.empty()) continue;
    std::shared_ptr<const Scene>& blockers = found[lamp.cast.text];
    if (!blockers) blockers = selected_alone(frame, known, lamp.cast, out, options);
    scene.linked_occluders[lamp.source] = blockers;
  }
}

}  // namespace ssdo
