// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/options.h"
#include "jobs/run_options.h"
#include "metrics/compare.h"

namespace ssdo {

/// All that a command line says.
struct Options : RunOptions {
  CompareOptions compare;
  BenchOptions bench;
  std::optional<int> threads;            ///< not given: see choose_thread_count()
  std::optional<std::size_t> mem_limit;  ///< in bytes; not given: see choose_memory()
  std::vector<std::string> warnings;     ///< options that have no effect beside the others
};

}  // namespace ssdo
