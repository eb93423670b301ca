// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace ssdo::test {

/// What a finished process left behind.
struct Finished {
  int code = -1;    ///< exit status; 128 + signal where one ended it
  std::string out;  ///< standard output
  std::string err;  ///< standard error

  /// The one line of an error message, without its end.
  std::string error_line() const {
    const auto end = err.find('\n');
    return end + 1 == err.size() ? err.substr(0, end) : "not one line: " + err;
  }
};

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

/// How a run differs from a plain one.
struct Surroundings {
  std::map<std::string, std::string> variables = {};
  std::filesystem::path folder = {};  ///< to start in
  rlim_t file_size = RLIM_INFINITY;   ///< a disk that is full after this many bytes per file
  int kill_with = 0;                  ///< sent as soon as `kill_when` holds
  std::function<bool()> kill_when = {};
};

/// One direction of a child's output. A pipe's buffer is enough for what the tool says.
struct Pipe {
  int ends[2];
  Pipe() {
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  }
  ~Pipe() { close(ends[0]); }
  std::string drain() {
    close(ends[1]);
    std::string text;
    char buffer[4096];
    for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
      text.append(buffer, std::size_t(n));
    return text;
  }
};

/// Runs the real binary without a shell.
inline Finished run_tool(const std::vector<std::string>& arguments,
                         const Surroundings& around = {}) {
  std::vector<std::string> words = {SSDO_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  Pipe out, err;

  const pid_t child = fork();
  if (child == 0) {
    for (const auto& [name, value] : around.variables) setenv(name.c_str(), value.c_str(), 1);
    if (!around.folder.empty() && chdir(around.folder.c_str()) != 0) _exit(126);
    dup2(out.ends[1], STDOUT_FILENO);
    dup2(err.ends[1], STDERR_FILENO);
    const rlimit limit{around.file_size, around.file_size};
    if (around.file_size != RLIM_INFINITY) setrlimit(RLIMIT_FSIZE, &limit);
    execv(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  if (around.kill_with != 0) {
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (around.kill_when()) {
        kill(child, around.kill_with);
        waitpid(child, &status, 0);
        break;
      }
      usleep(1000);
    }
  } else {
    waitpid(child, &status, 0);
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, out.drain(), err.drain()};
}

/// What a folder holds, hidden files too.
inline std::vector<std::string> listing(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A file of the repository's data/.
inline std::string data(const std::string& name) {
  return std::string(SSDO_SOURCE_DIR) + "/data/" + name;
}

}  // namespace ssdo::test
