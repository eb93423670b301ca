// SPDX-License-Identifier: Apache-2.0
//
// Standard output whose reader has gone, and one that cannot be written.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "support/run_tool.h"
#include "support/temp_dir.h"

namespace ssdo::test::standard_output_test {
namespace {

/// Runs the tool with standard output on `out`.
Finished run_into(int out, const char* argument) {
  const TempDir dir;
  const std::string err = dir / "err";
  const pid_t child = fork();
  if (child == 0) {
    dup2(out, STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    execl(tool_path().c_str(), "ssdo", argument, nullptr);
    _exit(127);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), "", read_file(err)};
}

TEST(StandardOutput, MayLoseItsReader) {
  for (const char* argument : {"--help", "--version", "--list-methods"}) {
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    close(ends[0]);
    const Finished done = run_into(ends[1], argument);
    close(ends[1]);
    EXPECT_EQ(done.code, 0) << argument;
    EXPECT_EQ(done.err, "") << argument;
  }
}

TEST(StandardOutput, MayNotBeFull) {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  for (const char* argument : {"--help", "--version"}) {
    const Finished done = run_into(full, argument);
    EXPECT_EQ(done.code, 5) << argument;
    EXPECT_EQ(done.err, "ssdo: standard output cannot be written; is its disk full?\n");
  }
  close(full);
}

}  // namespace
}  // namespace ssdo::test::standard_output_test
