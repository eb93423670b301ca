// SPDX-License-Identifier: Apache-2.0
#include "jobs/machine/resources.h"

#include <fmt/format.h>

#include <stdexcept>

#include "error.h"
#include "io/size_guard.h"
#include "io/threads.h"
#include "jobs/machine/environment.h"
#include "jobs/machine/memory.h"
#include "jobs/machine/threads.h"
#include "simd/isa.h"

namespace ssdo {

Resources::Resources(std::optional<int> requested_threads,
                     std::optional<std::size_t> requested_memory)
    : wanted_threads_(choose_thread_count(requested_threads)),
      threads_(startable_threads(wanted_threads_)),
      memory_(choose_memory(requested_memory)),
      limit_(threads_),
      isa_(choose_isa(variable("SSDO_ISA"))) {
  limit_memory(double(memory_));
  try {
    limit_io_threads(threads_);
    start_threads(threads_);
  } catch (const std::runtime_error&) {
    throw Error(ExitCode::failed, kNoThread);
  }
}

std::string Resources::warning() const {
  if (threads_ == wanted_threads_) return "";
  return fmt::format(
      "{} of {} threads are used, as no more can be started; raise the limits on "
      "processes (ulimit -u) and memory (ulimit -v)",
      threads_, wanted_threads_);
}

}  // namespace ssdo
