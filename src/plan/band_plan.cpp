// SPDX-License-Identifier: Apache-2.0
#include "plan/band_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "error.h"
#include "io/images/image_file.h"
#include "math/pixel_grid.h"
#include "prior/prior.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Measured bytes, with a margin: kBytes of a process without a frame, and for each pixel
/// kBytesPerPixel at the peak of ao, direct, bounce and composite, kBytesOfSun for each sun,
/// kBytesOfMore for bent and for reflection, kBytesOfSpecular for specular. An overview keeps as
/// much for each pixel of its own.
constexpr double kBytes = 60e6, kBytesPerPixel = 120, kBytesOfSun = 11, kBytesOfMore = 18,
                 kBytesOfSpecular = 72;

/// Bytes per pixel if some objects cast nothing: the surfaces and senders that do cast, and what
/// receives on marches.
constexpr double kBytesOfCasting = 60;

/// Bytes per pixel for each scene of blockers that only some lamps have, and for the light without
/// some objects together with the light it is compared with.
constexpr double kBytesOfLinkedOccluders = 100, kBytesOfShadow = 150;

/// What the learned prior adds: what it reads and changes of visibility, by pixel.
constexpr double kBytesOfPrior = 32;

/// What bright senders add, which a layer of radiance may hold.
constexpr double kBytesOfSenders = 20;

/// Suns of a map that are allowed for before it is known.
constexpr int kUsualSuns = 3;

/// Bytes per pixel for each light of which the bounce, or the direct light, is kept apart.
constexpr double kBytesOfBounce = 50, kBytesOfDirect = 14;

/// How many scenes block the light of lamps; lamps may share a scene.
std::size_t linked_occluders_of(const Scene& scene) {
  std::set<const Scene*> found;
  for (const auto& [source, blockers] : scene.linked_occluders) found.insert(blockers.get());
  return found.size();
}

double bytes_per_pixel(const Plan& plan, const Scene& scene) {
  const Request& request = plan.request;
  const ProductSet &products = request.products, &by_light = request.by_light;
  double bytes_of_light =
      kBytesOfBounce * int(by_light.bounce) + kBytesOfDirect * int(by_light.direct);
  if (by_light != ProductSet()) bytes_of_light *= double(light_groups_of(scene.light).size());
  return bytes_of_light + kBytesPerPixel + kBytesOfSun * double(scene.light.sources.size()) +
         kBytesOfSenders * int(!scene.senders.radiance.empty()) +
         kBytesOfPrior * int(plan.prior.has_value()) +
         kBytesOfCasting * int(scene.caster_surfaces.has_value()) +
         kBytesOfLinkedOccluders * double(linked_occluders_of(scene)) +
         kBytesOfShadow * int(bool(scene.without)) +
         kBytesOfMore * (int(products.bent) + int(products.reflection)) +
         kBytesOfSpecular * int(products.specular);
}

/// Bands end where chunks of every compression do.
constexpr int kRowsAtOnce = 256;

/// Reaches, in pixels, at which marches may end in a band if nothing is out of their reach. A
/// larger reach is nearer to the frame in one piece, but rows that are read for several bands cost
/// time.
constexpr int kMarches[] = {512, 256, 128};

/// Rows beyond the end of a march that are looked at: samples lie in blocks of pixels, and light
/// comes from pixels around them.
constexpr int kBeside = 16;

class Planner {
 public:
  Planner(const Window& frame, const Window& display, const Scene& overview, const Plan& plan,
          std::size_t memory)
      : frame_(frame), plan_(plan) {
    const double of_pixel = bytes_per_pixel(plan, overview);
    bytes_of_row_ = of_pixel * frame.width();
    bytes_ = kBytes + of_pixel * double(overview.geometry.surfaces.size());
    rows_ = int(std::clamp((double(memory) - bytes_) / bytes_of_row_, 0.0, 1e9));
    exact_ = plan.method->bands.reach_rows(overview.geometry, kOverviewStride, frame, display,
                                           plan.request);
  }

  /// Without rows where memory is too little.
  BandPlan choose() const {
    const int height = frame_.height();
    if (rows_ >= height) return {height, height, height, 0, false};
    BandPlan bands = with_reach(exact_, false);
    for (const int reach : kMarches) {
      if (bands.rows > 0 && (!bands.continues_in_overview || bands.rows >= bands.halo_rows)) break;
      bands = with_reach(reach, true);
    }
    return bands;
  }

  double least_bytes() const {
    const BandPlan least = with_reach(*std::rbegin(kMarches), true);
    return bytes_ + bytes_of_row_ * std::min(kRowsAtOnce + 2 * least.halo_rows, frame_.height());
  }

 private:
  BandPlan with_reach(int px, bool continues_in_overview) const {
    const int reach = continues_in_overview ? px + kBeside : px;
    const int halo = halo_rows(plan_, reach),
              rows = std::max(0, rows_ - 2 * halo) / kRowsAtOnce * kRowsAtOnce;
    return {rows, reach, px, halo, continues_in_overview};
  }

  const Window& frame_;
  const Plan& plan_;
  double bytes_of_row_, bytes_;
  int rows_;   ///< that fit into memory beside the overview
  int exact_;  ///< rows of the reach of the radius
};

std::string in_gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / double(1 << 30)); }

/// The first request that needs a whole frame; empty: none does.
std::string needs_whole_frame(const Scene& overview, const Plan& plan,
                              const OutputOptions& output) {
  if (!plan.method->bands.overview) return fmt::format("method {}", plan.method->name);
  if (plan.request.products.guessed) return "the product guessed";
  if (plan.request.products.specular) return "the product specular";
  if (plan.request.products.error || plan.error) return "the error";
  if (plan.temporal) return "--temporal";
  if (plan.shot) return "--shot";
  if (!overview.views.empty() || !overview.other_surfaces.empty()) return "--also";
  if (output.keep_channels) return "--keep-channels";
  if (output.downsample > 1) return "--downsample";
  for (const std::string& path : output.files)
    if (!has_exr_ending(path)) return path;
  for (const SaveRequest& save : output.saves)
    if (!has_exr_ending(save.path)) return save.path;
  return "";
}

/// The bytes that are expected when only the header has been read.
double expected_bytes_per_pixel(const OutputOptions& output, int lamps) {
  const double of_light = output.per_light ? kBytesOfBounce + kBytesOfDirect : 0;
  return kBytesPerPixel + (kUsualSuns + lamps) * kBytesOfSun + 2 * kBytesOfMore +
         (1 + lamps) * of_light;
}

}  // namespace

std::size_t most_pixels_in(std::size_t memory, const OutputOptions& output, int lamps) {
  const double left = std::max(0.0, double(memory) - kBytes);
  return std::size_t(left / expected_bytes_per_pixel(output, lamps));
}

double bytes_in_one_piece(const Plan& plan, const Scene& scene, std::size_t pixels) {
  return kBytes + bytes_per_pixel(plan, scene) * double(pixels);
}

BandPlan plan_bands(const std::string& file, const Window& frame, const Window& display,
                    const Scene& overview, const Plan& plan, const OutputOptions& output,
                    std::size_t memory) {
  const std::string size = fmt::format("{}: {} x {} pixels", file, frame.width(), frame.height());
  if (const std::string what = needs_whole_frame(overview, plan, output); !what.empty()) {
    // The frame was read as an overview because of its expected size, which may be larger.
    const double expected =
        kBytes +
        expected_bytes_per_pixel(output, int(overview.light.sources.size())) * double(frame.area());
    const double bytes = std::max(bytes_in_one_piece(plan, overview, frame.area()), expected);
    throw Error(ExitCode::usage,
                fmt::format("{} take {} of memory, and may take {}; {} needs all of the frame at "
                            "once: leave that out, or raise --mem-limit",
                            size, in_gigabytes(bytes), in_gigabytes(double(memory)), what));
  }
  const Planner planner(frame, display, overview, plan, memory);
  const BandPlan bands = planner.choose();
  if (bands.rows > 0) return bands;
  throw Error(ExitCode::usage, fmt::format("{} take {} of memory in bands of {} rows, and may take "
                                           "{}; raise --mem-limit",
                                           size, in_gigabytes(planner.least_bytes()), kRowsAtOnce,
                                           in_gigabytes(double(memory))));
}

int halo_rows(const Plan& plan, int reach_rows) {
  // What goes on beyond the border is measured within the radius of what rays meet there.
  const int reaches = 1 + plan.request.bounces + int(plan.request.extend_offscreen);
  return plan.filter->reach + (plan.prior ? kPriorReach : 0) + reaches * reach_rows;
}

std::string describe(const BandPlan& bands, const Window& frame) {
  const int count = (frame.height() + bands.rows - 1) / bands.rows;
  if (count == 1) return "1 band of all rows";
  std::string text =
      fmt::format("{} bands of {} rows, with {} above and below that their light comes from", count,
                  bands.rows, bands.halo_rows);
  if (bands.continues_in_overview)
    text += fmt::format("; beyond {} pixels marches go on in one pixel of {} x {}", bands.march_px,
                        kOverviewStride, kOverviewStride);
  return text;
}

}  // namespace ssdo
