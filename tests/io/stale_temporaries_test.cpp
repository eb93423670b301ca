// SPDX-License-Identifier: Apache-2.0
#include "io/stale_temporaries.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <thread>

#include "io/output_path.h"
#include "io/safe_file.h"
#include "support/run_tool.h"

namespace fs = std::filesystem;

namespace ssdo::test {
namespace {

/// Leaves what a process leaves that is killed while it writes `target`.
void write_and_be_killed(const fs::path& target) {
  const pid_t child = fork();
  if (child == 0) {
    SafeFile file(target, {});
    std::ofstream(file.temporary()) << "half of a frame";
    std::raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
}

TEST(StaleTemporaries, OfKilledProcessesAreRemoved) {
  const TempDir dir;
  write_and_be_killed(dir / "a.0001.exr");
  write_and_be_killed(dir / "a.0002.png");
  ASSERT_EQ(listing(dir.path()).size(), 2u);
  EXPECT_EQ(remove_stale_temporaries(dir.path()).size(), 2u);
  EXPECT_THAT(listing(dir.path()), testing::IsEmpty());
}

TEST(StaleTemporaries, OfAProcessThatLivesStay) {
  const TempDir dir;
  SafeFile file(dir / "a.exr", {});
  EXPECT_THAT(remove_stale_temporaries(dir.path()), testing::IsEmpty());
  std::ofstream(file.temporary()) << "a frame";  // as a library does it: closed after that
  EXPECT_THAT(remove_stale_temporaries(dir.path()), testing::IsEmpty());
  file.commit();
  EXPECT_THAT(listing(dir.path()), testing::ElementsAre("a.exr"));
}

TEST(StaleTemporaries, OfOtherMachinesAndOtherFilesStay) {
  const TempDir dir;
  const std::string mark = mark_of_machine();
  ASSERT_EQ(mark.size(), 14u) << mark;
  for (const std::string& name :
       {std::string(".a.ssdo-00000000-1-00000000.tmp.exr"), "a" + mark + "-1-00000000.tmp.exr",
        ".a" + mark + "-1-00000000.exr", ".a" + mark + ".tmp.exr"})
    std::ofstream(dir / name) << "mine";
  ASSERT_EQ(mkfifo((dir / (".a" + mark + "-1-00000000.tmp.exr")).c_str(), 0600), 0);
  remove_stale_temporaries(dir.path());
  EXPECT_EQ(listing(dir.path()).size(), 4u) << "all but the pipe, and no waiting for that";
}

TEST(StaleTemporaries, AFolderThatIsMissingHasNone) {
  const TempDir dir;
  EXPECT_THAT(remove_stale_temporaries(dir / "none"), testing::IsEmpty());
}

/// Tasks of an array begin while others write into the same folder.
TEST(StaleTemporaries, AreNotThoseThatAreJustMade) {
  const TempDir dir;
  std::atomic<bool> done = false;
  std::thread sweeper([&] {
    while (!done) remove_stale_temporaries(dir.path());
  });
  for (int i = 0; i < 1000; ++i) {
    SafeFile file(dir / "a.exr", {.overwrite = true});
    EXPECT_TRUE(fs::exists(file.temporary())) << i;
  }
  done = true;
  sweeper.join();
}

}  // namespace
}  // namespace ssdo::test
