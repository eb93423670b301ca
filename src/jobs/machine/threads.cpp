// SPDX-License-Identifier: Apache-2.0
#include "jobs/machine/threads.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "error.h"
#include "jobs/machine/control_groups.h"
#include "jobs/machine/environment.h"
#include "math/number.h"

namespace ssdo {
namespace {

/// A whole number from 1 to kMostThreads; nothing for any other text.
std::optional<int> parse_count(std::string_view text) {
  const auto count = parse_number(text);
  const bool fits = count && *count >= 1 && *count <= kMostThreads && *count == std::floor(*count);
  return fits ? std::optional(int(*count)) : std::nullopt;
}

std::optional<int> threads_from_user() {
  const std::string_view text = variable("SSDO_THREADS");
  if (text.empty()) return std::nullopt;
  if (const auto count = parse_count(text)) return count;
  throw Error(ExitCode::usage,
              fmt::format("$SSDO_THREADS is '{}'; expected a number of threads from 1 to {}", text,
                          kMostThreads));
}

/// The number of processors, limited by the CPU quotas of the control groups.
int within_quotas(int processors, const std::filesystem::path& root) {
  for (const std::string& line : lines_of_control_groups("", "cpu.max", root))
    processors = std::min(processors, processors_of_quota(line).value_or(processors));
  return processors;
}

int from_affinity() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? std::max(1, CPU_COUNT(&set)) : 1;
}

/// Beside the first thread: each of the three libraries has its own, and what OpenImageIO is linked
/// with starts five or six (Debian 12).
constexpr int kPools = 3, kOthers = 6;

}  // namespace

int choose_thread_count(std::optional<int> requested, const std::filesystem::path& root) {
  if (requested) return *requested;
  if (const auto count = threads_from_user()) return *count;
  for (const char* name : {"CUE_THREADS", "SLURM_CPUS_PER_TASK"}) {
    if (const auto count = parse_count(variable(name))) return *count;
  }
  return within_quotas(from_affinity(), root);
}

int startable_threads(int count) {
  const int startable = count_startable(kPools * (count - 1) + kOthers);
  if (startable < kOthers) {
    throw Error(ExitCode::failed,
                fmt::format("only {} threads can be started, and a run needs {}; raise the limits "
                            "on processes (ulimit -u) and memory (ulimit -v)",
                            startable, kOthers));
  }
  return 1 + (startable - kOthers) / kPools;
}

std::optional<int> processors_of_quota(const std::string& cpu_max) {
  std::istringstream in(cpu_max);
  double quota = 0, period = 0;
  if (!(in >> quota >> period) || quota <= 0 || period <= 0) return std::nullopt;
  return std::max(1, int(std::ceil(quota / period)));
}

}  // namespace ssdo
