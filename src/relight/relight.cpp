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

#include <utility>

#include "estimators/registry.h"
#include "relight/bands.h"
#include "relight/frame_light.h"
#include "relight/frame_warnings.h"
#include "relight/known_geometry.h"
#include "relight/plan_frame.h"
#include "relight/read_frame.h"
#include "relight/targets.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

/// Finds the solids behind the surfaces, and takes what other views add.
void find_occluders(Frame& frame, KnownGeometry& known, const FrameOptions& options) {
  if (find_method(options.model.method).takes.thickness) {
    std::optional<float> thickness;
    if (options.model.thickness) thickness = float(*options.model.thickness);
    frame.views = use_known_geometry(known, frame.scene, thickness, options.input.gbuffer);
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
  Estimate found = estimate(
      std::move(scene), frame.plan, [&](double done) { on_progress(kEstimateShare * done); },
      temporal);
  relit.scene = std::move(found.scene);
  relit.plan.request = std::move(found.request);
  relit.products = std::move(found.products);
  relit.history = std::move(found.history);
  relit.error = found.error;
  append(relit.notes, found.notes);
  append(relit.warnings, found.warnings);
  for (const auto& [name, share] : found.unlit) warn_of_unlit(frame, name, share, relit.warnings);
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
