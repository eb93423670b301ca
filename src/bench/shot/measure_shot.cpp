// SPDX-License-Identifier: Apache-2.0
#include "bench/shot/measure_shot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "error.h"
#include "io/pictures/picture_layers.h"
#include "io/sequence.h"
#include "jobs/batch.h"
#include "jobs/jobs.h"
#include "metrics/near_moving.h"
#include "metrics/shot_points.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

/// The share of the time that a run takes; the rest is measuring.
constexpr double kRunShare = 0.9;

/// A folder that is there while the object lives.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : path_(fs::temp_directory_path() / fmt::format("ssdo_bench_shot_{}", getpid())) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// The run of a setting: its products, as floats, in files that nobody else sees.
RunOptions run_of(const ShotSubject& subject, const ShotSetting& setting,
                  const std::string& output) {
  RunOptions run = setting.applied_to(subject.options);
  run.command = Command::relight;
  run.output.files = {output};
  run.output.saves = {};
  run.output.products = subject.products;
  run.output.compose.reset();
  run.output.pixel_type = Imf::FLOAT;
  run.output.policy = {.overwrite = true};
  run.batch.frames = subject.frames;
  run.batch.progress = ProgressStyle::none;
  run.verbosity = {};
  run.verbosity.quiet = true;
  return run;
}

/// Adds frames up to those of a shot.
class ShotSum {
 public:
  explicit ShotSum(const ShotSubject& subject) : subject_(subject) {}

  void add(int frame, const std::string& output) {
    const FrameFiles files = files_at(subject_.options, frame);
    const LayeredPicture picture(output);
    std::vector<std::string> notes;
    const std::optional<Geometry> before =
        has_before_ && has_truth(frame) ? std::optional(points_.latest()) : std::nullopt;
    const auto shared = points_.next(
        frame, read_points(files, subject_.options.input, subject_.options.camera),
        picture.display(picture.layers().front()), [](int, int) { return true; }, notes);
    has_before_ = true;
    const Plane<unsigned char> near =
        before ? near_moving(*before, points_.latest()) : Plane<unsigned char>();
    for (const std::string& product : subject_.products) {
      const PictureLayer layer = picture.find(product);
      const Channels now{picture.window(layer), picture.read(layer)};
      Sum& sum = sums_[product];
      std::optional<Channels> off = difference_from_truth(product, frame, now, near, sum);
      if (shared && !sum.before.planes.empty())
        sum.flicker.add(measure_flicker(*shared, sum.before, now));
      if (shared && off && sum.off_before)
        sum.flicker_of_error.add(measure_flicker(*shared, *sum.off_before, *off));
      sum.before = now;
      sum.off_before = std::move(off);
    }
  }

  std::map<std::string, ShotFigures> figures() const {
    std::map<std::string, ShotFigures> all;
    for (const auto& [product, sum] : sums_)
      all[product] = {sum.flicker.figures(), sum.error, sum.error_near_moving,
                      sum.flicker_of_error.figures()};
    return all;
  }

 private:
  struct Sum {
    Flicker flicker, flicker_of_error;
    Difference error, error_near_moving;
    Channels before;
    std::optional<Channels> off_before;
  };

  /// The file with the truth of a product; empty: there is none.
  std::string truth_of(const std::string& product, int frame) const {
    const auto request = subject_.truths.find(product);
    if (request == subject_.truths.end()) return "";
    const std::string file =
        expand_pattern(parse_picture_name(request->second.picture).file, frame);
    std::error_code ignored;
    return fs::exists(file, ignored) ? file : "";
  }

  bool has_truth(int frame) const {
    return std::ranges::any_of(subject_.products, [&](const std::string& product) {
      return !truth_of(product, frame).empty();
    });
  }

  /// Product minus truth, and its error added to the sum; nothing in a frame without truth. `near`
  /// is near_moving(), or empty where that is not known.
  std::optional<Channels> difference_from_truth(const std::string& product, int frame,
                                                const Channels& now,
                                                const Plane<unsigned char>& near, Sum& sum) const {
    const std::string file = truth_of(product, frame);
    if (file.empty()) return std::nullopt;
    const PictureName name = parse_picture_name(subject_.truths.at(product).picture);
    const Truth truth = read_truth({product, name.layer.empty() ? file : file + ":" + name.layer});
    const Geometry& geometry = points_.latest();
    if (!(truth.display == geometry.display)) {
      throw Error(
          ExitCode::layer,
          fmt::format("--truth {}: is {} x {}, and the frame is {} x {}; it has to show the "
                      "same frame",
                      file, truth.display.width(), truth.display.height(), geometry.display.width(),
                      geometry.display.height()));
    }
    const auto is_surface = [&](int x, int y) {
      return geometry.window.contains(x, y) && geometry.is_surface(geometry.surfaces.index(
                                                   x - geometry.window.x0, y - geometry.window.y0));
    };
    sum.error.add(compare_channels(now, truth.channels, is_surface).figures);
    const auto is_near = [&](int x, int y) {
      return is_surface(x, y) && near(x - geometry.window.x0, y - geometry.window.y0) != 0;
    };
    if (!near.empty())
      sum.error_near_moving.add(compare_channels(now, truth.channels, is_near).figures);
    return subtract(now, truth.channels);
  }

  const ShotSubject& subject_;
  ShotPoints points_;
  bool has_before_ = false;
  std::map<std::string, Sum> sums_;
};

}  // namespace

MeasuredShot measure_shot(const ShotSubject& subject, const ShotSetting& setting,
                          const std::function<void(double)>& on_step) {
  const TemporaryFolder folder;
  const std::string output = folder / "relit.####.exr";
  MeasuredShot measured;
  CostWatch watch;
  const ExitCode code = run_batch(run_of(subject, setting, output), subject.resources);
  measured.cost = watch.lap();
  if (code != ExitCode::done) {
    throw Error(code,
                fmt::format("{}: a frame fails with the setting '{}', so that the shot cannot "
                            "be measured; see the line before",
                            subject.options.input_file, setting.name()));
  }
  on_step(kRunShare);
  ShotSum sum(subject);
  for (std::size_t i = 0; i < subject.frames.size(); ++i) {
    sum.add(subject.frames[i], expand_pattern(output, subject.frames[i]));
    on_step(kRunShare + (1 - kRunShare) * double(i + 1) / double(subject.frames.size()));
  }
  measured.products = sum.figures();
  return measured;
}

}  // namespace ssdo
