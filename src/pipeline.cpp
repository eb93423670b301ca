// SPDX-License-Identifier: Apache-2.0
#include "pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
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

namespace fs = std::filesystem;

constexpr int kMostSlices = 256;

double mean_over_surfaces(const Plane<float>& plane, const Geometry& geometry) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    if (!geometry.is_surface(i)) continue;
    sum += plane[i];
    count += 1;
  }
  return count > 0 ? sum / count : 0;
}

/// The difference of two halves of the samples, filtered like all else, is one draw of the error
/// of each pixel; their root mean square among neighbours is its size.
Plane<float> standard_error(const Plane<float>& difference, const Geometry& geometry,
                            const Plan& plan) {
  Products squares;
  squares.error = difference;
  for (float& e : squares.error.pixels) e *= e;
  constexpr int kNeighbours = 4;  // enough to tell a size, be the pattern larger
  squares = apply_filter(*plan.filter, std::move(squares), geometry,
                         std::min(plan.method->pattern_size, kNeighbours));
  for (float& e : squares.error.pixels) e = std::sqrt(std::max(e, 0.0f));
  return std::move(squares.error);
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
  output.attributes = {{"ssdo/version", SSDO_VERSION},
                       {"ssdo/plan", json_text(to_json(frame.plan))}};
  for (const NamedPlane& plane : channels) {
    output.planes.push_back({plane.channel, options.output.pixel_type, &plane.pixels});
  }
  relit.clamped_values += write_exr(file, output);
}

/// Estimates and filters once; leaves in `history` what a temporal plan has then.
Products estimate(Frame& frame, const std::function<void(double)>& told,
                  const std::optional<History>& before, History& history) {
  const Plan& plan = frame.plan;
  Stopwatch watch;
  const double passes = 1.0 + plan.bounces;
  double finished = 0;
  const auto progress = [&](std::size_t done, std::size_t count) {
    told(std::min((finished + double(done) / double(count)) / passes, 1.0) * 0.8);
    if (done == count) finished += 1;
  };
  Products products = run_method(frame, plan, progress);
  frame.times.estimate += watch.lap();
  products =
      apply_filter(*plan.filter, std::move(products), frame.geometry, plan.method->pattern_size);
  if (plan.temporal) {
    history =
        accumulate(before ? &*before : nullptr, frame.geometry, products, frame.gbuffer.motion);
    products = products_of(history);
  }
  if (!products.error.empty())
    products.error = standard_error(products.error, frame.geometry, plan);
  frame.times.filter += watch.lap();
  return products;
}

/// Estimates with more and more slices until the mean standard error is what the plan asks for.
Products make_products(Frame& frame, Relit& relit, const std::function<void(double)>& told,
                       const std::optional<History>& before) {
  Plan& plan = frame.plan;
  for (;;) {
    Products products = estimate(frame, told, before, relit.history);
    if (!plan.error) return products;
    const double found = mean_over_surfaces(products.error, frame.geometry);
    if (found <= *plan.error || plan.slices >= kMostSlices) {
      relit.notes.push_back(fmt::format("standard error {:.2g} with {} slices{}", found,
                                        plan.slices,
                                        found <= *plan.error ? "" : ", the most there are"));
      return products;
    }
    // The error falls a little slower than 1 / slices; a step too short costs another round.
    const double factor = std::clamp(std::pow(found / *plan.error, 1.3), 1.5, 8.0);
    plan.slices = std::min(kMostSlices, int(std::ceil(plan.slices * factor)));
  }
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

Products run_method(const Frame& frame, const Plan& plan, const TileProgress& progress) {
  return plan.method->estimate({frame.geometry, frame.gbuffer.albedo, frame.gbuffer.radiance,
                                frame.environment, plan.products, plan.radius, plan.bounces,
                                plan.seed, plan.parameters, progress, plan.slices, plan.steps,
                                &frame.hidden, frame.light_model ? &*frame.light_model : nullptr,
                                plan.extend_offscreen, &frame.gbuffer.roughness});
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

  const Products products = make_products(frame, relit, told, before);
  told(0.85);
  const auto files = write_targets(
      options, frame, targets, policy, products, display ? &*display : nullptr,
      [&](double done) { told(0.85 + 0.15 * done); }, relit);
  Stopwatch watch;
  for (const auto& file : files) file->commit();
  frame.times.write += watch.lap();
  return relit;
}

}  // namespace ssdo
