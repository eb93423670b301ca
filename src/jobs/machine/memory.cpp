// SPDX-License-Identifier: Apache-2.0
#include "jobs/machine/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <vector>

#include "error.h"
#include "io/size_guard.h"
#include "jobs/machine/control_groups.h"
#include "jobs/machine/environment.h"
#include "math/number.h"

namespace ssdo {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;
constexpr double kLeast = 64 * kMiB, kMost = 1024 * 1024 * kMiB * 1024;

/// The part of the available memory that a run uses by default. The rest is for the system, other
/// processes and what libraries allocate.
constexpr double kDefaultShare = 0.75;

std::optional<std::size_t> memory_from_user() {
  const std::string_view text = variable("SSDO_MEM_LIMIT");
  if (text.empty()) return std::nullopt;
  if (const auto size = parse_size(text)) return size;
  throw Error(ExitCode::usage,
              fmt::format("$SSDO_MEM_LIMIT is '{}'; expected {}", text, kSizeForm));
}

/// Nothing for any other text, such as the "max" of control groups.
std::optional<double> parse_positive(std::string_view text) {
  const auto number = parse_number(text);
  return number && *number > 0 ? number : std::nullopt;
}

std::optional<double> from_control_groups(const std::filesystem::path& root) {
  std::optional<double> least;
  const auto take = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) {
      if (const auto bytes = parse_positive(line)) least = std::min(*bytes, least.value_or(*bytes));
    }
  };
  take(lines_of_control_groups("", "memory.max", root));
  take(lines_of_control_groups("memory", "memory.limit_in_bytes", root));
  return least;
}

std::optional<double> from_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  return double(limit.rlim_cur);
}

/// Slurm counts in units of 1024 x 1024 bytes (sbatch(1)).
std::optional<double> from_slurm() {
  if (const auto node = parse_positive(variable("SLURM_MEM_PER_NODE"))) return *node * kMiB;
  const auto processor = parse_positive(variable("SLURM_MEM_PER_CPU"));
  if (!processor) return std::nullopt;
  return *processor * parse_positive(variable("SLURM_CPUS_PER_TASK")).value_or(1) * kMiB;
}

}  // namespace

std::optional<std::size_t> parse_size(std::string_view text) {
  constexpr std::string_view kUnits = "kmgt";  // powers of 1024, from the first on
  std::string lower(text);
  for (char& c : lower) c = char(std::tolower(static_cast<unsigned char>(c)));
  const std::size_t place = lower.find_first_of(kUnits);
  if (place == std::string::npos) return std::nullopt;
  const std::string ending = lower.substr(place + 1);
  if (!ending.empty() && ending != "b" && ending != "ib") return std::nullopt;
  const auto number = parse_number(std::string_view(lower).substr(0, place));
  const double bytes = number.value_or(0) * std::pow(1024.0, double(kUnits.find(lower[place])) + 1);
  return bytes >= kLeast && bytes <= kMost ? std::optional(std::size_t(bytes)) : std::nullopt;
}

std::size_t choose_memory(std::optional<std::size_t> requested, const std::filesystem::path& root) {
  if (requested) return *requested;
  if (const auto size = memory_from_user()) return *size;
  double least = physical_memory();
  for (const auto& limit : {from_address_space(), from_control_groups(root), from_slurm()})
    least = std::min(least, limit.value_or(least));
  return std::size_t(kDefaultShare * least);
}

}  // namespace ssdo
