// SPDX-License-Identifier: Apache-2.0
#include "parallel/tiles.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <random>
#include <vector>

#include "parallel/fork_join.h"
#include "parallel/task_order.h"

namespace ssdo {
namespace {

constexpr int kTileSize = 64;  ///< position and normal of 64 x 64 pixels fill half an L2 cache
constexpr int kBandHeight = 16;

std::atomic<unsigned> order_seed = 0;  ///< of ShuffledOrder; 0: none

/// Calls `work(i)` once for each i from 0 to count - 1, which TBB starts in any order.
template <class Index, class Work>
void start(Index count, const Work& work) {
  ForkJoin order;
  order.fork();
  const ForkJoin::Join join(order);
  tbb::parallel_for(Index(0), count, [&](Index i) {
    const ForkJoin::Task task(order);
    work(i);
  });
}

/// The same, in the order of ShuffledOrder where there is one.
template <class Index, class Work>
void run(Index count, const Work& work) {
  const unsigned seed = order_seed;
  if (seed == 0) return start(count, work);
  std::vector<Index> order(std::size_t(std::max(count, Index(0))));
  std::iota(order.begin(), order.end(), Index(0));
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  start(count, [&](Index i) { work(order[std::size_t(i)]); });
}

}  // namespace

void for_each_task(std::size_t count, const std::function<void(std::size_t)>& work,
                   const Progress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  run(count, [&](std::size_t i) {
    work(i);
    if (!progress) return;
    const std::lock_guard lock(mutex);
    progress(++done, count);
  });
}

void for_each_tile(int width, int height, const std::function<void(const Tile&)>& work,
                   const Progress& progress) {
  const int columns = (width + kTileSize - 1) / kTileSize;
  const int rows = (height + kTileSize - 1) / kTileSize;
  const auto one = [&](std::size_t i) {
    const int x0 = int(i % std::size_t(columns)) * kTileSize;
    const int y0 = int(i / std::size_t(columns)) * kTileSize;
    work({x0, y0, std::min(x0 + kTileSize, width), std::min(y0 + kTileSize, height)});
  };
  for_each_task(std::size_t(columns) * std::size_t(rows), one, progress);
}

void for_each_band(int height, const std::function<void(int y0, int y1)>& work,
                   const Progress& progress) {
  const auto one = [&](std::size_t i) {
    const int y0 = int(i) * kBandHeight;
    work(y0, std::min(y0 + kBandHeight, height));
  };
  for_each_task(std::size_t((height + kBandHeight - 1) / kBandHeight), one, progress);
}

void for_each_row(int height, const std::function<void(int y)>& work) { run(height, work); }

std::size_t count_over_rows(int height, const std::function<std::size_t(int y)>& count_in) {
  std::atomic<std::size_t> count = 0;
  for_each_row(height, [&](int y) { count += count_in(y); });
  return count;
}

struct ThreadLimit::Control {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, std::size_t(count)}}) {}

ThreadLimit::~ThreadLimit() { delete control_; }

ShuffledOrder::ShuffledOrder(unsigned seed) { order_seed = seed; }

ShuffledOrder::~ShuffledOrder() { order_seed = 0; }

}  // namespace ssdo
