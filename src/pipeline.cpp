// SPDX-License-Identifier: Apache-2.0
#include "pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "compose.h"
#include "display_image.h"
#include "error.h"
#include "io/exr_writer.h"
#include "io/image_file.h"
#include "io/safe_file.h"
#include "sequence.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

bool is_exr(const fs::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return ending == ".exr";
}

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
  output.attributes = {{"ssdo/version", SSDO_VERSION}, {"ssdo/plan", to_json(frame.plan).dump()}};
  for (const NamedPlane& plane : channels) {
    output.planes.push_back({plane.channel, options.output.pixel_type, &plane.pixels});
  }
  relit.clamped_values += write_exr(file, output);
}

}  // namespace

std::vector<Target> targets_of(const OutputOptions& output, std::optional<int> frame) {
  const auto expand = [&](const std::string& path) {
    return frame ? expand_pattern(path, *frame) : path;
  };
  std::vector<Target> targets;
  for (const std::string& path : output.files) targets.push_back({expand(path), std::nullopt});
  for (const SaveRequest& save : output.saves) targets.push_back({expand(save.path), save.product});
  return targets;
}

std::vector<std::string> inputs_of(const Options& options, const std::string& frame,
                                   const std::vector<LayerRequest>& aovs) {
  std::vector<std::string> inputs = {frame, options.light.env, options.camera.file,
                                     options.color.ocio};
  for (const LayerRequest& request : aovs) inputs.push_back(request.file);
  return inputs;
}

void check_targets(const std::vector<Target>& targets, const std::vector<std::string>& inputs,
                   const OutputPolicy& policy) {
  std::vector<fs::path> seen;
  for (const Target& target : targets) {
    if (!is_exr(target.path) && !is_display_image(target.path)) {
      throw Error(
          ExitCode::usage,
          fmt::format("{}: unknown kind of output; use .exr, .png, .jpg or .tif", target.path));
    }
    const fs::path full = fs::weakly_canonical(target.path);
    if (std::find(seen.begin(), seen.end(), full) != seen.end()) {
      throw Error(ExitCode::usage, fmt::format("{}: named twice as an output", target.path));
    }
    seen.push_back(full);
    for (const std::string& input : inputs) {
      std::error_code ignored;
      if (fs::equivalent(target.path, input, ignored)) {
        throw Error(ExitCode::output,
                    fmt::format("{}: is an input; write to another file", target.path));
      }
    }
    check_output(target.path, policy);
  }
}

std::vector<std::unique_ptr<SafeFile>> write_targets(
    const Options& options, Frame& frame, const std::vector<Target>& targets,
    const OutputPolicy& policy, const Products& products, const DisplayTransform* display,
    const std::function<void(double)>& told, Relit& relit) {
  Stopwatch watch;
  std::vector<std::unique_ptr<SafeFile>> files;
  for (const Target& target : targets) {
    files.push_back(std::make_unique<SafeFile>(target.path, policy));
    if (is_exr(target.path)) {
      write_exr_target(*files.back(), target, options, frame, products, relit);
      frame.times.write += watch.lap();
    } else {
      const DisplayImage image =
          make_display_image(product_of_picture(target, frame.plan), frame, products, display);
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
  const Plan& plan = frame.plan;
  Relit relit;
  std::optional<DisplayTransform>
      display;  // made first: a view that does not exist costs no estimate
  for (const Target& target : targets) {
    if (is_exr(target.path) || !needs_display(product_of_picture(target, plan)) || display)
      continue;
    display.emplace(options.color, color_tags(frame));
    relit.notes.push_back(display->description());
  }

  Estimate found = estimate(
      frame, [&](double done) { told(0.85 * done); }, before);
  relit.history = std::move(found.history);
  relit.error = found.error;
  relit.notes.insert(relit.notes.end(), found.notes.begin(), found.notes.end());
  relit.warnings = found.warnings;
  const auto files = write_targets(
      options, frame, targets, policy, found.products, display ? &*display : nullptr,
      [&](double done) { told(0.85 + 0.15 * done); }, relit);
  Stopwatch watch;
  for (const auto& file : files) file->commit();
  frame.times.write += watch.lap();
  return relit;
}

}  // namespace ssdo
