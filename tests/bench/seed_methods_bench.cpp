// SPDX-License-Identifier: Apache-2.0
//
// The methods of the seed documents at 1080p with their defaults and the radius that the tool
// chooses. "ns/sample" is CPU time of all threads over the samples that are taken, with all that
// the estimate does besides: planes, upsampling.
#include <benchmark/benchmark.h>

#include "bench/ball_frame.h"
#include "estimators/registry.h"

namespace ssdo::bench {
namespace {

struct Row {
  const char* name;
  const char* method;
  std::vector<std::string> set;
  double samples;  ///< per pixel of the frame
};

const Row kRows[] = {
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
};

void estimate(benchmark::State& state, const std::string& isa, const Row& row, int threads) {
  force_isa(isa);
  const ThreadLimit limit(threads);
  const Geometry& g = frame_of(1920, 1080);
  const Method& method = find_method(row.method);
  const Environment even = Environment::constant(glm::vec3(1));
  const Plane<glm::vec3> none;
  const ParameterValues parameters = resolve_parameters(method, row.set);
  const float radius = 0.3f * g.frame_height_at(kDepth);
  const EstimateInput in{g, none, none, even, {.ao = true}, radius, 0, 0, parameters, {}};
  for (auto _ : state) benchmark::DoNotOptimize(method.estimate(in));
  using benchmark::Counter;
  state.counters["ns/sample"] = Counter(double(g.surfel.size()) * row.samples * 1e-9,
                                        Counter::kIsIterationInvariantRate | Counter::kInvert);
}

/// Registers before main does what it does.
const bool kAdded = [] {
  for (const std::string isa : {"avx512", "avx2", "scalar"}) {
    for (const Row& row : kRows) {
      for (const int threads : {1, 2}) {
        const std::string name =
            std::string("seeds/") + row.name + "/" + isa + "/threads:" + std::to_string(threads);
        benchmark::RegisterBenchmark(name.c_str(),
                                     [=](auto& state) { estimate(state, isa, row, threads); })
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime();
      }
    }
  }
  return true;
}();

}  // namespace
}  // namespace ssdo::bench
