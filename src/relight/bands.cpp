// SPDX-License-Identifier: Apache-2.0
#include "relight/bands.h"

#include <algorithm>
#include <utility>

#include "color/kept_pixels.h"
#include "prior/prior.h"
#include "relight/targets.h"
#include "scene/build_geometry.h"
#include "scene/objects/read_object_masks.h"
#include "scene/objects/selected_coverage.h"
#include "scene/other_views/take_out.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Shares of the whole time, for progress: reading the overview, and finding the frame's openness.
constexpr double kOverviewShare = 0.02, kOpennessShare = 0.3;

Solids solids_of(const Geometry& geometry, const ModelOptions& model, const Scene& overview) {
  if (model.thickness) return constant_thickness(geometry, float(*model.thickness));
  return guess_solids(geometry, SolidsOfOverview{overview.casters(), overview.solids.thickness});
}

/// What casts of some rows, where the frame has something that does not.
Casting cast_in_band(const Frame& frame, const Geometry& rows, const PixelGrid& grid,
                     const Scene& overview) {
  const Selection& out = frame.objects.no_cast;
  const Plane<Surfel>& surfel = rows.surfel;
  Plane<float> coverage(surfel.width, surfel.height, 0.0f), backdrop;
  if (!out.empty()) coverage = selected_coverage(out, {frame.files, frame.view}, rows.window, grid);
  if (frame.is_backdrop) {
    backdrop = Plane<float>(surfel.width, surfel.height);
    for (std::size_t i = 0; i < surfel.size(); ++i)
      backdrop[i] = surfel[i].is_surface() && frame.is_backdrop(surfel[i]) ? 1.0f : 0.0f;
  }
  return take_out(rows, coverage, backdrop, {}, &overview.casting->geometry);
}

/// Some rows of a frame, read and placed as the whole frame is.
struct Band {
  GBuffer gbuffer;
  Scene scene;
};

/// `overview` is the scene of the frame.
Band read_band(const RelightJob& job, const Scene& overview, const Window& rows,
               StageTimes& times) {
  const Frame& frame = job.frame;
  Stopwatch watch;
  GBufferOptions reading = job.options.input.gbuffer;
  reading.beauty = frame.plan.composition.shows_rendered();
  reading.grid = {.y0 = rows.y0, .y1 = rows.y1};
  reading.known = frame.gbuffer.encodings;
  Band band;
  band.gbuffer = read_gbuffer(frame.readers(), frame.layers, reading);
  band.gbuffer.masks = read_object_masks(frame.objects, {frame.files, frame.view},
                                         band.gbuffer.window, reading.grid);
  times.read += watch.lap();
  GeometryReport report;
  band.scene =
      take_scene(band.gbuffer, build_geometry(band.gbuffer, job.options.camera, frame.input, report,
                                              &frame.report.placement));
  band.gbuffer.position = {};
  band.gbuffer.normal = {};
  band.gbuffer.depth = {};
  if (overview.casting) {
    band.scene.casting = cast_in_band(job.frame, band.scene.geometry, reading.grid, overview);
  }
  band.scene.solids = solids_of(band.scene.casters(), job.options.model, overview);
  band.scene.light = overview.light;
  times.prepare += watch.lap();
  return band;
}

/// `rows` of a channel over `window`.
ChannelView rows_of(ChannelView pixels, const Window& window, const Window& rows) {
  pixels.first = pixels.at(0, rows.y0 - window.y0);
  pixels.height = rows.height();
  return pixels;
}

class BandJob {
 public:
  BandJob(const RelightJob& job, const std::function<void(double)>& on_progress, Relit& relit)
      : job_(job),
        frame_(job.frame),
        bands_(*job.frame.bands),
        all_(job.frame.gbuffer.file_window),
        on_progress_(on_progress),
        relit_(relit) {}

  std::vector<std::unique_ptr<SafeFile>> run() {
    look_around();
    if (needs_openness()) find_openness();
    std::vector<std::unique_ptr<SafeFile>> files;
    for (const Target& target : job_.targets)
      files.push_back(std::make_unique<SafeFile>(target.path, job_.policy));
    std::vector<std::unique_ptr<ExrWriter>> writers(files.size());
    for_each_band([&](const Window& rows) {
      Band band = read(rows);
      const Products products = estimate_band(band.scene, rows);
      Stopwatch watch;
      const auto opened = open_kept_pixels(products, band.scene, band.gbuffer);
      for (std::size_t i = 0; i < files.size(); ++i) {
        const Results results{band.scene, band.gbuffer, products, frame_.plan.composition,
                              opened ? &*opened : nullptr};
        write(*files[i], job_.targets[i], results, rows, writers[i]);
      }
      relit_.times.write += watch.lap();
    });
    for (const auto& writer : writers) writer->finish();
    return files;
  }

 private:
  /// Finds what lies beyond the reach of bands.
  void look_around() {
    Stopwatch watch;
    const Plan& plan = frame_.plan;
    Request request = plan.request;
    std::optional<PriorField> field;
    if (plan.prior) request.ask_prior = asking(field);
    around_ = {plan.method->bands.overview(relit_.scene, request, float(bands_.march_px),
                                           [&](std::size_t, std::size_t) {}),
               bands_.marches_on, bands_.reach_rows};
    relit_.times.estimate += watch.lap();
    on_progress_(begun_);
  }

  /// Finds what a prior is told of the frame, and has it answer for the overview.
  AskPrior asking(std::optional<PriorField>& field) {
    const Plan& plan = frame_.plan;
    Request request = plan.request;
    request.products = {.ao = true};
    const PriorAsked asked{plan.prior->up, request.radius, request.seed};
    request.ask_prior = ask_prior(asked, field);
    plan.method->estimate(relit_.scene, request, {});
    prior_.of_frame = std::make_shared<PriorContext>(std::move(field->context));
    prior_.up = plan.prior->up;
    return ask_prior({asked.up, asked.radius, asked.seed, prior_.of_frame.get()}, field);
  }

  bool needs_openness() const {
    Request request = frame_.plan.request;
    request.around_band = around_;
    return !bands_.marches_on && frame_.plan.method->bands.needs_openness(relit_.scene, request);
  }

  /// The overview does not show it to the bit: bands are read once more for it.
  void find_openness() {
    Openness sum;
    for_each_band([&](const Window& rows) {
      const Band band = read(rows);
      Stopwatch watch;
      Request request = frame_.plan.request;
      request.receivers = rows;
      frame_.plan.method->bands.add_openness(band.scene, request, sum);
      relit_.times.estimate += watch.lap();
      on_progress_(kOverviewShare + kOpennessShare * double(rows.y1 - all_.y0) / all_.height());
    });
    around_.openness = sum;
    begun_ += kOpennessShare;
  }

  /// Calls `work(rows)` for the rows of each band.
  template <class Work>
  void for_each_band(const Work& work) const {
    for (int y = all_.y0; y < all_.y1; y += bands_.rows)
      work(Window{all_.x0, y, all_.x1, std::min(y + bands_.rows, all_.y1)});
  }

  /// A band with the rows around it that it needs. How near surfaces come, the overview may not
  /// have shown.
  Band read(const Window& rows) {
    Band band =
        read_band(job_, relit_.scene, with_rows_around(rows, bands_.halo_rows), relit_.times);
    around_.reach_rows = bands_.reach_rows;
    while (!bands_.marches_on) {
      const int needed = frame_.plan.method->bands.reach_rows(
          band.scene.geometry, 1, all_, frame_.part().display_window, frame_.plan.request);
      if (needed <= around_.reach_rows) break;
      around_.reach_rows = needed;
      band = {};
      band = read_band(job_, relit_.scene, with_rows_around(rows, halo_rows(frame_.plan, needed)),
                       relit_.times);
    }
    return band;
  }

  Window with_rows_around(const Window& rows, int around) const {
    return intersection(all_, {all_.x0, rows.y0 - around, all_.x1, rows.y1 + around});
  }

  /// `scene` is left with what outputs need.
  Products estimate_band(Scene& scene, const Window& rows) {
    Plan plan = frame_.plan;
    if (plan.prior) plan.prior = prior_;
    plan.request.receivers =
        with_rows_around(rows, plan.filter->reach + (plan.prior ? kPriorReach : 0));
    plan.request.around_band = around_;
    const double before = double(rows.y0 - all_.y0) / all_.height(),
                 share = double(rows.height()) / all_.height();
    const auto tell = [&](double done) {
      on_progress_(begun_ + (1 - begun_) * (before + share * done));
    };
    Estimate found = estimate(std::move(scene), plan, tell);
    light_products(found, plan);
    scene = std::move(found.scene);
    relit_.times.estimate += found.estimate_ms;
    relit_.times.filter += found.filter_ms;
    return std::move(found.products);
  }

  void write(const SafeFile& file, const Target& target, const Results& results, const Window& rows,
             std::unique_ptr<ExrWriter>& writer) {
    const ExrContents contents = exr_contents(job_, frame_.plan, target, results);
    if (!writer) writer = std::make_unique<ExrWriter>(file, std::vector{contents.output});
    std::vector<ChannelView> views;
    for (const ExrPlane& plane : contents.output.planes)
      views.push_back(rows_of(plane.pixels, results.gbuffer.window, rows));
    relit_.clamped_values += writer->write(views);
  }

  const RelightJob& job_;
  const Frame& frame_;
  const BandPlan& bands_;
  const Window all_;
  const std::function<void(double)>& on_progress_;
  Relit& relit_;
  AroundBand around_;
  LearnedPrior prior_;             ///< where it is used
  double begun_ = kOverviewShare;  ///< share of the time before bands are written
};

}  // namespace

std::vector<std::unique_ptr<SafeFile>> relight_in_bands(
    const RelightJob& job, const std::function<void(double)>& on_progress, Relit& relit) {
  return BandJob(job, on_progress, relit).run();
}

}  // namespace ssdo
