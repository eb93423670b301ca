// SPDX-License-Identifier: Apache-2.0
#include "cli/resources.h"

#include "cli/environment.h"
#include "cli/memory.h"
#include "cli/threads.h"
#include "io/threads.h"
#include "simd/isa.h"

namespace ssdo {

Resources::Resources(std::optional<int> requested_threads,
                     std::optional<std::size_t> requested_memory)
    : threads_(choose_thread_count(requested_threads)),
      memory_(choose_memory(requested_memory)),
      limit_(threads_),
      isa_(choose_isa(variable("SSDO_ISA"))) {
  limit_io_threads(threads_);
}

}  // namespace ssdo
