// SPDX-License-Identifier: Apache-2.0
#include "support/run_tool.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <future>
#include <sstream>
#include <stdexcept>

namespace ssdo::test {

namespace {

/// One direction of a child's output.
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

/// Without what a plain run of one frame says last: how much of it is guessed, which small frames
/// are for the most part.
std::string without_advice(const std::string& text) {
  std::string kept;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool whole = !lines.eof();
    if (line.starts_with("ssdo: ") && line.find(" of all directions are guessed; ") != line.npos)
      continue;
    kept += line + (whole ? "\n" : "");
  }
  return kept;
}

}  // namespace

std::filesystem::path tool_path() { return SSDO_BINARY; }

std::string Finished::error_line() const {
  const auto end = err.find('\n');
  return end + 1 == err.size() ? err.substr(0, end) : "not one line: " + err;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

Finished run_tool(const std::vector<std::string>& arguments, const Surroundings& around) {
  std::vector<std::string> words = {around.binary};
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
  // While it runs: a pipe holds some of it only.
  auto out_text = std::async(std::launch::async, [&] { return out.drain(); }),
       err_text = std::async(std::launch::async, [&] { return err.drain(); });
  int status = 0;
  rusage used{};
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
    wait4(child, &status, 0, &used);
  }
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, out_text.get(), without_advice(err_text.get()), used};
}

std::vector<std::string> listing(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string data(const std::string& name) { return std::string(SSDO_SOURCE_DIR) + "/data/" + name; }

}  // namespace ssdo::test
