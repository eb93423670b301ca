// SPDX-License-Identifier: Apache-2.0
#include "relight/read_band.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "relight/lamp_links.h"
#include "scene/build_geometry.h"
#include "scene/objects/read_object_masks.h"
#include "scene/objects/selected_coverage.h"
#include "scene/other_views/remove_objects.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Finds the casters of some rows. Objects that the overview has taken out anywhere are looked for
/// in these rows.
class CastersOfBand {
 public:
  CastersOfBand(const RelightJob& job, const Geometry& rows, const PixelGrid& grid)
      : frame_(job.frame), model_(job.options.model), rows_(rows), grid_(grid) {
    if (!frame_.is_backdrop) return;
    backdrop_ = Plane<float>(rows.surfaces.width, rows.surfaces.height, 0.0f);
    for (std::size_t i = 0; i < backdrop_.size(); ++i)
      if (rows.surfaces[i].is_surface() && frame_.is_backdrop(rows.surfaces[i])) backdrop_[i] = 1;
  }

  /// Fills `scene`, of these rows, as `overview` is filled.
  void fill(Scene& scene, const Scene& overview) const {
    const Plane<float> out = coverage_of(frame_.objects.no_cast);
    fill(scene, out, overview);
    if (!overview.without) return;
    Plane<float> both = coverage_of(frame_.objects.shadow_of);
    for (std::size_t i = 0; i < both.size(); ++i) both[i] = std::max(both[i], out[i]);
    scene.without = std::make_shared<Scene>();
    scene.without->geometry = scene.geometry;
    scene.without->light = scene.light;
    fill(*scene.without, both, *overview.without);
  }

 private:
  Plane<float> coverage_of(const Selection& selection) const {
    if (selection.empty()) return {rows_.surfaces.width, rows_.surfaces.height, 0.0f};
    return selected_coverage(selection, {frame_.files, frame_.view}, rows_.window, grid_);
  }

  /// Fills a scene without `out`, and the blockers of linked lamps.
  void fill(Scene& scene, const Plane<float>& out, const Scene& overview) const {
    take_out_of(scene, out, overview);
    std::map<std::string, std::shared_ptr<const Scene>>
        found;  // as find_linked_occluders() shares them
    for (const auto& [name, lamp] : frame_.lamps) {
      if (lamp.cast.empty()) continue;
      std::shared_ptr<const Scene>& blockers = found[lamp.cast.text];
      if (!blockers) {
        auto selected = std::make_shared<Scene>();
        take_out_of(*selected, all_but(coverage_of(lamp.cast), out, rows_),
                    *overview.linked_occluders.at(lamp.source));
        blockers = std::move(selected);
      }
      scene.linked_occluders[lamp.source] = blockers;
    }
  }

  void take_out_of(Scene& scene, const Plane<float>& out, const Scene& overview) const {
    if (overview.caster_surfaces)
      scene.caster_surfaces =
          remove_objects(rows_, out, backdrop_, {}, &overview.caster_surfaces->geometry);
    const Geometry& casters = scene.caster_surfaces ? scene.caster_surfaces->geometry : rows_;
    scene.solids = model_.thickness
                       ? constant_thickness(casters, float(*model_.thickness))
                       : guess_solids(casters, SolidsOfOverview{overview.casters(),
                                                                overview.solids.thickness});
  }

  const Frame& frame_;
  const ModelOptions& model_;
  const Geometry& rows_;
  const PixelGrid& grid_;
  Plane<float> backdrop_;  ///< empty: none is taken out
};

/// The light of a frame for some rows of it: lamps light what these show of their selections.
Light light_of_rows(const Frame& frame, const Light& light, const Window& rows,
                    const PixelGrid& grid) {
  Light out = light;
  for (const auto& [name, lamp] : frame.lamps) {
    if (lamp.receive.empty()) continue;
    const std::shared_ptr<Source> source = lamp.make();
    source->receivers = std::make_shared<const Plane<float>>(
        selected_coverage(lamp.receive, {frame.files, frame.view}, rows, grid));
    out.sources[lamp.source] = source;
  }
  return out;
}

}  // namespace

Band read_band(const RelightJob& job, const Scene& overview, const Window& rows,
               StageTimes& times) {
  const Frame& frame = job.frame;
  Stopwatch watch;
  GBufferOptions reading = job.options.input.gbuffer;
  reading.beauty = frame.plan.composition.shows_rendered();
  reading.grid = {.y0 = rows.y0, .y1 = rows.y1};
  reading.known = frame.gbuffer.encodings;
  Band band;
  band.gbuffer = read_gbuffer(frame.readers(), frame.layers, reading);
  band.gbuffer.masks = read_object_masks(frame.objects, {frame.files, frame.view},
                                         band.gbuffer.window, reading.grid);
  times.read += watch.lap();
  GeometryReport report;
  band.scene =
      take_scene(band.gbuffer, build_geometry(band.gbuffer, job.options.camera, frame.input, report,
                                              &frame.report.placement));
  band.gbuffer.position = {};
  band.gbuffer.normal = {};
  band.gbuffer.depth = {};
  const Geometry& geometry = band.scene.geometry;
  band.scene.light = light_of_rows(frame, overview.light, geometry.window, reading.grid);
  CastersOfBand(job, geometry, reading.grid).fill(band.scene, overview);
  times.prepare += watch.lap();
  return band;
}

}  // namespace ssdo
