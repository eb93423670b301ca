// SPDX-License-Identifier: Apache-2.0
#include "parallel/thread_start.h"

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace ssdo {
namespace {

/// The longest wait for threads that a busy machine is slow to start; they may start later.
constexpr std::chrono::milliseconds kLongestWait(200);

/// A barrier at which each task waits for all others, so that no thread runs two tasks.
class Meeting {
 public:
  explicit Meeting(int count) : missing_(count) {}

  void join() {
    std::unique_lock lock(mutex_);
    if (--missing_ == 0) all_.notify_all();
    all_.wait_for(lock, kLongestWait, [this] { return missing_ <= 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable all_;
  int missing_;
};

}  // namespace

int count_startable(int most) {
  std::atomic<bool> done = false;
  std::vector<std::thread> threads;
  try {
    while (int(threads.size()) < most) threads.emplace_back([&done] { done.wait(false); });
  } catch (const std::system_error&) {  // no further thread
  } catch (const std::bad_alloc&) {
  }
  done = true;
  done.notify_all();
  for (std::thread& thread : threads) thread.join();
  return int(threads.size());
}

void start_threads(int count) {
  // TBB uses no more than the machine has processors.
  const int all = std::min(count, tbb::this_task_arena::max_concurrency());
  Meeting meeting(all);
  tbb::task_group tasks;
  for (int i = 1; i < all; ++i) tasks.run([&meeting] { meeting.join(); });
  meeting.join();
  tasks.wait();
}

}  // namespace ssdo
