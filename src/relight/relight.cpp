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
#include "relight/plan_frame.h"
#include "relight/read_frame.h"
#include "relight/targets.h"
#include "scene/objects/selected_coverage.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

/// Objects that cast nothing take all of the frame at once, and a method that looks for what is
/// behind things.
void refuse_objects(const Frame& frame, const KnownGeometry& known, const FrameOptions& options) {
  const Selection& which =
      frame.objects.no_cast.empty() ? frame.objects.shadow_of : frame.objects.no_cast;
  const auto refuse = [&](const std::string& why) {
    throw Error(ExitCode::usage, fmt::format("{}: {}: {}", frame.input, which.option, why));
  };
  if (which.empty()) return;
  if (!find_method(options.model.method).takes.thickness)
    refuse(fmt::format("method {} casts with all that is seen; take bitmask or trace",
                       options.model.method));
  if (frame.gbuffer.grid.is_coarse())
    refuse("takes all of the frame at once, which --mem-limit does not allow: raise it");
  if (!known.deep.empty())
    refuse("deep samples do not say what they are of; leave the deep image out");
  if (!frame.objects.shadow_of.empty() && options.model.temporal)
    refuse("--temporal has no history of it; leave one of them out");
}

/// Finds the solids behind the surfaces, and takes what other views add.
void find_occluders(Frame& frame, KnownGeometry& known, const FrameOptions& options) {
  refuse_objects(frame, known, options);
  if (find_method(options.model.method).takes.thickness) {
    std::optional<float> thickness;
    if (options.model.thickness) thickness = float(*options.model.thickness);
    const ObjectOptions& objects = frame.objects;
    const auto coverage = [&](const Selection& selection) {
      return selected_coverage(selection, {frame.files, frame.view}, frame.gbuffer.window,
                               frame.gbuffer.grid);
    };
    Plane<float> out;
    if (!objects.no_cast.empty()) out = coverage(objects.no_cast);
    if (!objects.shadow_of.empty()) {
      Plane<float> more = coverage(objects.shadow_of);
      for (std::size_t i = 0; i < out.size(); ++i) more[i] = std::max(more[i], out[i]);
      KnownGeometry again = known;
      frame.scene.without = std::make_shared<Scene>();
      frame.scene.without->geometry = frame.scene.geometry;
      frame.scene.without->senders.albedo = frame.scene.senders.albedo;
      const TakenOut both{more, kNoCast | kShadowOf};
      use_known_geometry(again, *frame.scene.without, thickness, options.input.gbuffer, &both);
    }
    const TakenOut one{out, kNoCast};
    frame.views = use_known_geometry(known, frame.scene, thickness, options.input.gbuffer,
                                     out.empty() ? nullptr : &one);
  }
  frame.warn(known.warnings);
  frame.losses_of_views = std::move(known.losses);
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

/// A lamp that stands in or behind surfaces, which only the rays to it tell in full.
void warn_of_unlit(const Frame& frame, const std::string& lamp, double arrives,
                   std::vector<std::string>& lines) {
  const auto& [origin, is_near] = frame.lamps.at(lamp);
  for (const std::string& line : frame.warnings())
    if (line.starts_with(origin + ": ")) return;
  lines.push_back(
      fmt::format("{}: {}: surfaces block {:.0f} % of its light from what the frame shows; {}",
                  origin, is_near ? "position" : "direction", 100 * (1 - arrives),
                  is_near ? "move it out of them" : "turn it"));
}

}  // namespace

Frame prepare_frame(const FrameOptions& options, const Lighting& lighting, OtherPictures& pictures,
                    const FrameFiles& files, int number) {
  std::optional<DeepImage> own;
  Frame frame = read_frame(options, files, int(lighting.lamps().size()), own);
  warn_of_encoded_colors(frame);
  Stopwatch watch;
  KnownGeometry known = read_known_geometry(frame, files, options, pictures, own);
  frame.times.known = watch.lap();
  light_frame(frame, lighting, options, files);
  frame.times.prepare += watch.lap();
  find_occluders(frame, known, options);
  const bool is_known = !files.also.empty() || !files.neighbours.empty();
  (is_known ? frame.times.known : frame.times.prepare) += watch.lap();
  plan_frame(frame, options, number, !known.deep.empty());
  frame.times.prepare += watch.lap();
  return frame;
}

namespace {

/// direct + bounce.
Plane<glm::vec3> light_of(const Products& found) {
  Plane<glm::vec3> light = found.direct;
  for (std::size_t i = 0; i < light.size() && !found.bounce.empty(); ++i)
    light[i] += found.bounce[i];
  return light;
}

/// Estimates the light without the objects of --shadow-of, as the one with them was: noise that
/// both have in common is none of their shadow.
void find_shadow(Scene& without, Relit& relit) {
  without.light = relit.scene.light;
  without.senders = relit.scene.senders;
  without.roughness = relit.scene.roughness;
  without.specular_color = relit.scene.specular_color;
  const Plane<int> sender = without.casting->sender;
  Plan plan = relit.plan;
  plan.error.reset();
  plan.request.products = {.direct = true, .bounce = plan.request.products.bounce};
  plan.request.by_light = {};
  Estimate found = estimate(std::move(without), plan, [](double) {}, {});
  relit.times.estimate += found.estimate_ms;
  relit.times.filter += found.filter_ms;
  relit.products.lit = light_of(relit.products);
  relit.products.lit_without = light_of(found.products);
  for (Plane<glm::vec3>* light : {&relit.products.lit, &relit.products.lit_without}) {
    const Plane<glm::vec3> all = *light;
    for (std::size_t i = 0; i < sender.size(); ++i)
      if (sender[i] >= 0) (*light)[i] = all[std::size_t(sender[i])];
  }
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
  Estimate found = estimate(
      std::move(scene), frame.plan, [&](double done) { on_progress(kEstimateShare * done); },
      temporal);
  relit.scene = std::move(found.scene);
  relit.plan.request = std::move(found.request);
  relit.products = std::move(found.products);
  relit.history = std::move(found.history);
  relit.error = found.error;
  relit.times.estimate = found.estimate_ms;
  relit.times.filter = found.filter_ms;
  append(relit.notes, found.notes);
  append(relit.warnings, found.warnings);
  for (const auto& [name, share] : found.unlit) warn_of_unlit(frame, name, share, relit.warnings);
  if (contains(relit.plan.make, "shadow_of")) find_shadow(*without, relit);
  return relit;
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
  std::vector<Shown> shown;
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
