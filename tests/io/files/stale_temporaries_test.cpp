// SPDX-License-Identifier: Apache-2.0
#include "io/files/stale_temporaries.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "io/files/output_path.h"
#include "io/files/safe_file.h"
#include "support/run_tool.h"

namespace fs = std::filesystem;

namespace ssdo::test::stale_temporaries_test {
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

/// The id of a process that has ended.
pid_t id_of_the_gone() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
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
  file.commit();
  EXPECT_THAT(listing(dir.path()), testing::ElementsAre("a.exr"));
}

TEST(StaleTemporaries, OfOtherMachinesAndOtherFilesStay) {
  const TempDir dir;
  const std::string mark = mark_of_machine(), owner = std::to_string(id_of_the_gone());
  ASSERT_EQ(mark.size(), 22u) << mark;
  for (const std::string& name :
       {".a.ssdo-0000000000000000-" + owner + "-00000000.tmp.exr",
        "a" + mark + "-" + owner + "-00000000.tmp.exr", ".a" + mark + "-" + owner + "-00000000.exr",
        ".a" + mark + "-" + owner + ".tmp.exr", ".a" + mark + "-x-00000000.tmp.exr"})
    std::ofstream(dir / name) << "mine";
  EXPECT_THAT(remove_stale_temporaries(dir.path()), testing::IsEmpty());
  std::ofstream(dir / (".a" + mark + "-" + owner + "-00000000.tmp.exr"));
  EXPECT_EQ(remove_stale_temporaries(dir.path()).size(), 1u) << "the name that all others miss";
  EXPECT_EQ(listing(dir.path()).size(), 5u);
}

TEST(StaleTemporaries, AFolderThatIsMissingHasNone) {
  const TempDir dir;
  EXPECT_THAT(remove_stale_temporaries(dir / "none"), testing::IsEmpty());
}

}  // namespace
}  // namespace ssdo::test::stale_temporaries_test
