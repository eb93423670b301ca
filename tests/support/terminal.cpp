// SPDX-License-Identifier: Apache-2.0
#include "support/terminal.h"

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

namespace ssdo::test {

Finished run_on_terminal(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {tool_path()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child < 0) throw std::runtime_error("no terminal");
  if (child == 0) {
    execv(argv[0], argv.data());
    _exit(127);
  }
  Finished done;
  char buffer[4096];
  // The end of a terminal is an error, not an empty read.
  for (ssize_t n; (n = read(terminal, buffer, sizeof buffer)) > 0;)
    done.out.append(buffer, std::size_t(n));
  int status = 0;
  waitpid(child, &status, 0);
  close(terminal);
  done.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return done;
}

}  // namespace ssdo::test
