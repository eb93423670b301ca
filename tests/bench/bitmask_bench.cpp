// SPDX-License-Identifier: Apache-2.0
//
// Method bitmask and its filter on a synthetic frame: 200 spheres on a ground. Times are CPU time
// of all threads; "ns/sample" counts the samples that a pixel can take, "x loads" is the ratio to
// the same loads and nothing else, measured in the same run.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <climits>
#include <cstdlib>
#include <glm/gtc/constants.hpp>

#include "bench/ball_frame.h"
#include "bench/bare_loads.h"
#include "estimators/bitmask.h"
#include "filters/filter_products.h"
#include "filters/registry.h"
#include "scene/solids/solids.h"
#include "simd/isa.h"
#include "support/scene_of.h"

namespace ssdo::bench {
namespace {

std::shared_ptr<Plane<glm::vec3>> sky_with_a_sun() {
  auto map = std::make_shared<Plane<glm::vec3>>(256, 128);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 256; ++x) (*map)(x, y) = glm::vec3(0.4f, 0.6f, 1) * (y < 64 ? 1.0f : 0.2f);
  }
  (*map)(60, 30) = glm::vec3(8000);
  return map;
}

/// Bare loads of the visibility pass in CPU seconds, on one thread.
double bare_seconds(const Geometry& g, const Solids& solids, int slices, int steps) {
  const MarchScene scene = make_march_scene(g, solids);
  const SlicePattern pattern(scene.layout, g.display, slices, steps, 0);
  const March march{scene, pattern, INFINITY, true};
  double best = 1e9;
  for (int run = 0; run < 3; ++run) {
    const std::clock_t start = std::clock();
    benchmark::DoNotOptimize(bare_loads(march, 0, g.surfaces.height));
    best = std::min(best, double(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

struct Size {
  const char* name;
  int width, height;
};
constexpr Size kSizes[] = {{"1080p", 1920, 1080}, {"4K", 3840, 2160}, {"8K", 7680, 4320}};

struct Job {
  ProductSet products;
  int slices, steps, bounces;
  float radius_px;  ///< 0: no limit
};

void estimate(benchmark::State& state, const std::string& isa, const Size& size, const Job& job,
              int threads) {
  force_isa(isa);
  const ThreadLimit limit(threads);
  const Geometry& g = frame_of(size.width, size.height);
  Scene scene = scene_of(g, Environment(sky_with_a_sun(), {}), 0.5f);
  scene.solids = guess_solids(g);
  const Request request{
      .products = job.products,
      .radius = job.radius_px > 0 ? job.radius_px * kDepth / float(g.camera.fy) : INFINITY,
      .bounces = job.bounces,
      .slices = job.slices,
      .steps = job.steps};
  for (auto _ : state) benchmark::DoNotOptimize(bitmask_method().estimate(scene, request, {}));
  const double samples = double(g.surfaces.size()) * job.slices * job.steps * 2;
  using benchmark::Counter;
  state.counters["ns/sample"] =
      Counter(samples * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
  if (threads == 1 && size.width == 1920) {
    state.counters["bare ns/sample"] =
        bare_seconds(g, scene.solids, job.slices, job.steps) / samples * 1e9;
  }
}

void filter(benchmark::State& state, const std::string& isa, const Size& size, int threads) {
  force_isa(isa);
  const ThreadLimit limit(threads);
  const Geometry& g = frame_of(size.width, size.height);
  Products products;
  products.ao = Plane<float>(size.width, size.height, 0.5f);
  products.bent = products.direct = products.bounce =
      Plane<glm::vec3>(size.width, size.height, glm::vec3(0.5f));
  for (auto _ : state)
    products = filter_products(find_filter("geometry"), std::move(products), g.surfaces,
                               bitmask_method().pattern_size);
  using benchmark::Counter;
  state.counters["ns/pixel"] = Counter(double(g.surfaces.size()) * 1e-9,
                                       Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void solids(benchmark::State& state, const Size& size) {
  const ThreadLimit limit(1);
  const Geometry& g = frame_of(size.width, size.height);
  for (auto _ : state) benchmark::DoNotOptimize(guess_solids(g));
}

void add(const std::string& name, const auto& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
}

void add_all() {
  const Job ao{{.ao = true}, 2, 16, 0, 0};
  const Job standard{{.ao = true, .direct = true, .bounce = true, .bent = true}, 2, 16, 1, 0};
  for (const std::string isa : {"avx512", "avx2", "neon", "scalar"}) {
    for (const Size& size : kSizes) {
      if (isa == "scalar" && size.width > 1920) continue;
      for (const int threads : {1, 2}) {
        const std::string where = isa + "/" + size.name + "/threads:" + std::to_string(threads);
        add("ao/" + where, [=](auto& s) { estimate(s, isa, size, ao, threads); });
        add("default/" + where, [=](auto& s) { estimate(s, isa, size, standard, threads); });
        add("filter/" + where, [=](auto& s) { filter(s, isa, size, threads); });
      }
    }
    for (const float radius : {32.0f, 128.0f, 512.0f}) {
      Job limited = ao;
      limited.radius_px = radius;
      add("ao/" + isa + "/1080p/radius:" + std::to_string(int(radius)),
          [=](auto& s) { estimate(s, isa, kSizes[0], limited, 1); });
    }
  }
  add("solids/1080p", [](auto& s) { solids(s, kSizes[0]); });
}

}  // namespace
}  // namespace ssdo::bench

int main(int argc, char** argv) {
  mallopt(M_MMAP_MAX, 0);  // as the tool does
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  ssdo::bench::add_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
