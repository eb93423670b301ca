// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "parallel/tiles.h"

namespace ssdo {

/// The threads, the memory and the instruction set of a run, chosen once before any work. The limit
/// on threads lasts as long as this object.
class Resources {
 public:
  /// Limits the whole process to the threads of choose_thread_count(), as far as they can be
  /// started, and starts them; and to the instruction set that $SSDO_ISA names. Errors: those of
  /// choose_thread_count(), startable_threads(), choose_memory() and choose_isa();
  /// ExitCode::failed where a thread no longer starts.
  explicit Resources(std::optional<int> requested_threads,
                     std::optional<std::size_t> requested_memory = std::nullopt);

  int threads() const { return threads_; }
  /// Says if there are fewer threads than chosen, because no more can be started; else empty.
  std::string warning() const;
  std::size_t memory() const { return memory_; }   ///< bytes that the run may use
  const std::string& isa() const { return isa_; }  ///< avx512, avx2, neon or scalar

 private:
  int wanted_threads_, threads_;
  std::size_t memory_;
  ThreadLimit limit_;
  std::string isa_;
};

}  // namespace ssdo
