// SPDX-License-Identifier: Apache-2.0
#include "known_geometry.h"

#include <fmt/format.h>

#include <utility>

#include "error.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/deep/join_measured.h"
#include "scene/deep/measured_solids.h"
#include "scene/further/back_faces.h"
#include "scene/further/carve.h"

namespace ssdo {
namespace {

/// The samples of a deep file. Those of several views show the frame's.
DeepImage read_deep_image(const ExrReader& file, const std::string& view,
                          const GBufferOptions& options, std::vector<std::string>& warnings) {
  auto channels = view.empty() ? std::nullopt : find_deep_channels(file, view);
  if (!channels) channels = find_deep_channels(file, "");
  return read_deep_frame(file, *channels, options, warnings);
}

/// The solids of a frame, measured where deep images show them and guessed elsewhere.
Solids find_solids(const Geometry& geometry, const std::vector<DeepImage>& images,
                   std::optional<float> thickness, const GBufferOptions& reading,
                   std::vector<std::string>& warnings) {
  if (images.empty())
    return thickness ? constant_thickness(geometry, *thickness) : guess_solids(geometry);
  DeepDepths depths{std::nullopt, farthest_sample(reading)};
  if (reading.depth_kind)
    depths.kind = *reading.depth_kind == DepthKind::ray ? DepthKind::ray : DepthKind::planar;
  return join_measured(geometry, measure_solids(geometry, images, depths, warnings), thickness);
}

/// Takes the views of back faces out of `views`: they tell how thick things are, and as surfaces
/// they would be seen from the inside.
std::vector<MergeCounts> use_back_faces(std::vector<FurtherView>& views, Scene& scene) {
  std::vector<MergeCounts> counts;
  std::vector<FurtherView> others;
  std::vector<Plane<float>> distances;
  for (FurtherView& view : views) {
    auto found = find_back_faces(view, scene.geometry);
    if (!found) {
      others.push_back(std::move(view));
      continue;
    }
    counts.push_back({view.file, false, 0, 0, 0, count_back_faces(*found)});
    distances.push_back(std::move(*found));
  }
  views = std::move(others);
  end_at_back_faces(scene.solids, distances);
  return counts;
}

/// Of what a view and the frame should both see: what differs by more has moved, or the view is of
/// another scene on the same ground. Views of one still scene reach 4 % where leaves are finer than
/// their pixels.
constexpr double kMostContradiction = 0.1;

void warn_of_contradictions(const std::vector<MergeCounts>& views,
                            std::vector<std::string>& warnings) {
  for (const MergeCounts& view : views) {
    const std::size_t common = view.seen + view.contradictory;
    if (double(view.contradictory) <= kMostContradiction * double(common)) continue;
    warnings.push_back(
        fmt::format("{}: {:.0f} % of what the frame should see too lies before what it shows, and "
                    "is left out; is this the same scene, at the same time?",
                    view.file, 100.0 * double(view.contradictory) / double(common)));
  }
}

}  // namespace

KnownGeometry read_known_geometry(const std::vector<std::string>& also,
                                  const std::optional<DeepImage>& own, const Geometry& frame,
                                  const std::string& input, const std::string& view,
                                  const InputOptions& options) {
  KnownGeometry known;
  for (const std::string& path : also) {
    const ExrReader file(path);
    if (has_deep_part(file)) {
      known.deep.push_back(read_deep_image(file, view, options.gbuffer, known.warnings));
      continue;
    }
    if (!frame.world_known) {
      throw Error(ExitCode::layer,
                  fmt::format("{}: knows no world space to place --also {} in; render P in world "
                              "space, or give --camera FILE.json with its pose",
                              input, path));
    }
    known.views.push_back(read_further_view(path, frame));
    const auto& warnings = known.views.back().warnings;
    known.warnings.insert(known.warnings.end(), warnings.begin(), warnings.end());
  }
  if (own) known.deep.push_back(*own);
  return known;
}

std::vector<MergeCounts> use_known_geometry(KnownGeometry& known, Scene& scene,
                                            std::optional<float> thickness,
                                            const GBufferOptions& reading) {
  scene.solids = find_solids(scene.geometry, known.deep, thickness, reading, known.warnings);
  std::vector<MergeCounts> of_backs = use_back_faces(known.views, scene), counts;
  if (known.views.empty()) return of_backs;
  scene.further = merge_views(known.views, scene.geometry, scene.senders.albedo, counts);
  warn_of_contradictions(counts, known.warnings);
  if (!thickness) carve(scene.solids, scene.geometry, known.views);
  counts.insert(counts.end(), of_backs.begin(), of_backs.end());
  return counts;
}

}  // namespace ssdo
