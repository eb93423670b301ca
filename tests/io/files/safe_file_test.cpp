// SPDX-License-Identifier: Apache-2.0
#include "io/files/safe_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <fstream>
#include <iterator>
#include <memory>
#include <thread>
#include <vector>

#include "io/files/checked_file.h"
#include "io/files/temporary_table.h"
#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace fs = std::filesystem;

namespace ssdo::test::safe_file_test {
namespace {

constexpr OutputPolicy kNew = {};
constexpr OutputPolicy kOverwrite = {.overwrite = true};
constexpr OutputPolicy kCreateDirs = {.create_dirs = true};

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string text_of(const fs::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::size_t files_in(const fs::path& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), {}));
}

void save(const fs::path& path, const std::string& text, const OutputPolicy& policy) {
  SafeFile file(path, policy);
  write_text(file.temporary(), text);
  file.commit();
}

TEST(SafeFile, AppearsOnCommitOnly) {
  const TempDir dir;
  {
    SafeFile file(dir / "a.exr", kNew);
    write_text(file.temporary(), "new");
    EXPECT_FALSE(fs::exists(dir / "a.exr"));
    EXPECT_EQ(file.temporary().parent_path(), dir.path());
    EXPECT_EQ(file.temporary().filename().string()[0], '.');
    EXPECT_EQ(file.temporary().extension(), ".exr");
    file.commit();
  }
  EXPECT_EQ(text_of(dir / "a.exr"), "new");
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(SafeFile, LeavesNothingWithoutCommit) {
  const TempDir dir;
  { SafeFile file(dir / "a.exr", kNew); }
  EXPECT_EQ(files_in(dir.path()), 0u);
}

TEST(SafeFile, SeveralAreRenamedOnceAllAreOnTheDisk) {
  const TempDir dir;
  std::vector<std::unique_ptr<SafeFile>> files;
  for (const char* name : {"a.exr", "b.exr"})
    files.push_back(std::make_unique<SafeFile>(dir / name, kNew));
  const fs::path lost = files[1]->temporary();
  fs::remove(lost);
  EXPECT_THAT(error_of([&] { commit_all(files); }),
              IsError(ExitCode::output, "b.exr: cannot be written"));
  EXPECT_FALSE(fs::exists(dir / "a.exr"));
  write_text(lost, "back");
  commit_all(files);
  EXPECT_EQ(files_in(dir.path()), 2u);
}

TEST(SafeFile, RespectsTheUmask) {
  const TempDir dir;
  const mode_t before = umask(027);
  save(dir / "a.exr", "", kNew);
  umask(before);
  struct stat status = {};
  ASSERT_EQ(stat((dir / "a.exr").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(SafeFile, ReplacesOnlyWithOverwrite) {
  const TempDir dir;
  write_text(dir / "a.exr", "old");
  EXPECT_THAT(error_of([&] { SafeFile(dir / "a.exr", kNew); }),
              IsError(ExitCode::output, "a.exr: exists; give --overwrite"));
  EXPECT_EQ(text_of(dir / "a.exr"), "old");
  save(dir / "a.exr", "new", kOverwrite);
  EXPECT_EQ(text_of(dir / "a.exr"), "new");
}

TEST(SafeFile, DoesNotReplaceWhatAppearedMeanwhile) {
  const TempDir dir;
  {
    SafeFile file(dir / "a.exr", kNew);
    write_text(dir / "a.exr", "another's");
    EXPECT_THAT(error_of([&] { file.commit(); }),
                IsError(ExitCode::output, "appeared while it was being made"));
  }
  EXPECT_EQ(text_of(dir / "a.exr"), "another's");
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(SafeFile, WritesThroughLinks) {
  const TempDir dir;
  fs::create_directory(dir / "store");
  write_text(dir / "store/real.exr", "old");
  fs::create_symlink("store/real.exr", dir / "link.exr");
  fs::create_symlink("store/later.exr", dir / "dangling.exr");
  save(dir / "link.exr", "new", kOverwrite);
  save(dir / "dangling.exr", "made", kOverwrite);
  EXPECT_TRUE(fs::is_symlink(dir / "link.exr"));
  EXPECT_TRUE(fs::is_symlink(dir / "dangling.exr"));
  EXPECT_EQ(text_of(dir / "store" / "real.exr"), "new");
  EXPECT_EQ(text_of(dir / "store" / "later.exr"), "made");
}

TEST(SafeFile, FollowsNoLinkWithoutOverwrite) {
  const TempDir dir;
  write_text(dir / "real.exr", "old");
  fs::create_symlink("real.exr", dir / "link.exr");
  fs::create_symlink("later.exr", dir / "dangling.exr");
  EXPECT_THAT(error_of([&] { check_output(dir / "link.exr", kNew); }),
              IsError(ExitCode::output, "link.exr: exists"));
  EXPECT_THAT(error_of([&] { check_output(dir / "dangling.exr", kNew); }),
              IsError(ExitCode::output, "is a symbolic link to 'later.exr', which does not exist"));
}

TEST(SafeFile, FollowsNoLinkThatAppearedMeanwhile) {
  const TempDir dir;
  fs::create_directory(dir / "elsewhere");
  for (const OutputPolicy& policy : {kNew, kOverwrite}) {
    fs::remove(dir / "a.exr");
    SafeFile file(dir / "a.exr", policy);
    write_text(file.temporary(), "new");
    fs::create_symlink("elsewhere/a.exr", dir / "a.exr");
    if (policy.overwrite)
      file.commit();
    else
      EXPECT_EQ(error_of([&] { file.commit(); }).code, ExitCode::output);
    EXPECT_EQ(fs::is_symlink(dir / "a.exr"), !policy.overwrite);
    EXPECT_EQ(files_in(dir / "elsewhere"), 0u);
  }
}

TEST(SafeFile, LinksInACircleAreAnError) {
  const TempDir dir;
  fs::create_symlink("b.exr", dir / "a.exr");
  fs::create_symlink("a.exr", dir / "b.exr");
  EXPECT_EQ(error_of([&] { SafeFile(dir / "a.exr", kOverwrite); }).code, ExitCode::output);
}

TEST(SafeFile, TakesTheLongestNameOfTheFileSystem) {
  const TempDir dir;
  std::string name;
  while (name.size() < 250) name += "é";  // two bytes each
  name.resize(250);
  save(dir / (name + ".exr"), "new", kNew);
  EXPECT_EQ(text_of(dir / (name + ".exr")), "new");
  EXPECT_THAT(error_of([&] { check_output(dir / (name + "more.exr"), kNew); }),
              IsError(ExitCode::output, "File name too long"));
}

TEST(SafeFile, WorksInTheCurrentFolder) {
  const TempDir dir;
  const fs::path before = fs::current_path();
  fs::current_path(dir.path());
  save("plain.exr", "new", kNew);
  fs::current_path(before);
  EXPECT_EQ(text_of(dir / "plain.exr"), "new");
}

TEST(SafeFile, SeveralAtOnceDoNotMeet) {
  const TempDir dir;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&dir, t] {
      for (int i = 0; i < 20; ++i) {
        const std::string name = std::to_string(t) + "." + std::to_string(i);
        SafeFile first(dir / (name + ".a"), kNew), second(dir / (name + ".b"), kNew);
        SafeFile rival(dir / (name + ".a"), kNew);
        write_text(first.temporary(), name);
        write_text(rival.temporary(), "rival");
        first.commit();
        second.commit();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(files_in(dir.path()), 8u * 20u * 2u);
  EXPECT_EQ(text_of(dir / "3.7.a"), "3.7");
}

TEST(CheckOutput, SaysWhatIsInTheWay) {
  const TempDir dir;
  write_text(dir / "file", "");
  EXPECT_THAT(error_of([&] { check_output(dir.path(), kOverwrite); }),
              IsError(ExitCode::output, "is a folder"));
  EXPECT_THAT(error_of([&] { check_output(dir / "new/", kCreateDirs); }),
              IsError(ExitCode::output, "has no file name"));
  EXPECT_THAT(error_of([&] { check_output("", kNew); }),
              IsError(ExitCode::output, "has no file name"));
  EXPECT_THAT(error_of([&] { check_output("/dev/null", kOverwrite); }),
              IsError(ExitCode::output, "is a device, pipe or socket"));
  EXPECT_THAT(error_of([&] { check_output(dir / "none/a.exr", kNew); }),
              IsError(ExitCode::output, "does not exist; make it or give --create-dirs"));
  EXPECT_THAT(error_of([&] { check_output(dir / "file/a.exr", kNew); }),
              IsError(ExitCode::output, "is a file, not a folder"));
  EXPECT_THAT(error_of([&] { check_output(dir / "file/sub/a.exr", kCreateDirs); }),
              IsError(ExitCode::output, "is a file, not a folder"));
  // Root may write everywhere, says the kernel, until it is tried.
  EXPECT_THAT(error_of([&] { SafeFile("/proc/a.exr", kNew); }).code, ExitCode::output);
  check_output(dir / "none/deeper/a.exr", kCreateDirs);
  EXPECT_FALSE(fs::exists(dir / "none")) << "a check makes nothing";
}

TEST(CheckOutput, RefusesPipesWithoutBlocking) {
  const TempDir dir;
  ASSERT_EQ(mkfifo((dir / "pipe.exr").c_str(), 0600), 0);
  EXPECT_THAT(error_of([&] { check_output(dir / "pipe.exr", kOverwrite); }),
              IsError(ExitCode::output, "is a device, pipe or socket"));
}

TEST(SafeFile, MakesFoldersWhenAllowed) {
  const TempDir dir;
  save(dir / "one/two/a.exr", "new", kCreateDirs);
  EXPECT_EQ(text_of(dir / "one/two/a.exr"), "new");
}

/// Runs `action` in a child process that never returns to GoogleTest, and gives its exit status.
template <class Action>
int status_of_child(const Action& action) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      action();
    } catch (const Error& error) {
      _exit(int(error.code));
    } catch (...) {
      _exit(99);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

TEST(SafeFile, SignalsRemoveEveryTemporary) {
  const TempDir dir;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGALRM, SIGXCPU, SIGUSR1, SIGUSR2}) {
    EXPECT_EQ(status_of_child([&] {
                std::signal(signal, SIG_DFL);  // what starts the tests may ignore it, as nohup does
                remove_temporaries_on_signals();
                SafeFile first(dir / "a.exr", kNew), second(dir / "b.exr", kNew);
                {
                  SafeFile done(dir / "c.exr", kOverwrite);
                  done.commit();
                }
                if (files_in(dir.path()) != 3) _exit(98);
                raise(signal);
              }),
              128 + signal);
    EXPECT_EQ(files_in(dir.path()), 1u) << "only the committed c.exr stays";
  }
}

TEST(SafeFile, IgnoresAHangupThatTheCallerIgnores) {
  const TempDir dir;
  EXPECT_EQ(status_of_child([&] {
              std::signal(SIGHUP, SIG_IGN);
              remove_temporaries_on_signals();
              SafeFile file(dir / "a.exr", kNew);
              raise(SIGHUP);
              file.commit();
            }),
            0);
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(SafeFile, ASignalWaitsForATemporaryThatIsBeingMade) {
  const TempDir dir;
  EXPECT_EQ(status_of_child([&] {
              remove_temporaries_on_signals();
              std::atomic<bool> begun = false;
              std::thread maker([&] {
                const TableInUse in_use;
                begun = true;
                usleep(100'000);
                write_text(dir / "made", "");
              });
              while (!begun) usleep(1000);
              kill(getpid(), SIGTERM);
              maker.join();
            }),
            128 + SIGTERM);
  EXPECT_EQ(files_in(dir.path()), 1u);
}

TEST(CheckedFile, FullDiskIsAnErrorThatNamesTheTarget) {
  const TempDir dir;
  for (const std::size_t size : {1000u, 5'000'000u}) {  // fails on closing; fails on writing
    EXPECT_EQ(status_of_child([&] {
                remove_temporaries_on_signals();
                const rlimit limit = {100, 100};
                setrlimit(RLIMIT_FSIZE, &limit);
                const SafeFile file(dir / "a.exr", kNew);
                CheckedFile checked(file);
                const Error error = error_of([&] {
                  const std::vector<char> bytes(size);
                  checked.write(bytes.data(), bytes.size());
                  checked.close();
                });
                if (std::string(error.what()).find("a.exr: cannot be written: File too large") ==
                    std::string::npos)
                  _exit(97);
                throw error;
              }),
              int(ExitCode::output));
    EXPECT_EQ(files_in(dir.path()), 0u);
  }
}

TEST(CheckedFile, AFailureIsFinal) {
  const TempDir dir;
  EXPECT_EQ(status_of_child([&] {
              remove_temporaries_on_signals();
              const rlimit limit = {100, 100};
              setrlimit(RLIMIT_FSIZE, &limit);
              const SafeFile file(dir / "a.exr", kNew);
              CheckedFile checked(file);
              const std::vector<char> bytes(5'000'000);
              error_of([&] { checked.write(bytes.data(), bytes.size()); });
              const rlimit none = {RLIM_INFINITY, RLIM_INFINITY};
              setrlimit(RLIMIT_FSIZE, &none);
              if (!checked.failed()) _exit(97);
              checked.close();
            }),
            int(ExitCode::output));
}

}  // namespace
}  // namespace ssdo::test::safe_file_test
