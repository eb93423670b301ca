// SPDX-License-Identifier: Apache-2.0
#include "pipeline.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "compose.h"
#include "display_image.h"
#include "error.h"
#include "io/exr_writer.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/safe_file.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

const std::string& product_of_picture(const Target& target, const Plan& plan) {
  return target.product ? *target.product : plan.show;
}

void write_exr_target(const SafeFile& file, const Target& target, const Options& options,
                      const Frame& frame, const Products& products, Relit& relit) {
  std::vector<NamedPlane> channels;
  for (const std::string& product :
       target.product ? std::vector{*target.product} : frame.plan.write) {
    for (NamedPlane& plane : product_channels(product, frame.gbuffer, frame.geometry, products)) {
      channels.push_back(std::move(plane));
    }
  }
  ExrOutput output;
  output.input = &frame.files[std::size_t(frame.lead().file)];
  output.part = frame.lead().part;
  output.keep_channels = options.output.keep_channels;
  output.compression = options.output.compression;
  output.attributes = {{"ssdo/version", SSDO_VERSION},
                       {"ssdo/plan", json_text(to_json(frame.plan))}};
  for (const NamedPlane& plane : channels) {
    output.planes.push_back({plane.channel, options.output.pixel_type, &plane.pixels});
  }
  relit.clamped_values += write_exr(file, output);
}

}  // namespace

std::optional<DisplayTransform> make_display(const Options& options, const Frame& frame,
                                             const std::vector<Target>& targets) {
  for (const Target& target : targets) {
    if (!has_exr_ending(target.path) && needs_display(product_of_picture(target, frame.plan)))
      return DisplayTransform(options.color, color_tags(frame));
  }
  return std::nullopt;
}

std::vector<std::unique_ptr<SafeFile>> write_targets(
    const Options& options, Frame& frame, const std::vector<Target>& targets,
    const OutputPolicy& policy, const Products& products, const DisplayTransform* display,
    const std::function<void(double)>& told, Relit& relit) {
  Stopwatch watch;
  std::vector<std::unique_ptr<SafeFile>> files;
  for (const Target& target : targets) {
    files.push_back(std::make_unique<SafeFile>(target.path, policy));
    if (has_exr_ending(target.path)) {
      write_exr_target(*files.back(), target, options, frame, products, relit);
      frame.times.write += watch.lap();
    } else {
      const DisplayImage image = make_display_image(product_of_picture(target, frame.plan), frame,
                                                    products, display, keeps_alpha(target.path));
      frame.times.compose += watch.lap();
      write_image(*files.back(), image.spec(options.output.bits), image.values);
      frame.times.write += watch.lap();
    }
    told(double(files.size()) / double(targets.size()));
  }
  return files;
}

Relit relight(const Options& options, Frame& frame, const std::vector<Target>& targets,
              const OutputPolicy& policy, const std::function<void(double)>& told,
              const std::optional<History>& before) {
  Relit relit;
  // Made first: a view that does not exist costs no estimate.
  const std::optional<DisplayTransform> display = make_display(options, frame, targets);
  if (display) {
    relit.notes.push_back(display->description());
    if (!display->warning().empty()) relit.warnings.push_back(display->warning());
  }

  Estimate found = estimate(
      frame, [&](double done) { told(0.85 * done); }, before);
  relit.history = std::move(found.history);
  relit.error = found.error;
  relit.notes.insert(relit.notes.end(), found.notes.begin(), found.notes.end());
  relit.warnings.insert(relit.warnings.end(), found.warnings.begin(), found.warnings.end());
  const auto files = write_targets(
      options, frame, targets, policy, found.products, display ? &*display : nullptr,
      [&](double done) { told(0.85 + 0.15 * done); }, relit);
  Stopwatch watch;
  for (const auto& file : files) file->commit();
  frame.times.write += watch.lap();
  return relit;
}

}  // namespace ssdo
