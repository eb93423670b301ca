// SPDX-License-Identifier: Apache-2.0
//
// Which threads, how much memory and which instruction set a run takes.
#include "jobs/machine/resources.h"

#include <ImfThreading.h>
#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "io/size_guard.h"
#include "jobs/machine/memory.h"
#include "jobs/machine/threads.h"
#include "simd/isa.h"
#include "support/chosen_isa.h"
#include "support/error_matchers.h"
#include "support/fake_root.h"

namespace ssdo::test::resources_test {
namespace {

/// An environment without the variables that count, until the end of the test.
class Resource : public testing::Test {
 protected:
  ~Resource() override { choose_isa(""); }

  void SetUp() override {
    for (const char* name : {"SSDO_THREADS", "CUE_THREADS", "SLURM_CPUS_PER_TASK", "SSDO_MEM_LIMIT",
                             "SLURM_MEM_PER_NODE", "SLURM_MEM_PER_CPU", "SSDO_ISA"}) {
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

/// What a child process gets that may have no more than `threads` beside its own, of `wanted`.
/// Memory for stacks is what limits them here; root is limited by no number of processes.
int startable_with_room_for(int threads, int wanted) {
  const pid_t child = fork();
  if (child == 0) {
    int status = 99;
    try {
      constexpr rlim_t stack = 64 << 20;
      pthread_attr_t stacks;
      pthread_attr_init(&stacks);
      pthread_attr_setstacksize(&stacks, stack);
      pthread_setattr_default_np(&stacks);
      std::ifstream in("/proc/self/statm");
      rlim_t pages = 0;
      in >> pages;
      const rlim_t room =
          pages * rlim_t(sysconf(_SC_PAGESIZE)) + rlim_t(2 * threads + 1) * stack / 2;
      const rlimit space{room, room};
      setrlimit(RLIMIT_AS, &space);
      status = startable_threads(wanted);
    } catch (const Error& error) {
      status = error.code == ExitCode::failed ? 0 : 98;
    }
    _exit(status);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(StartableThreads, AreThoseThatCanBeStarted) {
  EXPECT_EQ(startable_threads(1), 1);
  EXPECT_EQ(startable_threads(4), 4);
  EXPECT_EQ(startable_with_room_for(15, 4), 4);
  EXPECT_EQ(startable_with_room_for(14, 4), 3);
  EXPECT_EQ(startable_with_room_for(6, 4), 1);
  EXPECT_EQ(startable_with_room_for(5, 4), 0) << "an error";
}

TEST(Quota, IsRoundedUpToProcessors) {
  EXPECT_EQ(processors_of_quota("200000 100000"), 2);
  EXPECT_EQ(processors_of_quota("150000 100000"), 2);
  EXPECT_EQ(processors_of_quota("1000 100000"), 1);
  for (const char* none : {"max 100000", "", "200000", "-1 100000", "200000 0"})
    EXPECT_EQ(processors_of_quota(none), std::nullopt) << none;
}

constexpr std::size_t kMiB = std::size_t(1) << 20;

TEST(Size, IsANumberAndAPowerOf1024) {
  const std::vector<std::pair<std::string, std::size_t>> sizes = {
      {"65536K", 64 * kMiB}, {"64M", 64 * kMiB},    {"500M", 500 * kMiB},
      {"8G", 8192 * kMiB},   {"1.5G", 1536 * kMiB}, {"1024T", kMiB * kMiB * 1024},
      {"8g", 8192 * kMiB},   {"8GB", 8192 * kMiB},  {"8GiB", 8192 * kMiB},
      {"8gb", 8192 * kMiB},  {"500mib", 500 * kMiB}};
  for (const auto& [text, bytes] : sizes) EXPECT_EQ(parse_size(text), bytes) << text;
}

TEST(Size, IsNoOtherText) {
  for (const char* text :
       {"",    "8",  "8B",  "8.5",  "G",    "8 G",  " 8G",  "8G ",    "8Gi", "8Gb/s", "8GG",   "8E",
        "80%", "0G", "-8G", "nanG", "infG", "0x8G", "8,5G", "65535K", "63M", "1025T", "1e300T"})
    EXPECT_EQ(parse_size(text), std::nullopt) << text;
}

/// What is left as the default of so many bytes.
std::size_t default_of(double bytes) { return std::size_t(0.75 * bytes); }

/// What a run in groups with these limits may use: its own and those above it.
std::size_t memory_in(const std::string& own, const std::string& above) {
  const FakeRoot root{{"proc/self/cgroup", "0::/job\n"},
                      {"sys/fs/cgroup/job/memory.max", own},
                      {"sys/fs/cgroup/memory.max", above}};
  return choose_memory(std::nullopt, root.path());
}

TEST_F(Resource, MemoryIsThatOfTheUserBeforeWhatThereIs) {
  const FakeRoot root{{"sys/fs/cgroup/memory.max", "1000000"}};
  setenv("SLURM_MEM_PER_NODE", "2", 1);
  setenv("SSDO_MEM_LIMIT", "1024T", 1);
  EXPECT_EQ(choose_memory(std::nullopt, root.path()), kMiB * kMiB * 1024);
  EXPECT_EQ(choose_memory(7, root.path()), 7u);
}

TEST_F(Resource, MemoryOfTheUserThatIsNoSizeIsRefused) {
  for (const std::string value : {"8", "-8G", "0G", "many", "1M"}) {
    setenv("SSDO_MEM_LIMIT", value.c_str(), 1);
    EXPECT_THAT(error_of([&] { choose_memory(std::nullopt); }),
                IsError(ExitCode::usage, "$SSDO_MEM_LIMIT is '" + value + "'; expected a size"));
    EXPECT_EQ(choose_memory(7), 7u) << "the option wins";
  }
}

TEST_F(Resource, MemoryIsThreeQuartersOfTheMachinesWhereNothingLimitsIt) {
  const std::size_t all = default_of(physical_memory());
  EXPECT_EQ(choose_memory(std::nullopt, FakeRoot{}.path()), all);
  EXPECT_EQ(memory_in("max", "max"), all);
  EXPECT_EQ(memory_in("9223372036854771712", "-1"), all);
}

TEST_F(Resource, MemoryIsThreeQuartersOfTheLeastLimit) {
  EXPECT_EQ(memory_in("40000000", "max"), 30000000u);
  EXPECT_EQ(memory_in("max", "40000000"), 30000000u);
  EXPECT_EQ(memory_in("40000000", "80000000"), 30000000u);
  EXPECT_EQ(memory_in("80000000", "40000000"), 30000000u);
  const FakeRoot v1{{"proc/self/cgroup", "4:memory:/job\n0::/\n"},
                    {"sys/fs/cgroup/memory/job/memory.limit_in_bytes", "40000000"},
                    {"sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712"}};
  EXPECT_EQ(choose_memory(std::nullopt, v1.path()), 30000000u);
}

TEST_F(Resource, MemoryIsNoMoreThanTheAddressSpace) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit space{rlim_t(8) << 30, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &space), 0);
  EXPECT_EQ(memory_in("max", "max"), std::min(default_of(physical_memory()), 6144 * kMiB));
  setrlimit(RLIMIT_AS, &before);
}

TEST_F(Resource, MemoryIsNoMoreThanSlurmGrants) {
  const FakeRoot root{{"sys/fs/cgroup/memory.max", "40000000"}};
  const auto chosen = [&] { return choose_memory(std::nullopt, root.path()); };
  setenv("SLURM_MEM_PER_CPU", "8", 1);
  EXPECT_EQ(chosen(), 6 * kMiB);
  setenv("SLURM_CPUS_PER_TASK", "3", 1);
  EXPECT_EQ(chosen(), 18 * kMiB);
  setenv("SLURM_CPUS_PER_TASK", "300", 1);
  EXPECT_EQ(chosen(), 30000000u);
  setenv("SLURM_MEM_PER_NODE", "12", 1);
  EXPECT_EQ(chosen(), 9 * kMiB);
  unsetenv("SLURM_MEM_PER_CPU");
  for (const char* value : {"", "0", "-4", "many"}) {
    setenv("SLURM_MEM_PER_NODE", value, 1);
    EXPECT_EQ(chosen(), 30000000u) << value;
  }
}

TEST_F(Resource, AreHeldWhileTheyLive) {
  using tbb::global_control;
  const auto most = [] {
    return global_control::active_value(global_control::max_allowed_parallelism);
  };
  const std::size_t before = most();
  {
    const Resources resources(3, 100 * kMiB);
    EXPECT_EQ(resources.threads(), 3);
    EXPECT_EQ(resources.memory(), 100 * kMiB);
    EXPECT_EQ(most(), 3u);
    EXPECT_EQ(OPENEXR_IMF_NAMESPACE::globalThreadCount(), 3);
    EXPECT_EQ(resources.isa(), choose_isa(""));
  }
  EXPECT_EQ(most(), before);
}

TEST_F(Resource, TakeTheInstructionSetOfTheUser) {
  setenv("SSDO_ISA", "sse9", 1);
  EXPECT_THAT(error_of([&] { const Resources resources(1); }),
              IsError(ExitCode::usage, "$SSDO_ISA is 'sse9'"));
  if (!has_isa("scalar")) GTEST_SKIP() << "a build for one instruction set";
  setenv("SSDO_ISA", "scalar", 1);
  EXPECT_EQ(Resources(1).isa(), "scalar");
}

}  // namespace
}  // namespace ssdo::test::resources_test
