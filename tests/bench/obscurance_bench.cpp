// SPDX-License-Identifier: Apache-2.0
//
// Methods sao and msvo on a synthetic frame: spheres on a ground, 1080p. Times are CPU time of one
// thread; "ns/sample" counts 11 taps of each pixel, "ns/pixel" all that a pixel costs.
#include <benchmark/benchmark.h>

#include <cstdlib>

#include "estimators/depth_mips.h"
#include "estimators/msvo_scales.h"
#include "estimators/registry.h"
#include "parallel/isa.h"
#include "parallel/tiles.h"
#include "support/analytic_scene.h"

namespace ssdo::bench {
namespace {

using namespace test;

constexpr float kDepth = 11;  ///< of the middle of the frame, scene units

const Geometry& frame() {
  static const Geometry g = [] {
    const Window window{0, 0, 1920, 1080};
    std::vector<Surface> surfaces = {plane({}, {0, 0, 1})};
    for (int i = 0; i < 16; ++i) {
      const double r = 0.3 + 0.06 * ((i * 7) % 16);
      surfaces.push_back(sphere({-6 + 0.8 * ((i * 5) % 16), -4 + 0.8 * ((i * 3) % 16), r}, r));
    }
    return geometry_of(all_of(surfaces),
                       look_at(camera_from_fov(50, window, 1), {0, -10, 5}, {0, 0, 0}, {0, 0, 1}),
                       window);
  }();
  return g;
}

void per_pixel(benchmark::State& state, const char* name, double count) {
  using benchmark::Counter;
  state.counters[name] = Counter(double(frame().surfel.size()) * count * 1e-9,
                                 Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void estimate(benchmark::State& state, const std::string& isa, const std::string& name,
              float radius_px) {
  setenv("SSDO_ISA", isa.c_str(), 1);
  const ThreadLimit limit(1);
  const Method& method = find_method(name);
  const ParameterValues parameters = resolve_parameters(method, {});
  const Geometry& g = frame();
  const Plane<glm::vec3> none;
  const Environment sky = Environment::constant(glm::vec3(1));
  const float radius = radius_px * kDepth / float(g.camera.fy);
  const EstimateInput in{g, none, none, sky, {.ao = true}, radius, 0, 0, parameters, {}};
  for (auto _ : state) benchmark::DoNotOptimize(method.estimate(in));
  per_pixel(state, "ns/pixel", 1);
  if (name == "sao") per_pixel(state, "ns/sample", 11);
}

void view_planes(benchmark::State& state) {
  const ThreadLimit limit(1);
  for (auto _ : state) benchmark::DoNotOptimize(make_view_planes(frame()));
  per_pixel(state, "ns/pixel", 1);
}

void depth_mips(benchmark::State& state) {
  const ThreadLimit limit(1);
  const ViewPlanes planes = make_view_planes(frame());
  for (auto _ : state) benchmark::DoNotOptimize(DepthMips(planes));
  per_pixel(state, "ns/pixel", 1);
}

void depth_scales(benchmark::State& state) {
  const ThreadLimit limit(1);
  const ViewPlanes planes = make_view_planes(frame());
  for (auto _ : state) benchmark::DoNotOptimize(make_depth_scales(planes, 4));
  per_pixel(state, "ns/pixel", 1);
}

void add(const std::string& name, const auto& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime();
}

void add_all() {
  for (const std::string isa : {"avx512", "avx2", "scalar"}) {
    for (const float radius : {16.0f, 128.0f, 512.0f}) {
      add("sao/" + isa + "/radius:" + std::to_string(int(radius)),
          [=](auto& s) { estimate(s, isa, "sao", radius); });
    }
    add("msvo/" + isa, [=](auto& s) { estimate(s, isa, "msvo", 100); });
  }
  add("view_planes", view_planes);
  add("depth_mips", depth_mips);
  add("depth_scales", depth_scales);
}

}  // namespace
}  // namespace ssdo::bench

int main(int argc, char** argv) {
  ssdo::bench::add_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
