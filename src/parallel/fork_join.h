// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef SSDO_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace ssdo {

/// Tells ThreadSanitizer, with which TBB is not compiled, the order that TBB keeps: each task
/// begins after the fork and ends before the join; two tasks have no order. Does nothing in other
/// builds.
class ForkJoin {
 public:
  void fork() { release(&forked_); }

  /// Lives as long as a task, or as long as a wait for all of them.
  class Task {
   public:
    explicit Task(ForkJoin& order) : order_(order) { acquire(&order_.forked_); }
    ~Task() { release(&order_.ended_); }

   private:
    ForkJoin& order_;
  };
  class Join {
   public:
    explicit Join(ForkJoin& order) : order_(order) {}
    ~Join() { acquire(&order_.ended_); }

   private:
    ForkJoin& order_;
  };

 private:
#ifdef SSDO_THREAD_SANITIZER
  static void release(char* address) { __tsan_release(address); }
  static void acquire(char* address) { __tsan_acquire(address); }
#else
  static void release(char*) {}
  static void acquire(char*) {}
#endif

  char forked_ = 0, ended_ = 0;  ///< only their addresses are used
};

}  // namespace ssdo
