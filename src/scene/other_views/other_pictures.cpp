// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/other_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "error.h"
#include "parallel/planes.h"
#include "parallel/tiles.h"
#include "scene/deep/channels.h"
#include "scene/objects/backdrop.h"
#include "scene/objects/read_object_masks.h"
#include "scene/other_views/covered_pixels.h"

namespace ssdo {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// The largest median distance by which P may miss its pixel. Above it, P is of another camera than
/// a pinhole or a panorama, or filtered beyond use.
constexpr double kMostMissPx = 0.5;

/// Layers that no other picture needs.
const std::vector<Role> kUnused = {Role::motion,  Role::roughness,     Role::radiance,
                                   Role::ambient, Role::specular,      Role::light,
                                   Role::beauty,  Role::specular_color};

/// How a file is read.
constexpr std::string_view kByNames = "--also", kAsInput = "INPUT";

/// A file, with the view that is read of it.
std::string name_of(const FrameFiles& frame) {
  return frame.view.empty() ? frame.input : fmt::format("{} ({})", frame.input, frame.view);
}

void check(const View& view, const std::string& file) {
  if (!view.layers[Role::position]) {
    throw Error(ExitCode::layer,
                fmt::format("{}: has no position; another view needs P in world space", file));
  }
  const Geometry& g = view.geometry;
  if (g.median_depth > 0 && !g.world_known) {
    throw Error(ExitCode::layer, fmt::format("{}: P is in camera space; another view needs P in "
                                             "world space, as the frame's is",
                                             file));
  }
  if (view.report.residual && view.report.residual->median_px > kMostMissPx) {
    throw Error(ExitCode::layer,
                fmt::format("{}: neither a pinhole camera nor a lat-long panorama shows P where it "
                            "stands (half of it misses its pixel by {:.2g} px or more); render one "
                            "of these",
                            file, view.report.residual->median_px));
  }
}

/// Marks the pixels of a picture that a selection covers, if the picture knows the selection. A
/// matte of the frame says nothing about another picture.
void mark(OtherPicture& picture, const Selection& selection, unsigned char with,
          const SelectionFiles& in) {
  if (selection.empty()) return;
  try {
    const Plane<float> coverage = selected_coverage(selection, in, picture.window, {});
    if (picture.object_flags.empty())
      picture.object_flags = Plane<unsigned char>(coverage.width, coverage.height, 0);
    for (std::size_t i = 0; i < coverage.size(); ++i)
      if (coverage[i] > 0) picture.object_flags[i] |= with;
  } catch (const Error& error) {
    picture.not_taken.push_back(fmt::format("{}: shows what {} takes out: {}", picture.file,
                                            selection.option, error.what()));
  }
}

/// Finds what `selections` of lamps cover of a picture, as far as it tells: `find(coverage)` by
/// their texts. A warning says what the picture does not do for the others.
template <class T, class Find>
void mark_links(OtherPicture& picture, const std::vector<Selection>& selections,
                std::map<std::string, Plane<T>>& found, std::string_view otherwise,
                const SelectionFiles& in, const Find& find) {
  for (const Selection& selection : selections) {
    if (found.contains(selection.text)) continue;
    try {
      found[selection.text] = find(selected_coverage(selection, in, picture.window, {}));
    } catch (const Error& error) {
      picture.not_taken.push_back(
          fmt::format("{}: {} of this lamp: {}", picture.file, otherwise, error.what()));
    }
  }
}

/// Finds what blocks the light of linked lamps, and what they light.
void mark_links(OtherPicture& picture, const LampLinks& links, const SelectionFiles& in) {
  mark_links(picture, links.cast, picture.casts, "blocks no light", in,
             [&](const Plane<float>& coverage) {
               return covered_pixels(picture.surfaces, picture.camera, coverage);
             });
  mark_links(picture, links.receive, picture.receives, "takes no light", in,
             [](Plane<float> coverage) { return coverage; });
}

void mark_backdrop(OtherPicture& picture, const Geometry& geometry, BackdropChoice choice) {
  const bool takes_any = choice == BackdropChoice::any;
  if (!takes_any && choice != BackdropChoice::leave_out) return;
  const std::optional<Backdrop> found = find_backdrop(geometry);
  if (!found) return;
  picture.object_flags = Plane<unsigned char>(found->coverage.width, found->coverage.height, 0);
  for (std::size_t i = 0; i < found->coverage.size(); ++i)
    if (found->coverage[i] > 0)
      picture.object_flags[i] = takes_any || found->is_far() ? kBackdrop : kNearBackdrop;
}

/// What is to be found in a picture.
struct Objects {
  const ObjectOptions& options;
  const LampLinks& links;
};

/// Keeps of a view what other pictures need.
OtherPictures::Picture picture_of(View view, const std::string& file, const std::string& eye,
                                  const Objects& objects) {
  check(view, file);
  OtherPicture out;
  out.file = file;
  out.camera = view.geometry.camera;
  out.window = view.geometry.window;
  out.closed = out.camera.panorama && out.window.width() == view.geometry.display.width();
  mark_backdrop(out, view.geometry, objects.options.backdrop);
  out.surfaces = std::move(view.geometry.surfaces);
  out.depth = Plane<float>(out.surfaces.width, out.surfaces.height, kNothing);
  for_each_row(out.surfaces.height, [&](int y) {
    for (int x = 0; x < out.surfaces.width; ++x) {
      const Surfel& s = out.surfaces(x, y);
      if (s.is_surface()) out.depth(x, y) = float(out.camera.depth_of(glm::dvec3(s.position)));
    }
  });
  out.albedo = in_half(view.gbuffer.albedo);
  mark(out, objects.options.no_cast, kNoCast, {view.files, eye});
  mark(out, objects.options.shadow_of, kShadowOf, {view.files, eye});
  mark_links(out, objects.links, {view.files, eye});
  for (const auto* warnings : {&view.gbuffer.warnings, &view.report.warnings}) {
    for (const std::string& warning : *warnings)
      out.warnings.push_back(fmt::format("{}: {}", file, warning));
  }
  for (const ExrReader& read : view.files)
    for (const std::string& line : read.losses()) out.losses.push_back(line);
  return std::make_shared<const OtherPicture>(std::move(out));
}

}  // namespace

std::vector<OtherPictures::Key> OtherPictures::keys_of(const FrameFiles& frame) {
  std::vector<Key> keys;
  for (const std::string& file : frame.also) keys.emplace_back(kByNames, file);
  if (!frame.view.empty()) keys.emplace_back(kAsInput, name_of(other_eye(frame)));
  return keys;
}

void OtherPictures::expect(const FrameFiles& frame) {
  const std::lock_guard lock(mutex_);
  for (const Key& key : keys_of(frame)) ++entries_[key].frames;
}

void OtherPictures::release(const FrameFiles& frame) {
  const std::lock_guard lock(mutex_);
  for (const Key& key : keys_of(frame)) {
    const auto entry = entries_.find(key);
    if (entry != entries_.end() && --entry->second.frames == 0) entries_.erase(entry);
  }
}

OtherPictures::Picture OtherPictures::also(const std::string& file, const LampLinks& links) {
  return get({kByNames, file}, [&]() -> Picture {
    std::deque<ExrReader> opened = open_view(file, {}, allow_partial_);
    if (has_deep_part(opened.front())) return nullptr;
    return picture_of(read_view(std::move(opened), {}, {}, {}, kUnused), file, "",
                      {objects_, links});
  });
}

OtherPictures::Picture OtherPictures::alike(const FrameFiles& frame, const InputOptions& input,
                                            const CameraOptions& camera) {
  return get({kAsInput, name_of(frame)}, [&] {
    std::vector<LayerRequest> aovs = frame.aovs;
    std::erase_if(aovs, [](const LayerRequest& request) {
      return std::find(kUnused.begin(), kUnused.end(), request.role) != kUnused.end();
    });
    View view = read_view(open_view(frame.input, aovs, input.allow_partial), aovs,
                          for_view(input, frame), camera, kUnused);
    open_mattes(frame.objects, view.files, input.allow_partial);
    for (const auto* linked : {&frame.links.cast, &frame.links.receive})
      for (const Selection& each : *linked) open_mattes(each, view.files, input.allow_partial);
    return picture_of(std::move(view), name_of(frame), frame.view, {frame.objects, frame.links});
  });
}

OtherPictures::Picture OtherPictures::get(const Key& key, const std::function<Picture()>& read) {
  std::promise<Picture> promise;
  std::shared_future<Picture> picture;
  bool is_first = false;
  {
    const std::lock_guard lock(mutex_);
    std::shared_future<Picture>& known = entries_[key].picture;
    is_first = !known.valid();
    if (is_first) known = promise.get_future().share();
    picture = known;
  }
  // Outside of the lock: other files can be read meanwhile.
  if (is_first) {
    try {
      promise.set_value(read());
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  }
  return picture.get();
}

}  // namespace ssdo
