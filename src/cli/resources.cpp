// SPDX-License-Identifier: Apache-2.0
#include "cli/resources.h"

#include <cstdlib>

#include "cli/threads.h"
#include "io/threads.h"
#include "simd/isa.h"

namespace ssdo {
namespace {

std::string wanted_isa() {
  const char* name = std::getenv("SSDO_ISA");
  return name ? name : "";
}

}  // namespace

Resources::Resources(std::optional<int> requested_threads)
    : threads_(choose_thread_count(requested_threads)),
      limit_(threads_),
      isa_(choose_isa(wanted_isa())) {
  limit_io_threads(threads_);
}

}  // namespace ssdo
