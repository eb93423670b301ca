// SPDX-License-Identifier: Apache-2.0
#include "relight/known_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "error.h"
#include "scene/deep/channels.h"
#include "scene/deep/deep_frame.h"
#include "scene/deep/join_measured.h"
#include "scene/deep/measured_solids.h"
#include "scene/other_views/back_faces.h"
#include "scene/other_views/carve.h"
#include "scene/other_views/registration.h"
#include "scene/other_views/remove_objects.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

/// The samples of a deep file. Those of several views show the frame's.
DeepImage read_deep_image(const ExrReader& file, const std::string& view,
                          const GBufferOptions& options, std::vector<std::string>& warnings) {
  auto channels = view.empty() ? std::nullopt : find_deep_channels(file, view);
  if (!channels) channels = find_deep_channels(file, "");
  if (!channels) {  // an earlier frame has found them
    throw Error(ExitCode::input, fmt::format("{}: was a deep image and is none any more; leave the "
                                             "files of --also alone while they are read",
                                             file.path().string()));
  }
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
std::vector<MergeCounts> use_back_faces(std::vector<OtherView>& views, Scene& scene) {
  std::vector<MergeCounts> counts;
  std::vector<OtherView> others;
  std::vector<Plane<float>> distances;
  for (OtherView& view : views) {
    auto found = find_back_faces(view, scene.casters());
    if (!found) {
      others.push_back(std::move(view));
      continue;
    }
    counts.push_back({.file = view.picture->file, .backs = count_back_faces(*found)});
    distances.push_back(std::move(*found));
  }
  views = std::move(others);
  end_at_back_faces(scene.solids, distances);
  return counts;
}

/// Moves the views of back faces out of `views`.
std::vector<OtherView> split_back_faces(std::vector<OtherView>& views, const Geometry& frame) {
  const auto first = std::stable_partition(views.begin(), views.end(), [&](const OtherView& view) {
    return !find_back_faces(view, frame);
  });
  std::vector<OtherView> backs(std::make_move_iterator(first),
                               std::make_move_iterator(views.end()));
  views.erase(first, views.end());
  return backs;
}

/// Leaves out the views that don't fit the frame, or changes them so that they do. Views of back
/// faces show nothing that the frame shows, and stay.
void register_views(KnownGeometry& known, const Geometry& frame, bool may_be_backs = false) {
  std::vector<OtherView> fitting;
  for (OtherView& view : known.views) {
    if (view.is_other_eye || (may_be_backs && find_back_faces(view, frame))) {
      fitting.push_back(std::move(view));
      continue;
    }
    Registration found = register_view(std::move(view), frame);
    if (found.view) fitting.push_back(std::move(*found.view));
    if (!found.warning.empty()) known.warnings.push_back(std::move(found.warning));
  }
  known.views = std::move(fitting);
}

/// Largest share of the surfaces seen by both a view and the frame that may contradict each other.
/// More means that things have moved, or that the view shows another scene on the same ground.
/// Views of one still scene reach 4 % where leaves are finer than their pixels.
constexpr double kMostContradiction = 0.1;

void warn_of(const MergeCounts& view, std::vector<std::string>& warnings) {
  if (view.is_other_eye) {
    if (!view.is_of_another_scene()) return;
    warnings.push_back(fmt::format(
        "{}: left out: of {} pixels, {} show what the frame shows too, and {} lie before "
        "it, as in another scene or unit",
        view.file, view.added + view.in_common(), view.seen, view.contradictory));
    return;
  }
  if (double(view.contradictory) <= kMostContradiction * double(view.in_common())) return;
  warnings.push_back(
      fmt::format("{}: {:.0f} % of what the frame should see too lies before what it shows, and is "
                  "left out; is this the same scene, at the same time?",
                  view.file, 100.0 * double(view.contradictory) / double(view.in_common())));
}

/// Leaves out of a view what is marked, and what a lamp does not name.
void remove_objects(OtherView& view, const ExcludedObjects& out) {
  const Plane<unsigned char>& object_flags = view.picture->object_flags;
  const bool is_of_lamp = !out.cast.empty();
  if (object_flags.empty() && !is_of_lamp) return;
  const auto cast = view.picture->casts.find(out.cast);
  const bool names_any = cast != view.picture->casts.end();
  const unsigned char marks = out.marks_of(view);
  OtherPicture picture = *view.picture;
  for (std::size_t i = 0; i < picture.surfaces.size(); ++i) {
    const bool is_marked = !object_flags.empty() && (object_flags[i] & marks) != 0,
               is_named = !is_of_lamp || (names_any && cast->second[i] != 0);
    if (!is_marked && is_named) continue;
    // Its depth stays: up to there nothing is in the way, and what is behind it is not known.
    picture.surfaces.set(i, {glm::vec3(0), glm::vec3(0), Surfel::kBroken});
  }
  view.picture = std::make_shared<const OtherPicture>(std::move(picture));
}

/// Reads the views of one frame.
class ViewReader {
 public:
  ViewReader(const Frame& frame, const FrameOptions& options, OtherPictures& pictures,
             KnownGeometry& known)
      : frame_(frame), options_(options), pictures_(pictures), known_(known) {}

  void add_also(const std::string& path, const LampLinks& links) {
    const OtherPictures::Picture picture = pictures_.also(path, links);
    if (!picture) {
      const ExrReader file(path, options_.input.allow_partial ? Salvage::done : Salvage::offered);
      known_.deep.push_back(
          read_deep_image(file, frame_.part().view, options_.input.gbuffer, known_.warnings));
      for (const std::string& line : file.losses()) known_.losses.push_back(line);
      return;
    }
    if (!knows_place("--also " + path)) return;
    add(place(picture, frame_.scene.geometry));
    for (const auto* lines : {&picture->warnings, &picture->not_taken})
      known_.warnings.insert(known_.warnings.end(), lines->begin(), lines->end());
  }

  /// No option asks for the other eye: where it is of no use, it is left out.
  void add_other_eye(const FrameFiles& files) {
    const Geometry& geometry = frame_.scene.geometry;
    if (geometry.median_depth <= 0 || frame_.gbuffer.grid.is_coarse()) return;
    if (!geometry.world_known) {
      known_.warnings.push_back(
          "the other eye shows nothing more: no world space is known to place "
          "it in; render P in world space");
      return;
    }
    CameraOptions camera = options_.camera;
    camera.file.clear();  // has the pose of one eye
    add_alike(other_eye(files), camera, "the other eye");
  }

 private:
  /// Adds a view without the warnings of reading it, which are those of the frame. The picture is
  /// kept for other frames: nothing that this frame takes from its shot may decide how it is read.
  void add_alike(const FrameFiles& files, CameraOptions camera, std::string_view role) {
    camera.shot = {};
    try {
      OtherView view = place(pictures_.alike(files, options_.input, camera), frame_.scene.geometry);
      const std::vector<std::string>& kept = view.picture->not_taken;
      known_.warnings.insert(known_.warnings.end(), kept.begin(), kept.end());
      view.is_other_eye = true;
      add(std::move(view));
    } catch (const Error& e) {
      known_.warnings.push_back(fmt::format("left out as {}: {}", role, e.what()));
    }
  }

  void add(OtherView view) {
    const std::vector<std::string>& losses = view.picture->losses;
    known_.losses.insert(known_.losses.end(), losses.begin(), losses.end());
    known_.views.push_back(std::move(view));
  }

  /// False for a frame without surfaces, to which no view can add anything.
  bool knows_place(const std::string& option) const {
    const Geometry& geometry = frame_.scene.geometry;
    if (geometry.world_known || geometry.median_depth <= 0) return geometry.world_known;
    throw Error(ExitCode::layer,
                fmt::format("{}: knows no world space to place {} in; render P in "
                            "world space, or give --camera FILE.json with its pose",
                            frame_.input, option));
  }

  const Frame& frame_;
  const FrameOptions& options_;
  OtherPictures& pictures_;
  KnownGeometry& known_;
};

}  // namespace

KnownGeometry read_known_geometry(const Frame& frame, const FrameFiles& files,
                                  const FrameOptions& options, OtherPictures& pictures,
                                  const std::optional<DeepImage>& own) {
  KnownGeometry known;
  ViewReader reader(frame, options, pictures, known);
  for (const std::string& path : files.also) reader.add_also(path, files.links);
  const bool uses_views = find_method(options.model.method).supports.thickness;
  if (uses_views && !files.view.empty()) reader.add_other_eye(files);
  if (own) known.deep.push_back(*own);
  return known;
}

std::vector<MergeCounts> use_known_geometry(KnownGeometry& known, Scene& scene,
                                            std::optional<float> thickness,
                                            const GBufferOptions& reading,
                                            const ExcludedObjects* excluded) {
  std::vector<OtherView> backs;  // those of back faces, where something is taken out: they show
                                 // nothing that could stand in its place
  if (excluded) {
    register_views(known, scene.geometry, true);
    backs = split_back_faces(known.views, scene.geometry);
    for (std::vector<OtherView>* const views : {&known.views, &backs})
      for (OtherView& view : *views) remove_objects(view, *excluded);
    scene.caster_surfaces =
        remove_objects(scene.geometry, excluded->coverage, excluded->backdrop, known.views);
  }
  const Geometry& casters = scene.casters();
  scene.solids = find_solids(casters, known.deep, thickness, reading, known.warnings);
  std::vector<MergeCounts> of_backs = use_back_faces(excluded ? backs : known.views, scene), counts;
  if (!excluded) register_views(known, scene.geometry);
  if (known.views.empty()) return of_backs;
  scene.other_surfaces = merge_views(known.views, casters, scene.senders.albedo, counts);
  std::vector<OtherView> of_scene;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    warn_of(counts[i], known.warnings);
    if (!counts[i].is_of_another_scene()) of_scene.push_back(known.views[i]);
  }
  std::erase_if(counts, [](const MergeCounts& view) { return view.is_of_another_scene(); });
  if (!thickness) carve(scene.solids, casters, of_scene);
  scene.views = std::move(of_scene);
  counts.insert(counts.end(), of_backs.begin(), of_backs.end());
  return counts;
}

}  // namespace ssdo
