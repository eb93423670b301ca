// SPDX-License-Identifier: Apache-2.0
#include "bench/bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "bench/command.h"
#include "bench/machine.h"
#include "bench/pictures.h"
#include "bench/recommend.h"
#include "bench/report_files.h"
#include "error.h"
#include "estimators/registry.h"
#include "plan/make_plan.h"
#include "relight/targets.h"
#include "scene/light/light_group.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

/// The error that a map of a ratio (AO) shows as black or white; for light, the mean light.
constexpr double kShareScale = 0.25;

/// Measures one frame.
class Bench {
 public:
  Bench(const BenchJob& job, const Subject& subject, const BenchProgress& progress)
      : job_(job), subject_(subject), frame_(subject.frame), progress_(progress) {
    if (wants_page(job.options.reports)) pictures_.emplace(frame_, job.frame.color);
  }

  BenchReport run() {
    Stopwatch watch;
    describe_subject();
    choose_methods();
    measure_reference();
    for (const Method* method : methods_) measure_method(*method);
    recommend(report_, job_.options.wants);
    keep_pictures_of_note();
    report_.seconds = watch.lap() * 1e-3;
    return std::move(report_);
  }

 private:
  void describe_subject() {
    report_.input = job_.input;
    report_.products = subject_.products;
    report_.width = frame_.scene.geometry.display.width();
    report_.height = frame_.scene.geometry.display.height();
    report_.pixels = frame_.scene.geometry.surfaces.size();
    report_.surface_pixels = subject_.surface_pixels;
    for (const auto& [product, truth] : subject_.truths)
      report_.truths[product] = truth.file + ":" + truth.layer;
    report_.stages = frame_.times;
    report_.processor = processor_name();
    report_.processors = processor_count();
    report_.filter = job_.frame.model.filter;
  }

  bool can_make(const Method& method, const std::string& name) const {
    const Product& product = find_product(name);
    const bool lit = product.kind == ProductKind::light && has_lamps(frame_.scene.light);
    return makes(method, product) && (takes_lamps(method) || !lit);
  }

  void choose_methods() {
    const std::vector<std::string>& names = job_.options.methods;
    for (const std::string& name : names) find_method(name);
    for (const Method& method : methods()) {
      const bool asked = std::find(names.begin(), names.end(), method.name) != names.end();
      if (!names.empty() && !asked) continue;
      const bool useful =
          std::any_of(report_.products.begin(), report_.products.end(),
                      [&](const std::string& product) { return can_make(method, product); });
      if (!useful && asked) {
        throw Error(ExitCode::usage, fmt::format("--methods {}: makes none of {}", method.name,
                                                 fmt::join(report_.products, ", ")));
      }
      if (useful) methods_.push_back(&method);
    }
    rays_ = reference_rays(report_.surface_pixels);
    const Settings reference = settings_of(reference_method(), rays_);
    work_ += reference.seeds * work_of(reference.limit);
    for (const Method* method : methods_) {
      const Settings settings = settings_of(*method, rays_);
      if (!method->is_reference) work_ += settings.seeds * work_of(settings.limit);
      for (const Setting& setting : settings.ladder) work_ += work_of(setting);
    }
  }

  /// Cost of a setting, in samples per pixel of a method whose sample_cost is 1.
  double work_of(const Setting& setting) const {
    return plan_of(setting).samples_per_pixel() * setting.method->sample_cost;
  }

  Plan plan_of(const Setting& setting) const {
    OutputOptions output;
    for (const std::string& product : report_.products) {
      if (can_make(*setting.method, product)) output.products.push_back(product);
    }
    return make_plan(setting.applied_to(job_.frame.model), output, frame_.scene, frame_.gbuffer,
                     job_.input);
  }

  Converged converge_to(const Setting& setting, int seeds) {
    const double work = work_of(setting), before = done_;
    const auto on_progress = [&](int done) { tell(before + done * work, setting); };
    tell(before, setting);
    return converge(frame_, plan_of(setting), seeds, on_progress);
  }

  void tell(double done, const Setting& setting) {
    done_ = done;
    progress_(done / work_, setting.name());
  }

  void measure_reference() {
    const Settings settings = settings_of(reference_method(), rays_);
    trace_ = converge_to(settings.limit, settings.seeds);
    for (const std::string& product : report_.products) {
      const Channels& reference = reference_of(product);
      const double mean = compare_surfaces(frame_, reference, reference).figures.mean_b;
      report_.error_scale[product] =
          has_absolute_error(product) || !(mean > 0) ? kShareScale : mean;
    }
    if (!pictures_) return;
    BenchReference truth{"truth", {}},
        trace{fmt::format("{}, converged", reference_method().name), {}};
    for (const std::string& product : report_.products) {
      trace.pictures[product] = pictures_->picture_of(product, trace_.products.at(product));
      if (subject_.truths.contains(product))
        truth.pictures[product] =
            pictures_->picture_of(product, subject_.truths.at(product).channels);
    }
    if (!truth.pictures.empty()) report_.references.push_back(std::move(truth));
    report_.references.push_back(std::move(trace));
  }

  /// The reference for the ranking of settings and for maps: truth where given, else trace.
  const Channels& reference_of(const std::string& product) const {
    const auto truth = subject_.truths.find(product);
    return truth != subject_.truths.end() ? truth->second.channels : trace_.products.at(product);
  }

  double error_between(const std::string& product, const Channels& a, const Channels& b) const {
    return error_of(product, compare_surfaces(frame_, a, b).figures);
  }

  /// The errors except noise, which is computed differently for rows and limits.
  Errors errors_of(const ProductChannels& products) const {
    Errors errors;
    for (const auto& [product, channels] : products) {
      ErrorSplit& split = errors[product];
      split.approximation = error_between(product, channels, trace_.products.at(product));
      const auto truth = subject_.truths.find(product);
      if (truth != subject_.truths.end())
        split.model = error_between(product, channels, truth->second.channels);
    }
    return errors;
  }

  /// The noise of a limit is the standard error of the mean of its two halves, half of their
  /// difference.
  void add_limit(const Settings& settings, const Converged& limit) {
    BenchLimit out{settings.limit, settings.seeds, errors_of(limit.products)};
    for (const auto& [product, half] : limit.half_difference) {
      Channels off = limit.products.at(product);
      for (std::size_t c = 0; c < off.planes.size(); ++c) {
        for (std::size_t i = 0; i < off.planes[c].size(); ++i)
          off.planes[c][i] += half.planes[c][i];
      }
      out.errors[product].noise = error_between(product, off, limit.products.at(product));
    }
    report_.limits.push_back(std::move(out));
  }

  void measure_method(const Method& method) {
    const Settings settings = settings_of(method, rays_);
    const Converged own =
        method.is_reference ? Converged() : converge_to(settings.limit, settings.seeds);
    const Converged& limit = method.is_reference ? trace_ : own;
    add_limit(settings, limit);
    for (const Setting& setting : settings.ladder) measure_setting(setting, limit);
  }

  void measure_setting(const Setting& setting, const Converged& limit) {
    const Plan plan = plan_of(setting);
    const double work = work_of(setting), before = done_;
    const auto on_progress = [&](std::size_t done, std::size_t count) {
      tell(before + work * double(done) / double(count) / (1.0 + plan.request.bounces), setting);
    };
    const Measured measured = measure(frame_, plan, on_progress);
    tell(before + work, setting);
    const ProductChannels products = channels_of(frame_, plan, measured.products);
    BenchRow row{setting,
                 plan.samples_per_pixel(),
                 measured.estimate,
                 measured.filter,
                 measured.runs,
                 errors_of(products),
                 command_of(job_, setting, plan),
                 {}};
    for (const auto& [product, channels] : products) {
      row.errors[product].noise = error_between(product, channels, limit.products.at(product));
      if (pictures_) row.pictures[product] = pictures_of(product, channels);
    }
    if (report_.rows.empty()) measure_writing(plan, measured.products);
    report_.rows.push_back(std::move(row));
  }

  Pictures pictures_of(const std::string& product, const Channels& channels) const {
    const auto difference = compare_surfaces(frame_, channels, reference_of(product));
    return {pictures_->picture_of(product, channels),
            pictures_->map_of(difference, report_.error_scale.at(product))};
  }

  /// Writes an EXR of the products into a temporary file that is then removed.
  void measure_writing(const Plan& plan, const Products& products) {
    const std::vector<Target> targets = {
        {fs::temp_directory_path() / fmt::format("ssdo_bench_{}.exr", getpid()), std::nullopt}};
    const RelightJob job{job_.frame, frame_, targets, {.overwrite = true}};
    report_.stages.write =
        write_targets({{job, frame_.scene, plan, products, nullptr}}, [](double) {}).write_ms;
  }

  /// Drops pictures except of rows on a front, defaults of methods and the recommended row.
  void keep_pictures_of_note() {
    std::vector<bool> keep(report_.rows.size());
    for (const std::string& product : report_.products) {
      for (const std::size_t i : report_.front(product)) keep[i] = true;
    }
    if (report_.recommended) keep[*report_.recommended] = true;
    if (report_.best) keep[*report_.best] = true;
    for (std::size_t i = 0; i < keep.size(); ++i) {
      if (!keep[i] && !report_.rows[i].setting.standard) report_.rows[i].pictures.clear();
    }
  }

  const BenchJob& job_;
  const Subject& subject_;
  const Frame& frame_;
  const BenchProgress& progress_;
  std::vector<const Method*> methods_;
  int rays_ = 0;
  Converged trace_;  ///< the reference for all rows
  std::optional<BenchPictures> pictures_;
  BenchReport report_;
  double work_ = 0, done_ = 0;  ///< for the progress bar
};

}  // namespace

BenchReport bench(const BenchJob& job, const Subject& subject, const BenchProgress& progress) {
  return Bench(job, subject, progress).run();
}

}  // namespace ssdo
