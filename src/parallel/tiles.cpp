// SPDX-License-Identifier: Apache-2.0
#include "parallel/tiles.h"

#include <ImfThreading.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "error.h"
#include "math/number.h"

namespace ssdo {
namespace {

constexpr int kTileSize = 64;  ///< position and normal of 64 x 64 pixels fill half an L2 cache
constexpr int kBandHeight = 16;

std::string_view variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// A whole number from 1 to kMostThreads; nothing for any other text.
std::optional<int> parse_count(std::string_view text) {
  const auto count = parse_number(text);
  const bool fits = count && *count >= 1 && *count <= kMostThreads && *count == std::floor(*count);
  return fits ? std::optional(int(*count)) : std::nullopt;
}

std::optional<int> from_user() {
  const std::string_view text = variable("SSDO_THREADS");
  if (text.empty()) return std::nullopt;
  if (const auto count = parse_count(text)) return count;
  throw Error(ExitCode::usage,
              fmt::format("$SSDO_THREADS is '{}'; expected a number of threads from 1 to {}", text,
                          kMostThreads));
}

/// The quota of control groups v2, rounded up: "200000 100000" are two processors.
std::optional<int> from_control_group() {
  std::ifstream in("/sys/fs/cgroup/cpu.max");
  double quota = 0, period = 0;
  if (!(in >> quota >> period) || quota <= 0 || period <= 0) return std::nullopt;
  return std::max(1, int(std::ceil(quota / period)));
}

int from_affinity() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? std::max(1, CPU_COUNT(&set)) : 1;
}

/// Calls `work(i)` for i from 0 to count - 1.
void for_each_task(std::size_t count, const std::function<void(std::size_t)>& work,
                   const Progress& progress) {
  std::mutex mutex;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    work(i);
    if (!progress) return;
    const std::lock_guard lock(mutex);
    progress(++done, count);
  });
}

}  // namespace

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

void for_each_row(int height, const std::function<void(int y)>& work) {
  tbb::parallel_for(0, height, work);
}

int choose_thread_count(int requested) {
  if (requested > 0) return requested;
  if (const auto count = from_user()) return *count;
  for (const char* name : {"CUE_THREADS", "SLURM_CPUS_PER_TASK"}) {
    if (const auto count = parse_count(variable(name))) return *count;
  }
  const int processors = from_affinity();
  return std::min(processors, from_control_group().value_or(processors));
}

struct ThreadLimit::Control {
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, std::size_t(count)}}) {
  // OpenEXR counts helpers beside the calling thread: 0 makes it work alone.
  OPENEXR_IMF_NAMESPACE::setGlobalThreadCount(count == 1 ? 0 : count);
  // OpenImageIO starts $CUE_THREADS threads, be they 99999, before it can be told another number.
  setenv("OPENIMAGEIO_THREADS", std::to_string(count).c_str(), 1);
  OIIO::attribute("threads", count);
  OIIO::attribute("exr_threads", count == 1 ? -1 : count);
}

ThreadLimit::~ThreadLimit() { delete control_; }

}  // namespace ssdo
