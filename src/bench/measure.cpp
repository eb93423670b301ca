// SPDX-License-Identifier: Apache-2.0
#include "bench/measure.h"

#include <algorithm>
#include <ctime>

#include "color/compose.h"
#include "filters/light_visibility.h"
#include "relight/estimate.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

/// Runs per median: at least three, and up to kMostRuns while their total time is below this.
constexpr int kMostRuns = 5;
constexpr double kRepeatBelowMs = 600;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

Cost median_of(const std::vector<Cost>& costs) {
  std::vector<double> cpu, wall;
  for (const Cost& c : costs) {
    cpu.push_back(c.cpu_ms);
    wall.push_back(c.wall_ms);
  }
  return {median(cpu), median(wall)};
}

/// a = keep a + take b.
void blend(ProductChannels& a, const ProductChannels& b, float keep, float take) {
  for (auto& [name, channels] : a) {
    for (std::size_t c = 0; c < channels.planes.size(); ++c) {
      Plane<float>& to = channels.planes[c];
      const Plane<float>& from = b.at(name).planes[c];
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = keep * to[i] + take * from[i];
    }
  }
}

Plane<float> copy_of(const ChannelView& channel) {
  Plane<float> plane(channel.width, channel.height);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = channel[i];
  return plane;
}

double process_cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) * 1e3 + double(t.tv_nsec) * 1e-6;
}

}  // namespace

CostWatch::CostWatch() : cpu_(process_cpu_ms()) {}

Cost CostWatch::lap() {
  const double cpu = process_cpu_ms();
  const Cost cost{cpu - cpu_, wall_.lap()};
  cpu_ = cpu;
  return cost;
}

ProductChannels channels_of(const Frame& frame, const Plan& plan, const Products& products) {
  ProductChannels all;
  for (const std::string& name : plan.make) {
    Channels& channels = all[name];
    channels.window = frame.scene.geometry.window;
    const auto found = product_channels(name, {frame.scene, frame.gbuffer, products});
    for (const NamedChannel& channel : found.channels)
      channels.planes.push_back(copy_of(channel.pixels));
  }
  return all;
}

Measured measure(const Frame& frame, const Plan& plan, const Progress& progress) {
  Measured out;
  std::vector<Cost> estimates, filters;
  double spent = 0;
  do {
    CostWatch watch;
    out.products =
        plan.method->estimate(frame.scene, plan.request, out.runs == 0 ? progress : Progress());
    estimates.push_back(watch.lap());
    out.products = filter_visibility(*plan.filter, std::move(out.products), frame.scene,
                                     plan.method->pattern_size);
    filters.push_back(watch.lap());
    spent += estimates.back().wall_ms + filters.back().wall_ms;
    ++out.runs;
  } while (out.runs < kMostRuns && spent + spent / out.runs < kRepeatBelowMs);
  out.estimate = median_of(estimates);
  out.filter = median_of(filters);
  return out;
}

Converged converge(const Frame& frame, const Plan& plan, int seeds,
                   const std::function<void(int)>& on_progress) {
  Converged out;
  Request request = plan.request;
  ProductChannels& mean = out.products;
  ProductChannels second;
  const int half = seeds / 2;
  for (int i = 0; i < seeds; ++i) {
    ++request.seed;
    ProductChannels one = channels_of(frame, plan, plan.method->estimate(frame.scene, request, {}));
    ProductChannels& sum = i < half || seeds == 1 ? mean : second;
    if (sum.empty()) {
      sum = std::move(one);
    } else {
      const float n = float(i % half);
      blend(sum, one, n / (n + 1), 1 / (n + 1));
    }
    on_progress(i + 1);
  }
  if (seeds == 1) return out;
  out.half_difference = mean;
  blend(out.half_difference, second, 0.5f, -0.5f);
  blend(mean, second, 0.5f, 0.5f);
  return out;
}

ChannelsDifference compare_surfaces(const Frame& frame, const Channels& a, const Channels& b) {
  const Geometry& g = frame.scene.geometry;
  return compare_channels(a, b, [&](int x, int y) {
    return g.window.contains(x, y) &&
           g.is_surface(g.surfaces.index(x - g.window.x0, y - g.window.y0));
  });
}

bool has_absolute_error(const std::string& product) {
  return find_product(product).kind == ProductKind::share;
}

double error_of(const std::string& product, const Difference& difference) {
  return has_absolute_error(product) ? difference.rmse : difference.relative_rmse();
}

}  // namespace ssdo
