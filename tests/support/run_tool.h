// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/resource.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace ssdo::test {

/// What a finished process left behind.
struct Finished {
  int code = -1;     ///< exit status; 128 + signal where one ended it
  std::string out;   ///< standard output
  std::string err;   ///< standard error
  rusage used = {};  ///< processor and memory, of a run that was not killed

  /// The one line of an error message, without its end.
  std::string error_line() const;
};

/// All bytes of a file; none where there is no such file.
std::string read_file(const std::filesystem::path& path);

/// The tool of the build that this is linked in: compiled tests are linked in others too.
std::filesystem::path tool_path();

/// How a run differs from a plain one.
struct Surroundings {
  std::map<std::string, std::string> variables = {};
  std::filesystem::path binary = tool_path();
  std::filesystem::path folder = {};  ///< to start in
  rlim_t file_size = RLIM_INFINITY;   ///< a disk that is full after this many bytes per file
  int kill_with = 0;                  ///< sent as soon as `kill_when` holds
  std::function<bool()> kill_when = {};
};

/// Runs the real binary without a shell.
Finished run_tool(const std::vector<std::string>& arguments, const Surroundings& around = {});

/// What a folder holds, hidden files too.
std::vector<std::string> listing(const std::filesystem::path& folder);

/// A file of the repository's data/.
std::string data(const std::string& name);

}  // namespace ssdo::test
