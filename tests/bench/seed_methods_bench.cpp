// SPDX-License-Identifier: Apache-2.0
//
// The methods of the seed documents at 1080p with their defaults and the radius that the tool
// chooses, and the filters. "ns/sample" is CPU time of all threads over the samples that are taken,
// or the taps of a filter, with all that is done besides: planes, upsampling.
#include <benchmark/benchmark.h>

#include <functional>

#include "bench/ball_frame.h"
#include "estimators/registry.h"
#include "filters/filter_products.h"
#include "filters/registry.h"
#include "support/scene_of.h"

namespace ssdo::bench {
namespace {

struct Row {
  const char* name;
  const char* method;
  std::vector<std::string> set;
  double samples;  ///< per pixel of the frame
  ProductSet products = {.ao = true};
};

const Row kRows[] = {
    {"ssdo", "ssdo", {}, 16},
    {"ssdo/64-direct", "ssdo", {"samples=64"}, 64, {.direct = true}},
    {"ssdo/64-direct-bounce", "ssdo", {"samples=64"}, 128, {.direct = true, .bounce = true}},
    {"ssao", "ssao", {}, 64},
    {"ssao-range", "ssao-range", {}, 64},
    {"ssao-fade", "ssao-fade", {}, 14 / 4.0},
    {"ssao-fade/along-surfaces", "ssao-fade", {"upsampling=2"}, 14 / 4.0},
    {"ssao-fade/every-pixel", "ssao-fade", {"upsampling=0"}, 14},
    {"sao", "sao", {}, 11},
    {"hbao", "hbao", {}, 12},
    {"msvo", "msvo", {}, 36 * 85 / 256.0},
    {"gtao", "gtao", {}, 8},
    {"gtao/9x3", "gtao", {"slices=9", "steps=3"}, 54},
    {"gtao/reflection", "gtao", {}, 8, {.ao = true, .reflection = true}},
};

struct FilterRow {
  const char* name;
  double taps;  ///< per pixel
};

const FilterRow kFilterRows[] = {
    {"box", 16}, {"gaussian", 3 * 22}, {"normal", 14}, {"depth", 18}, {"geometry", 16}};

void count_samples(benchmark::State& state, double samples) {
  using benchmark::Counter;
  state.counters["ns/sample"] =
      Counter(samples * 1e-9, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void estimate(benchmark::State& state, const std::string& isa, const Row& row, int threads) {
  force_isa(isa);
  const ThreadLimit limit(threads);
  const Geometry& g = frame_of(1920, 1080);
  const Method& method = find_method(row.method);
  const Scene scene = scene_of(g, Environment::constant(glm::vec3(1)), 0.5f);
  const Request request{.products = row.products,
                        .radius = 0.3f * g.frame_height_at(kDepth),
                        .bounces = row.products.bounce ? 1 : 0,
                        .parameters = resolve_parameters(method, row.set)};
  for (auto _ : state) benchmark::DoNotOptimize(method.estimate(scene, request, {}));
  count_samples(state, double(g.surfaces.size()) * row.samples);
}

void filter(benchmark::State& state, const std::string& isa, const FilterRow& row, int threads) {
  force_isa(isa);
  const ThreadLimit limit(threads);
  const Geometry& g = frame_of(1920, 1080);
  Products noisy;
  noisy.ao = Plane<float>(g.surfaces.width, g.surfaces.height, 0.5f);
  for (auto _ : state)
    benchmark::DoNotOptimize(filter_products(find_filter(row.name), noisy, g.surfaces, 4));
  count_samples(state, double(g.surfaces.size()) * row.taps);
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime();
}

/// Registers before main does what it does.
const bool kAdded = [] {
  for (const std::string isa : {"avx512", "avx2", "neon", "scalar"}) {
    for (const int threads : {1, 2}) {
      const std::string where = "/" + isa + "/threads:" + std::to_string(threads);
      for (const Row& row : kRows)
        add("seeds/" + (row.name + where),
            [=](benchmark::State& s) { estimate(s, isa, row, threads); });
      for (const FilterRow& row : kFilterRows)
        add("filters/" + (row.name + where),
            [=](benchmark::State& s) { filter(s, isa, row, threads); });
    }
  }
  return true;
}();

}  // namespace
}  // namespace ssdo::bench
