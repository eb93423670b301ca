// SPDX-License-Identifier: Apache-2.0
#include "pipeline.h"

#include <nlohmann/json.hpp>
#include <utility>

#include "bands.h"
#include "color/display_image.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// The share of a job's time that estimate and filter take, for progress.
constexpr double kEstimateShare = 0.85;

const std::string& product_of_picture(const Target& target, const Plan& plan) {
  return target.product ? *target.product : plan.show;
}

Results results_of(const RelightJob& job, const Plan& plan, const Products& products) {
  return {job.frame.scene, job.frame.gbuffer, products, plan.composition};
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

void append(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

}  // namespace

std::optional<DisplayTransform> make_display(const RelightJob& job) {
  for (const Target& target : job.targets) {
    if (has_exr_ending(target.path)) continue;
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
  output.attributes = {{"ssdo/version", SSDO_VERSION},
                       {"ssdo/plan", json_text(to_json(plan, frame.history))}};
  for (const NamedChannels& product : contents.products) {
    for (const NamedChannel& channel : product.channels)
      output.planes.push_back({channel.name, job.options.output.pixel_type, channel.pixels});
  }
  return contents;
}

Written write_targets(const RelightJob& job, const Plan& plan, const Products& products,
                      const DisplayTransform* display,
                      const std::function<void(double)>& on_progress) {
  Stopwatch watch;
  Written out;
  for (const Target& target : job.targets) {
    const SafeFile& file =
        *out.files.emplace_back(std::make_unique<SafeFile>(target.path, job.policy));
    if (has_exr_ending(target.path)) {
      const ExrContents contents = exr_contents(job, plan, target, results_of(job, plan, products));
      out.clamped_values += write_exr(file, contents.output);
    } else {
      const DisplayImage image =
          make_display_image(product_of_picture(target, plan), results_of(job, plan, products),
                             {display, keeps_alpha(target.path)});
      out.compose_ms += watch.lap();
      write_image(file, image.spec(job.options.output.bits), image.values);
    }
    out.write_ms += watch.lap();
    on_progress(double(out.files.size()) / double(job.targets.size()));
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

void write_outputs(const RelightJob& job, Relit& relit,
                   const std::function<void(double)>& on_progress) {
  if (job.frame.bands) {
    Stopwatch watch;
    for (const auto& file : relit.written) file->commit();
    relit.times.write += watch.lap();
    return;
  }
  const Written written = write_targets(
      job, relit.plan, relit.products, relit.display ? &*relit.display : nullptr,
      [&](double done) { on_progress(kEstimateShare + (1 - kEstimateShare) * done); });
  relit.clamped_values = written.clamped_values;
  Stopwatch watch;
  for (const auto& file : written.files) file->commit();
  relit.times.compose = written.compose_ms;
  relit.times.write = written.write_ms + watch.lap();
}

}  // namespace ssdo
