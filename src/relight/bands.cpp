// SPDX-License-Identifier: Apache-2.0
#include "relight/bands.h"

#include <algorithm>
#include <utility>

#include "color/kept_pixels.h"
#include "prior/prior.h"
#include "relight/read_band.h"
#include "relight/shadow_of.h"
#include "relight/targets.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Shares of the whole time, for progress: reading the overview, and finding the frame's enclosure.
constexpr double kOverviewShare = 0.02, kEnclosureShare = 0.3;

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
    if (needs_enclosure()) find_enclosure();
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
  /// What lies beyond the reach of the bands of a scene, and what a prior is told of it.
  struct Around {
    AroundBand band;
    LearnedPrior prior;  ///< where it is used

    Plan of_band(Plan plan) const {
      plan.request.around_band = band;
      if (plan.prior) plan.prior = prior;
      return plan;
    }
  };

  /// Fills `around_`: for the frame, and for the frame without the objects of --shadow-of where
  /// that product is made.
  void look_around() {
    Stopwatch watch;
    around_.push_back(around(relit_.scene, frame_.plan));
    if (contains(frame_.plan.make, "shadow_of")) {
      Scene& without = *relit_.scene.without;
      light_alike(without, relit_.scene);
      around_.push_back(around(without, plan_of_shadow(frame_.plan)));
    }
    relit_.times.estimate += watch.lap();
    on_progress_(begun_);
  }

  Around around(const Scene& overview, const Plan& plan) const {
    Around found;
    Request request = plan.request;
    std::optional<PriorField> field;
    if (plan.prior) request.ask_prior = asking(overview, plan, found.prior, field);
    found.band = {plan.method->bands.overview(overview, request, float(bands_.march_px),
                                              [&](std::size_t, std::size_t) {}),
                  bands_.continues_in_overview, bands_.reach_rows};
    return found;
  }

  /// Finds what a prior needs to know of the frame; returns a function that asks it for the
  /// overview.
  AskPrior asking(const Scene& overview, const Plan& plan, LearnedPrior& told,
                  std::optional<PriorField>& field) const {
    Request request = plan.request;
    request.products = {.ao = true};
    const PriorSettings asked{plan.prior->up, request.radius, request.seed};
    request.ask_prior = ask_prior(asked, field);
    plan.method->estimate(overview, request, {});
    told.of_frame = std::make_shared<PriorContext>(std::move(field->context));
    told.up = plan.prior->up;
    return ask_prior({asked.up, asked.radius, asked.seed, told.of_frame.get()}, field);
  }

  /// The scene that an element of `around_` is of.
  static Scene& scene_of(Scene& scene, std::size_t number) {
    return number == 0 ? scene : *scene.without;
  }

  bool needs_enclosure(std::size_t number) const {
    const Plan plan = around_[number].of_band(frame_.plan);
    return !bands_.continues_in_overview &&
           plan.method->bands.needs_enclosure(scene_of(relit_.scene, number), plan.request);
  }
  bool needs_enclosure() const {
    for (std::size_t k = 0; k < around_.size(); ++k)
      if (needs_enclosure(k)) return true;
    return false;
  }

  /// Finds the enclosure of the frame from all bands, which are read once more for it: the overview
  /// does not give it to the bit.
  void find_enclosure() {
    std::vector<Enclosure> sums(around_.size());
    for_each_band([&](const Window& rows) {
      Band band = read(rows);
      Stopwatch watch;
      Request request = frame_.plan.request;
      request.receivers = rows;
      for (std::size_t k = 0; k < sums.size(); ++k)
        frame_.plan.method->bands.add_enclosure(scene_of(band.scene, k), request, sums[k]);
      relit_.times.estimate += watch.lap();
      on_progress_(kOverviewShare + kEnclosureShare * double(rows.y1 - all_.y0) / all_.height());
    });
    for (std::size_t k = 0; k < sums.size(); ++k) around_[k].band.enclosure = sums[k];
    begun_ += kEnclosureShare;
  }

  /// Calls `work(rows)` for the rows of each band.
  template <class Work>
  void for_each_band(const Work& work) const {
    for (int y = all_.y0; y < all_.y1; y += bands_.rows)
      work(Window{all_.x0, y, all_.x1, std::min(y + bands_.rows, all_.y1)});
  }

  /// A band with the rows around it that it needs. The overview may not have shown how near
  /// surfaces come.
  Band read(const Window& rows) {
    Band band =
        read_band(job_, relit_.scene, with_rows_around(rows, bands_.halo_rows), relit_.times);
    int reach = bands_.reach_rows;
    while (!bands_.continues_in_overview) {
      const int needed = frame_.plan.method->bands.reach_rows(
          band.scene.geometry, 1, all_, frame_.part().display_window, frame_.plan.request);
      if (needed <= reach) break;
      reach = needed;
      band = {};
      band = read_band(job_, relit_.scene, with_rows_around(rows, halo_rows(frame_.plan, needed)),
                       relit_.times);
    }
    for (Around& each : around_) each.band.reach_rows = reach;
    return band;
  }

  Window with_rows_around(const Window& rows, int around) const {
    return intersection(all_, {all_.x0, rows.y0 - around, all_.x1, rows.y1 + around});
  }

  /// `scene` is left with what outputs need.
  Products estimate_band(Scene& scene, const Window& rows) {
    Relit band;
    band.plan = around_[0].of_band(frame_.plan);
    band.plan.request.receivers =
        with_rows_around(rows, frame_.plan.filter->reach + (frame_.plan.prior ? kPriorReach : 0));
    const double before = double(rows.y0 - all_.y0) / all_.height(),
                 share = double(rows.height()) / all_.height() / double(around_.size());
    const auto tell = [&](double done) {
      on_progress_(begun_ + (1 - begun_) * (before + share * done));
    };
    const std::shared_ptr<Scene> without = std::move(scene.without);
    Estimate found = estimate(std::move(scene), band.plan, tell);
    light_products(found, band.plan);
    band.times.estimate = found.estimate_ms, band.times.filter = found.filter_ms;
    band.scene = std::move(found.scene), band.products = std::move(found.products);
    if (around_.size() > 1) {
      band.plan = around_[1].of_band(std::move(band.plan));
      find_shadow(*without, band);
    }
    scene = std::move(band.scene);
    relit_.times.estimate += band.times.estimate;
    relit_.times.filter += band.times.filter;
    return std::move(band.products);
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
  std::vector<Around> around_;     ///< see scene_of()
  double begun_ = kOverviewShare;  ///< share of the time before bands are written
};

}  // namespace

std::vector<std::unique_ptr<SafeFile>> relight_in_bands(
    const RelightJob& job, const std::function<void(double)>& on_progress, Relit& relit) {
  return BandJob(job, on_progress, relit).run();
}

}  // namespace ssdo
