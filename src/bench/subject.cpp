// SPDX-License-Identifier: Apache-2.0
#include "bench/subject.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "bench/report_files.h"
#include "error.h"
#include "estimators/registry.h"
#include "nearest_name.h"
#include "relight/relight.h"

namespace ssdo {
namespace {

std::map<std::string, Truth> read_truths(const std::vector<std::string>& texts) {
  std::map<std::string, Truth> truths;
  for (const std::string& text : texts) {
    Truth truth = read_truth(parse_truth(text));
    const std::string product = truth.product;
    if (!truths.emplace(product, std::move(truth)).second) {
      throw Error(ExitCode::usage,
                  fmt::format("--truth {}: there is another truth of {} already", text, product));
    }
  }
  return truths;
}

/// The products that are asked for or have a truth; by default all that are meaningful here.
std::vector<std::string> choose_products(const BenchJob& job, const Subject& subject) {
  const std::vector<std::string>& asked = job.frame.output.products;
  for (const std::string& name : asked) {
    if (!contains(measured_products(), name)) {
      throw Error(ExitCode::usage, fmt::format("product '{}': {}bench measures {}", name,
                                               did_you_mean(name, measured_products()),
                                               fmt::join(measured_products(), ", ")));
    }
  }
  std::vector<std::string> products;
  for (const std::string& name : measured_products()) {
    // In constant light, direct is just ao times a colour.
    const bool telling = name == "direct" ? !subject.frame.scene.light.is_constant()
                                          : contains(subject.frame.plan.make, name);
    if (contains(asked, name) || subject.truths.contains(name) || (asked.empty() && telling))
      products.push_back(name);
  }
  for (const WantedError& want : job.options.wants) {
    if (!want.product.empty() && !contains(products, want.product)) {
      throw Error(ExitCode::usage,
                  fmt::format("--want {}={:g}: {} is not measured; {}there is {}", want.product,
                              want.error, want.product, did_you_mean(want.product, products),
                              fmt::join(products, ", ")));
    }
  }
  return products;
}

std::size_t count_surfaces(const Frame& frame) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.scene.geometry.surfaces.size(); ++i)
    count += frame.scene.geometry.is_surface(i);
  if (count > 0) return count;
  throw Error(ExitCode::failed,
              fmt::format("{}: shows no surface: there is nothing to measure", frame.input));
}

/// Refuses a truth of another size, which would be compared with a part of the frame only.
void check_truth(const Truth& truth, const Subject& subject) {
  const Window &own = subject.frame.scene.geometry.display, &other = truth.display;
  if (!(own == other)) {
    throw Error(ExitCode::layer,
                fmt::format("--truth {}:{}: is {} x {}, and the frame is {} x {}; it has to show "
                            "the same frame",
                            truth.file, truth.layer, other.width(), other.height(), own.width(),
                            own.height()));
  }
  const std::size_t valid = compare_surfaces(subject.frame, truth.channels, truth.channels).pixels;
  if (valid == subject.surface_pixels) return;
  throw Error(ExitCode::layer,
              fmt::format("--truth {}:{}: has values at {} of the frame's {} pixels of surfaces",
                          truth.file, truth.layer, valid, subject.surface_pixels));
}

/// A method that needs everything a frame can provide, solids included.
const Method& thorough_method() {
  const auto all = methods();
  return *std::find_if(all.begin(), all.end(),
                       [](const Method& m) { return m.supports.thickness; });
}

}  // namespace

Subject read_subject(const BenchJob& job, std::vector<RunFile> inputs) {
  Subject subject;
  subject.truths = read_truths(job.options.truths);
  for (const auto& [product, truth] : subject.truths) inputs.push_back({"--truth", truth.file});
  check_report_files(job.options.reports, std::move(inputs), job.frame.output.policy);

  FrameOptions prepared = job.frame;
  prepared.model.method = thorough_method().name;
  prepared.output.products.clear();
  prepared.output.compose.reset();  // no composite is measured
  const Lighting light(prepared.light);
  OtherPictures pictures(prepared.input.allow_partial, prepared.input.objects);
  FrameFiles files{job.input, prepared.input.aovs, prepared.input.also};
  files.objects.no_cast = prepared.input.objects.no_cast;
  if (!prepared.input.views.empty()) files.view = prepared.input.views.front();
  subject.frame = prepare_frame(prepared, light, pictures, files);
  subject.products = choose_products(job, subject);
  subject.surface_pixels = count_surfaces(subject.frame);
  for (const auto& [product, truth] : subject.truths) check_truth(truth, subject);
  return subject;
}

}  // namespace ssdo
