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
#include "plan/composite_choice.h"
#include "plan/explain.h"
#include "plan/make_plan.h"
#include "relight/bands.h"
#include "relight/frame_light.h"
#include "relight/frame_warnings.h"
#include "relight/known_geometry.h"
#include "relight/targets.h"
#include "scene/layers/windows.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

bool wants_reflection(const OutputOptions& output, const std::vector<LayerRequest>& aovs) {
  const auto is_reflection = [](const SaveRequest& save) { return save.product == "reflection"; };
  const auto is_specular = [](const LayerRequest& aov) { return aov.role == Role::specular; };
  return contains(output.products, "reflection") || contains(output.products, kAllProducts) ||
         std::ranges::any_of(output.saves, is_reflection) ||
         (choose_compose(output, aovs) == Compose::occlude &&
          std::ranges::any_of(aovs, is_specular));
}

/// Names that nothing asks for are no reason to refuse a frame.
std::vector<Role> unused_roles(const FrameOptions& options, const FrameFiles& files) {
  std::vector<Role> unused;
  if (!wants_reflection(options.output, files.aovs)) unused.push_back(Role::roughness);
  if (!options.model.temporal) unused.push_back(Role::motion);
  return unused;
}

/// Layers, G-buffer, camera and geometry of a frame. The samples of a deep file that it is read
/// from are in `own`.
Frame read_frame(const FrameOptions& options, const FrameFiles& files,
                 std::optional<DeepImage>& own) {
  Stopwatch watch;
  std::deque<ExrReader> opened = open_view(files.input, files.aovs, options.input.allow_partial);
  const double opening = watch.lap();
  InputOptions input = for_view(options.input, files);
  input.gbuffer.downsample = options.output.downsample;
  input.gbuffer.beauty = choose_compose(options.output, files.aovs) != Compose::relight;
  input.gbuffer.most_pixels = most_pixels_in(options.memory);
  View view =
      read_view(std::move(opened), files.aovs, input, options.camera, unused_roles(options, files));
  if (view.geometry.camera.panorama) {
    throw Error(ExitCode::layer,
                fmt::format("{}: is a lat-long panorama, which shows no frame; give it with --also "
                            "to a frame of the same scene",
                            files.input));
  }
  Frame frame;
  frame.input = files.input;
  frame.view = files.view;
  frame.files = std::move(view.files);
  frame.layers = std::move(view.layers);
  frame.gbuffer = std::move(view.gbuffer);
  frame.report = std::move(view.report);
  frame.scene = take_scene(frame.gbuffer, std::move(view.geometry));
  own = std::move(view.deep);
  frame.times.read = opening + view.read_ms;
  frame.times.prepare = watch.lap() - view.read_ms;
  return frame;
}

/// Finds the solids behind the surfaces, and takes what further views add.
void find_occluders(Frame& frame, KnownGeometry& known, const FrameOptions& options) {
  if (find_method(options.model.method).takes.thickness) {
    std::optional<float> thickness;
    if (options.model.thickness) thickness = float(*options.model.thickness);
    frame.views = use_known_geometry(known, frame.scene, thickness, options.input.gbuffer);
  }
  frame.warn(known.warnings);
  frame.further_losses = std::move(known.losses);
}

/// Bands have the rows of the frame.
void check_bands(const Frame& frame) {
  const bool composites = frame.plan.composition.compose != Compose::relight;
  if (window_of_outputs(frame.readers(), frame.layers, composites, {}) == frame.gbuffer.file_window)
    return;
  throw Error(ExitCode::usage,
              fmt::format("{}: a rendered layer reaches beyond the display window, where the data "
                          "window of P ends, and takes all of the frame at once: render P with the "
                          "same overscan, or raise --mem-limit",
                          frame.input));
}

/// Decides what is computed, and says why.
void plan_frame(Frame& frame, const KnownGeometry& known, const FrameOptions& options, int number) {
  ModelOptions model = options.model;
  if (model.temporal) model.seed += unsigned(number);
  frame.plan = make_plan(model, options.output, frame.scene, frame.gbuffer, frame.input);
  if (frame.gbuffer.grid.is_coarse()) {
    check_bands(frame);
    const Window& all = frame.gbuffer.file_window;
    frame.bands = plan_bands(frame.input, all, frame.part().display_window, frame.scene, frame.plan,
                             options.output, options.memory);
    frame.plan.reasons.push_back(describe(*frame.bands, all));
  }
  warn_of_plan(frame, options, !known.deep.empty());
  explain_earlier_products(frame);
  explain_views(frame.plan, frame.views);
  frame.advice = explain_guessed(frame.plan, frame.scene);
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

}  // namespace

Frame prepare_frame(const FrameOptions& options, const Lighting& lighting,
                    FurtherPictures& pictures, const FrameFiles& files, int number) {
  std::optional<DeepImage> own;
  Frame frame = read_frame(options, files, own);
  warn_of_encoded_colors(frame);
  Stopwatch watch;
  KnownGeometry known = read_known_geometry(frame, files, options, pictures, own);
  frame.times.known = watch.lap();
  light_frame(frame, lighting, options);
  frame.times.prepare += watch.lap();
  find_occluders(frame, known, options);
  const bool is_known = !files.also.empty() || !files.neighbours.empty();
  (is_known ? frame.times.known : frame.times.prepare) += watch.lap();
  plan_frame(frame, known, options, number);
  frame.times.prepare += watch.lap();
  return frame;
}

Relit relight(const RelightJob& job, Scene scene, const std::function<void(double)>& on_progress,
              const Past& past) {
  const Frame& frame = job.frame;
  Relit relit;
  // Made first: a view that does not exist costs no estimate.
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
  Estimate found = estimate(
      std::move(scene), frame.plan, [&](double done) { on_progress(kEstimateShare * done); }, past);
  relit.scene = std::move(found.scene);
  relit.plan.request = std::move(found.request);
  relit.products = std::move(found.products);
  relit.history = std::move(found.history);
  relit.error = found.error;
  append(relit.notes, found.notes);
  append(relit.warnings, found.warnings);
  relit.times.estimate = found.estimate_ms;
  relit.times.filter = found.filter_ms;
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
