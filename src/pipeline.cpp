// SPDX-License-Identifier: Apache-2.0
#include "pipeline.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "bands.h"
#include "color/display_image.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/size_guard.h"
#include "scene/layers/groups.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

const std::string& product_of_picture(const Target& target, const Plan& plan) {
  return target.product ? *target.product : plan.show;
}

Results results_of(const Shown& view) {
  const Frame& frame = view.job.frame;
  return {frame.scene, frame.gbuffer, view.products, view.plan.composition};
}

/// The channels of the input that say where surfaces are and how they move.
std::vector<ChannelOfPart> geometry_channels(const Frame& frame) {
  std::vector<ChannelOfPart> channels;
  for (const Role role : {Role::position, Role::normal, Role::depth, Role::motion}) {
    const std::optional<Layer>& layer = frame.layers[role];
    if (!layer || layer->file != frame.lead().file) continue;
    for (const std::string& name : layer->channels) channels.push_back({layer->part, name});
  }
  return channels;
}

/// A line for each run of ssdo that the file has been through, where asked for.
std::string history_of(const Frame& frame, const std::string& made_by) {
  const std::string earlier = string_attribute(frame.part().header, "ssdo/history");
  return earlier.empty() ? made_by : earlier + "\n" + made_by;
}

/// What goes into the parts of a file: views that share a part stand side by side in it.
std::vector<ExrOutput> by_part(const std::vector<ExrContents>& views) {
  std::vector<ExrOutput> parts;
  for (const ExrContents& view : views) {
    const ExrOutput& own = view.output;
    const auto same = std::ranges::find(parts, own.part, &ExrOutput::part);
    if (same == parts.end()) {
      parts.push_back(own);
      continue;
    }
    same->planes.insert(same->planes.end(), own.planes.begin(), own.planes.end());
    same->geometry.insert(same->geometry.end(), own.geometry.begin(), own.geometry.end());
    same->attributes.insert(same->attributes.end(), own.attributes.begin(), own.attributes.end());
  }
  std::ranges::sort(parts, {}, &ExrOutput::part);
  return parts;
}

/// A picture shows the whole display window, however little of it there are pixels for.
void check_display_size(const Frame& frame) {
  const double factor = frame.gbuffer.downsampling.factor,
               values = 4 * double(frame.part().display_window.area()) / (factor * factor);
  check_decoded_size(frame.input, 0, 0, values * sizeof(float));
}

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

}  // namespace

std::optional<DisplayTransform> make_display(const RelightJob& job) {
  for (const Target& target : job.targets) {
    if (has_exr_ending(target.path) || !target.shows(job.frame.view)) continue;
    check_display_size(job.frame);
    load_image_codec();
    if (needs_display(product_of_picture(target, job.frame.plan)))
      return DisplayTransform(job.options.color, color_tags(job.frame));
  }
  return std::nullopt;
}

ExrContents exr_contents(const RelightJob& job, const Plan& plan, const Target& target,
                         const Results& results) {
  const Frame& frame = job.frame;
  ExrContents contents;
  for (const std::string& product : target.product ? std::vector{*target.product} : plan.write)
    contents.products.push_back(product_channels(product, results));
  ExrOutput& output = contents.output;
  output.input = &frame.files[std::size_t(frame.lead().file)];
  output.part = frame.lead().part;
  output.keep_channels = job.options.output.keep_channels;
  output.crop = job.options.output.crop;
  output.downsampling = frame.gbuffer.downsampling;
  output.geometry = geometry_channels(frame);
  output.compression = job.options.output.compression;
  output.compression_level = job.options.output.compression_level;
  const auto name = [&](const std::string& channel) {
    return frame.lead().file == 0
               ? in_view_of(*output.input, frame.part(), frame.lead().channels[0], channel)
               : channel;
  };
  output.attributes = {{"ssdo/version", SSDO_VERSION},
                       {"ssdo/" + name("plan"), json_text(to_json(plan, frame.history))}};
  if (!job.options.output.made_by.empty())
    output.attributes.emplace_back("ssdo/history", history_of(frame, job.options.output.made_by));
  for (const NamedChannels& product : contents.products) {
    for (const NamedChannel& channel : product.channels)
      output.planes.push_back({name(channel.name), job.options.output.pixel_type, channel.pixels});
  }
  return contents;
}

Written write_targets(const std::vector<Shown>& views,
                      const std::function<void(double)>& on_progress) {
  Stopwatch watch;
  Written out;
  const RelightJob& any = views.front().job;
  for (const Target& target : any.targets) {
    const SafeFile& file =
        *out.files.emplace_back(std::make_unique<SafeFile>(target.path, any.policy));
    std::vector<Shown> shown;
    for (const Shown& view : views)
      if (target.shows(view.job.frame.view)) shown.push_back(view);
    if (has_exr_ending(target.path)) {
      std::vector<ExrContents> contents;
      for (const Shown& view : shown)
        contents.push_back(exr_contents(view.job, view.plan, target, results_of(view)));
      out.clamped_values += write_exr(file, by_part(contents));
    } else {
      const Shown& view = shown.front();
      const DisplayImage image =
          make_display_image(product_of_picture(target, view.plan), results_of(view),
                             {view.display, keeps_alpha(target.path)});
      out.compose_ms += watch.lap();
      write_image(file, image.spec(any.options.output.bits), image.values);
    }
    out.write_ms += watch.lap();
    on_progress(double(out.files.size()) / double(any.targets.size()));
  }
  return out;
}

Relit relight(const RelightJob& job, const std::function<void(double)>& on_progress,
              const Past& past) {
  Relit relit;
  // Made first: a view that does not exist costs no estimate.
  relit.display = make_display(job);
  if (relit.display) {
    relit.notes.push_back(relit.display->description());
    if (!relit.display->warning().empty()) relit.warnings.push_back(relit.display->warning());
  }

  relit.plan = job.frame.plan;
  relit.times = job.frame.times;
  if (job.frame.bands) {
    relit.written = relight_in_bands(job, on_progress, relit);
    return relit;
  }
  Estimate found = estimate(
      job.frame.scene, job.frame.plan, [&](double done) { on_progress(kEstimateShare * done); },
      past, job.on_estimated);
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
    shown.push_back({job, of_view->plan, of_view->products, display ? &*display : nullptr});
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
