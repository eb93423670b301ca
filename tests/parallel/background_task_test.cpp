// SPDX-License-Identifier: Apache-2.0
#include "parallel/background_task.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "parallel/tiles.h"

namespace ssdo::test::background_task_test {
namespace {

TEST(BackgroundJob, AJobIsDoneWhenItWasWaitedFor) {
  BackgroundTask beside;
  beside.wait();  // for nothing
  for (int run = 1; run <= 3; ++run) {
    int sum = 0;
    beside.start([&] { sum = run; });
    beside.wait();
    EXPECT_EQ(sum, run);
  }
}

TEST(BackgroundJob, WaitsForItsJobBeforeItGoes) {
  std::atomic<bool> done = false;
  {
    BackgroundTask beside;
    beside.start([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      done = true;
    });
  }
  EXPECT_TRUE(done);
}

TEST(BackgroundJob, ErrorsOfAJobComeFromWaiting) {
  BackgroundTask beside;
  beside.start([] { throw std::runtime_error("of the job"); });
  EXPECT_THROW(beside.wait(), std::runtime_error);
  beside.wait();
}

/// Loops of the job and of its owner together.
TEST(BackgroundJob, AddsNoThread) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    std::atomic<int> running = 0, most = 0;
    const auto loop = [&] {
      for_each_task(20, [&](std::size_t) {
        const int now = ++running;
        for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        --running;
      });
    };
    BackgroundTask beside;
    beside.start(loop);
    loop();
    beside.wait();
    EXPECT_LE(most, threads);
  }
}

}  // namespace
}  // namespace ssdo::test::background_task_test
