// SPDX-License-Identifier: Apache-2.0
//
// What ao of the default method costs, as a ratio to the bare loads that it cannot do without, in
// one run and on one thread. A machine that others share says nothing exact: the figure is left in
// the build folder and held to nothing but its being there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ctime>

#include "bench/ball_frame.h"
#include "bench/bare_loads.h"
#include "estimators/bitmask/request.h"
#include "parallel/tiles.h"
#include "support/report.h"

namespace ssdo::test {
namespace {

constexpr int kSlices = 2, kSteps = 24;

/// The least CPU time of three runs, in seconds.
template <class Work>
double seconds(const Work& work) {
  double best = HUGE_VAL;
  for (int run = 0; run < 3; ++run) {
    const std::clock_t start = std::clock();
    work();
    best = std::min(best, double(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

TEST(Speed, OfAoAsARatioToBareLoads) {
  const ThreadLimit limit(1);
  const std::string isa = choose_isa("");
  const Geometry& g = bench::frame_of(960, 540);
  const Solids solids = guess_solids(g);
  const MarchScene scene = make_march_scene(g, solids);
  const SlicePattern pattern(scene.layout, g.display, kSlices, kSteps, 0);
  const March march{scene, pattern, kNoLimit, true};
  volatile float sum = 0;  // not-a-number, as background is; asked for, so that the loads are made
  const double bare = seconds([&] { sum = bench::bare_loads(march, 0, g.surfel.height); });
  Products products;
  const double ao = seconds([&] {
    products = run(g, {.radius = kNoLimit, .slices = kSlices, .steps = kSteps, .solids = &solids});
  });
  const double samples = double(g.surfel.size()) * kSlices * kSteps * 2 * 1e-9;
  write_report("speed.md", fmt::format("ao of method bitmask, {}, one thread, 960 x 540: {:.3f} ns "
                                       "per sample; bare loads {:.3f}; ratio {:.2f}\n",
                                       isa, ao / samples, bare / samples, ao / bare));
  EXPECT_GT(bare, 0);
  EXPECT_GT(ao, 0);
  EXPECT_EQ(products.ao.size(), g.surfel.size());
}

}  // namespace
}  // namespace ssdo::test
