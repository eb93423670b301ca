// SPDX-License-Identifier: Apache-2.0
//
// A frame from its files to its outputs:
//
//   prepare_frame()   read -> scene -> plan
//   relight()         estimate -> filter
//   write_outputs()   compose -> colour -> write
//
// They are three calls, so that a sequence can write one frame and read another while it estimates
// a third. A frame that is larger than memory does the second and third for one band of rows after
// the other: relight/bands.h.
#include "relight/relight.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "error.h"
#include "estimators/registry.h"
#include "relight/bands.h"
#include "relight/frame_light.h"
#include "relight/frame_warnings.h"
#include "relight/known_geometry.h"
#include "relight/lamp_links.h"
#include "relight/plan_frame.h"
#include "relight/read_frame.h"
#include "relight/shadow_of.h"
#include "relight/targets.h"
#include "scene/objects/backdrop.h"
#include "scene/objects/selected_coverage.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

/// Objects that cast nothing take a method that looks for what is behind things.
void refuse_objects(const Frame& frame, const KnownGeometry& known, const FrameOptions& options) {
  const Selection* found = &frame.objects.shadow_of;
  for (const auto& [name, lamp] : frame.lamps)
    if (found->empty()) found = &lamp.cast;
  const Selection& which = found->empty() ? frame.objects.no_cast : *found;
  const auto refuse = [&](const std::string& why, const Selection& selection) {
    throw Error(ExitCode::usage, fmt::format("{}: {}: {}", frame.input, selection.option, why));
  };
  if (which.empty()) return;
  if (!find_method(options.model.method).supports.thickness)
    refuse(fmt::format("method {} casts with all that is seen; take bitmask or trace",
                       options.model.method),
           which);
  if (!known.deep.empty())
    refuse("deep samples do not say what they are of; leave the deep image out", which);
  if (!frame.objects.shadow_of.empty() && options.model.temporal)
    refuse("--temporal has no history of it; leave one of them out", frame.objects.shadow_of);
}

/// A backdrop that casts nothing.
struct BackdropOut {
  Plane<float> coverage;  ///< empty: there is none
  unsigned char of_other_eye =
      kBackdrop;  ///< the bits of OtherPicture::object_flags that it has there
};

/// The backdrop that is left out of what casts, with a warning.
BackdropOut find_backdrop(Frame& frame, const FrameOptions& options, bool may_leave_out) {
  const BackdropChoice choice = options.input.objects.backdrop;
  if (choice == BackdropChoice::ignore) return {};
  std::optional<Backdrop> found = find_backdrop(frame.scene.geometry);
  if (!found) return {};
  // In a shot, all frames that show its shape have one answer.
  const auto clearance =
      options.backdrop_of_shot ? options.backdrop_of_shot() : std::optional<double>();
  const bool is_far = clearance.value_or(found->clearance) >= 1,
             takes_any = choice == BackdropChoice::any;
  const std::string what =
      fmt::format("{:.2g} % of the frame show {}", 100 * found->share, found->what);
  if (!is_far && !takes_any) {
    frame.near_backdrop =
        what + ": it casts; where it stands for the sky, --backdrop any takes it out";
    return {{}, 0};
  }
  const bool leaves_out = choice != BackdropChoice::cast && may_leave_out;
  const std::string_view becomes = !leaves_out
                                       ? "hides the light behind it; take it out of the G-buffer"
                                   : is_far ? "casts nothing, unless --backdrop cast is given"
                                            : "casts nothing, as --backdrop any asks";
  frame.warn({fmt::format("{}: it {}", what, becomes)});
  if (!leaves_out) return {};
  frame.is_backdrop = std::move(found->has);
  return {std::move(found->coverage), kBackdrop | kNearBackdrop};
}

/// Whether another view shows a backdrop that is to cast nothing.
bool shows_backdrop(const std::vector<OtherView>& views, const ExcludedObjects& out) {
  return std::ranges::any_of(views, [&](const OtherView& view) {
    const unsigned char marks = out.marks_of(view) & (kBackdrop | kNearBackdrop);
    return std::ranges::any_of(view.picture->object_flags.pixels,
                               [&](unsigned char flags) { return flags & marks; });
  });
}

/// Finds the solids behind the surfaces, and takes what other views add.
void find_occluders(Frame& frame, KnownGeometry& known, const FrameOptions& options) {
  refuse_objects(frame, known, options);
  const bool sees_behind = find_method(options.model.method).supports.thickness;
  // Deep samples do not say what they are of.
  const bool may_leave_out = sees_behind && known.deep.empty();
  const auto [backdrop, of_other_eye] = find_backdrop(frame, options, may_leave_out);
  if (sees_behind) {
    SolidOptions solids{{}, options.input.gbuffer};
    if (options.model.thickness) solids.thickness = float(*options.model.thickness);
    const ObjectOptions& objects = frame.objects;
    const Surfaces& surfaces = frame.scene.geometry.surfaces;
    const auto coverage = [&](const Selection& selection) {
      if (selection.empty()) return Plane<float>(surfaces.width, surfaces.height, 0.0f);
      std::vector<std::string> warnings;
      Plane<float> found = selected_coverage(selection, frame.selections(warnings),
                                             frame.gbuffer.window, frame.gbuffer.grid);
      frame.warn(warnings);
      return found;
    };
    ExcludedObjects out{
        {}, backdrop, kNoCast | kBackdrop, static_cast<unsigned char>(kNoCast | of_other_eye)};
    const bool has_hole = !objects.no_cast.empty() || !backdrop.empty() ||
                          (may_leave_out && shows_backdrop(known.views, out));
    if (has_hole || !objects.shadow_of.empty()) out.coverage = coverage(objects.no_cast);
    if (!objects.shadow_of.empty()) {
      ExcludedObjects both{coverage(objects.shadow_of), backdrop,
                           static_cast<unsigned char>(out.marks | kShadowOf),
                           static_cast<unsigned char>(out.marks_of_other_eye | kShadowOf)};
      for (std::size_t i = 0; i < both.coverage.size(); ++i)
        both.coverage[i] = std::max(both.coverage[i], out.coverage[i]);
      KnownGeometry again = known;
      frame.scene.without = std::make_shared<Scene>();
      frame.scene.without->geometry = frame.scene.geometry;
      frame.scene.without->senders.albedo = frame.scene.senders.albedo;
      use_known_geometry(again, *frame.scene.without, solids.thickness, solids.reading, &both);
      find_linked_occluders(frame, known, both, solids, *frame.scene.without);
    }
    find_linked_occluders(frame, known, out, solids, frame.scene);
    frame.views = use_known_geometry(known, frame.scene, solids.thickness, solids.reading,
                                     has_hole ? &out : nullptr);
  }
  frame.warn(known.warnings);
  frame.losses_of_views = std::move(known.losses);
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

/// Warns of a lamp nearly all of whose light surfaces block: it stands in or behind them.
void warn_of_unlit(const Frame& frame, const std::string& lamp, double arrives,
                   std::vector<std::string>& lines) {
  const LampOfFrame& of = frame.lamps.at(lamp);
  for (const std::string& line : frame.warnings())
    if (line.starts_with(of.given_by + ": ")) return;
  lines.push_back(
      fmt::format("{}: {}: surfaces block {:.0f} % of its light from what the frame shows; {}",
                  of.given_by, of.is_local ? "position" : "direction", 100 * (1 - arrives),
                  of.is_local ? "move it out of them" : "turn it"));
}

}  // namespace

Frame prepare_frame(const FrameOptions& options, const Lighting& lighting, OtherPictures& pictures,
                    const FrameFiles& files, int number) {
  std::optional<DeepImage> own;
  FrameFiles with_links = files;
  with_links.links = links_of(lighting.lamps(), number);
  Frame frame = read_frame(options, with_links, int(lighting.lamps().size()), own);
  warn_of_encoded_colors(frame);
  Stopwatch watch;
  KnownGeometry known = read_known_geometry(frame, with_links, options, pictures, own);
  frame.times.known = watch.lap();
  light_frame(frame, lighting, options, files, number);
  frame.times.prepare += watch.lap();
  find_occluders(frame, known, options);
  (!files.also.empty() ? frame.times.known : frame.times.prepare) += watch.lap();
  plan_frame(frame, options, number, !known.deep.empty());
  frame.times.prepare += watch.lap();
  return frame;
}

namespace {

/// Takes from what was found what outputs are made of.
void take_products(Relit& relit) {
  Estimate& found = relit.found;
  relit.scene = std::move(found.scene);
  relit.products = std::move(found.products);
  relit.history = std::move(found.history);
  relit.error = found.error;
  relit.times.estimate = found.estimate_ms;
  relit.times.filter = found.filter_ms;
  found = {};
}

/// The shadow of objects in a frame of a shot is made of what this frame has found alone: the light
/// without the objects has the same noise and the same guesses, which the frames around do not
/// have.
void find_own_shadow(Scene& without, Relit& relit) {
  Relit own;
  own.plan = relit.plan;
  own.found = relit.found;
  light_products(own.found, own.plan);
  take_products(own);
  find_shadow(without, own);
  relit.found.estimate_ms = own.times.estimate;
  relit.found.filter_ms = own.times.filter;
  relit.products.lit = std::move(own.products.lit);
  relit.products.lit_without = std::move(own.products.lit_without);
}

}  // namespace

Relit relight(const RelightJob& job, Scene scene, const std::function<void(double)>& on_progress,
              const TemporalInput& temporal) {
  const Frame& frame = job.frame;
  Relit relit;
  // Before the estimate, so that a wrong name of an OpenColorIO view fails at once.
  relit.display = make_display(job);
  if (relit.display) {
    relit.notes.push_back(relit.display->description());
    if (!relit.display->warning().empty()) relit.warnings.push_back(relit.display->warning());
  }
  relit.plan = frame.plan;
  relit.times = frame.times;
  if (frame.bands) {
    relit.scene = std::move(scene);
    relit.written = relight_in_bands(job, on_progress, relit);
    return relit;
  }
  const std::shared_ptr<Scene> without = scene.without;
  relit.found = estimate(std::move(scene), frame.plan,
                         [&](double done) { on_progress(kEstimateShare * done); });
  relit.plan.request = relit.found.request;
  append(relit.notes, relit.found.notes);
  append(relit.warnings, relit.found.warnings);
  for (const auto& [name, share] : relit.found.unlit)
    warn_of_unlit(frame, name, share, relit.warnings);
  const bool has_shadow = contains(relit.plan.make, "shadow_of");
  if (frame.plan.shot) {
    // A frame without outputs is there for what others of its shot want of it.
    if (has_shadow && !job.targets.empty()) find_own_shadow(*without, relit);
    return relit;
  }
  light_products(relit.found, frame.plan, temporal);
  take_products(relit);
  if (has_shadow) find_shadow(*without, relit);
  return relit;
}

Findings take_findings(Relit& relit) {
  const Scene& scene = relit.found.scene;
  return take_findings(relit.found.products, scene.geometry, scene.senders.radiance);
}

void relight_in_shot(Fusion& fusion, Relit& relit) {
  Stopwatch watch;
  fusion.finish(relit.found.scene.geometry, relit.found.products);
  relit.found.filter_ms += watch.lap();
  light_products(relit.found, relit.plan);
  Plane<glm::vec3> lit = std::move(relit.products.lit),
                   lit_without = std::move(relit.products.lit_without);
  take_products(relit);
  relit.products.lit = std::move(lit);
  relit.products.lit_without = std::move(lit_without);
}

void write_outputs(const std::vector<RelitFrame>& views,
                   const std::function<void(double)>& on_progress) {
  Relit& relit = *views.front().relit;
  if (views.front().job.frame.bands) {
    Stopwatch watch;
    commit_all(relit.written);
    relit.times.write += watch.lap();
    return;
  }
  std::vector<ViewOutput> shown;
  for (const auto& [job, of_view] : views) {
    const auto& display = of_view->display;
    shown.push_back(
        {job, of_view->scene, of_view->plan, of_view->products, display ? &*display : nullptr});
  }
  const Written written = write_targets(
      shown, [&](double done) { on_progress(kEstimateShare + (1 - kEstimateShare) * done); });
  relit.clamped_values = written.clamped_values;
  Stopwatch watch;
  commit_all(written.files);
  relit.times.compose = written.compose_ms;
  relit.times.write = written.write_ms + watch.lap();
}

}  // namespace ssdo
