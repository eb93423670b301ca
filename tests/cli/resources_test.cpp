// SPDX-License-Identifier: Apache-2.0
//
// Which threads and which instruction set a run takes.
#include "cli/resources.h"

#include <ImfThreading.h>
#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <sched.h>

#include <cstdlib>
#include <thread>

#include "cli/threads.h"
#include "simd/isa.h"
#include "support/error_matchers.h"
#include "support/fake_root.h"

namespace ssdo::test {
namespace {

/// An environment without the variables that count, until the end of the test.
class Resource : public testing::Test {
 protected:
  ~Resource() override { choose_isa(""); }

  void SetUp() override {
    for (const char* name : {"SSDO_THREADS", "CUE_THREADS", "SLURM_CPUS_PER_TASK", "SSDO_ISA"}) {
      const char* value = std::getenv(name);
      before_.emplace_back(name, value ? value : "");
      unsetenv(name);
    }
  }
  void TearDown() override {
    for (const auto& [name, value] : before_)
      value.empty() ? unsetenv(name) : setenv(name, value.c_str(), 1);
  }

 private:
  std::vector<std::pair<const char*, std::string>> before_;
};

TEST_F(Resource, ThreadsAreThoseOfTheUserBeforeThoseOfASchedulerBeforeTheProcessors) {
  setenv("SLURM_CPUS_PER_TASK", "6", 1);
  EXPECT_EQ(choose_thread_count(std::nullopt), 6);
  setenv("CUE_THREADS", "5", 1);
  EXPECT_EQ(choose_thread_count(std::nullopt), 5);
  setenv("SSDO_THREADS", "4", 1);
  EXPECT_EQ(choose_thread_count(std::nullopt), 4);
  EXPECT_EQ(choose_thread_count(3), 3);
}

TEST_F(Resource, ThreadsOfASchedulerThatAreNoCountArePassedOver) {
  setenv("SLURM_CPUS_PER_TASK", "6", 1);
  for (const char* value : {"", "many", "0", "-2", "2.5", "4097", "1e9", "nan"}) {
    setenv("CUE_THREADS", value, 1);
    EXPECT_EQ(choose_thread_count(std::nullopt), 6) << value;
  }
}

TEST_F(Resource, ThreadsOfTheUserThatAreNoCountAreRefused) {
  for (const std::string value : {"many", "0", "-2", "2.5", "4097"}) {
    setenv("SSDO_THREADS", value.c_str(), 1);
    EXPECT_THAT(error_of([&] { choose_thread_count(std::nullopt); }),
                IsError(ExitCode::usage, "'" + value + "'"));
  }
}

TEST_F(Resource, ThreadsAreNoMoreThanTheProcessorsOfTheThread) {
  cpu_set_t all;
  ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
  int chosen = 0;
  std::thread([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    int first = 0;
    while (!CPU_ISSET(first, &all)) ++first;
    CPU_SET(first, &one);
    if (sched_setaffinity(0, sizeof one, &one) == 0) chosen = choose_thread_count(std::nullopt);
  }).join();
  EXPECT_EQ(chosen, 1);
  EXPECT_LE(choose_thread_count(std::nullopt), CPU_COUNT(&all));
}

TEST_F(Resource, ThreadsAreNoMoreThanTheLeastQuotaOfTheControlGroups) {
  for (const auto& [own, above] :
       {std::pair{"100000 100000", "max 100000"}, {"max 100000", "50000 100000"}}) {
    const FakeRoot root{{"proc/self/cgroup", "0::/job\n"},
                        {"sys/fs/cgroup/job/cpu.max", own},
                        {"sys/fs/cgroup/cpu.max", above}};
    EXPECT_EQ(choose_thread_count(std::nullopt, root.path()), 1) << own << ", " << above;
  }
  const FakeRoot wide{{"sys/fs/cgroup/cpu.max", "100000000 100000"}};
  EXPECT_EQ(choose_thread_count(std::nullopt, wide.path()),
            choose_thread_count(std::nullopt, FakeRoot{}.path()))
      << "a quota is no reason for more threads than processors";
}

TEST(Quota, IsRoundedUpToProcessors) {
  EXPECT_EQ(processors_of_quota("200000 100000"), 2);
  EXPECT_EQ(processors_of_quota("150000 100000"), 2);
  EXPECT_EQ(processors_of_quota("1000 100000"), 1);
  for (const char* none : {"max 100000", "", "200000", "-1 100000", "200000 0"})
    EXPECT_EQ(processors_of_quota(none), std::nullopt) << none;
}

TEST_F(Resource, AreHeldWhileTheyLive) {
  using tbb::global_control;
  const auto most = [] {
    return global_control::active_value(global_control::max_allowed_parallelism);
  };
  const std::size_t before = most();
  {
    const Resources resources(3);
    EXPECT_EQ(resources.threads(), 3);
    EXPECT_EQ(most(), 3u);
    EXPECT_EQ(OPENEXR_IMF_NAMESPACE::globalThreadCount(), 3);
    EXPECT_EQ(resources.isa(), choose_isa(""));
  }
  EXPECT_EQ(most(), before);
}

TEST_F(Resource, TakeTheInstructionSetOfTheUser) {
  setenv("SSDO_ISA", "scalar", 1);
  EXPECT_EQ(Resources(1).isa(), "scalar");
  setenv("SSDO_ISA", "sse9", 1);
  EXPECT_THAT(error_of([&] { const Resources resources(1); }),
              IsError(ExitCode::usage, "$SSDO_ISA is 'sse9'"));
}

}  // namespace
}  // namespace ssdo::test
