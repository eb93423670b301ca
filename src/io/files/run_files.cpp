// SPDX-License-Identifier: Apache-2.0
#include "io/files/run_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "error.h"
#include "io/files/output_path.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

/// Where a path leads once every link on its way is followed. What does not exist is taken as it
/// will be once its folders are made.
fs::path final_path(const fs::path& path, int links = 0) {
  std::error_code error;
  const fs::path real = fs::canonical(path, error);
  if (!error) return real;
  const fs::path full = fs::absolute(path);
  if (full == full.root_path()) return full;
  const fs::path folder = final_path(full.parent_path(), links);
  const fs::path name = full.filename();
  if (name.empty() || name == ".") return folder;
  if (name == "..") return folder.parent_path();
  const fs::path target = fs::read_symlink(folder / name, error);
  if (error || links >= kMostLinks) return folder / name;
  return final_path(folder / target, links + 1);
}

/// Device and number of a file that exists: the same for all its hard links.
using FileNumber = std::pair<dev_t, ino_t>;

std::optional<FileNumber> number_of(const std::string& path) {
  struct stat status;
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  return FileNumber(status.st_dev, status.st_ino);
}

}  // namespace

void check_run_files(const RunFiles& files) {
  std::unordered_map<std::string, const RunFile*> input_paths, output_paths;
  std::map<FileNumber, const RunFile*> input_numbers;
  for (const RunFile& input : files.inputs) {
    if (input.path.empty()) continue;
    input_paths.emplace(final_path(input.path), &input);
    if (const auto number = number_of(input.path)) input_numbers.emplace(*number, &input);
  }
  for (const RunFile& output : files.outputs) {
    const std::string path = final_path(output.path);
    const RunFile* input = nullptr;
    if (const auto found = input_paths.find(path); found != input_paths.end())
      input = found->second;
    if (const auto number = number_of(output.path); number && input_numbers.contains(*number))
      input = input_numbers.at(*number);
    if (input) {
      throw Error(ExitCode::output, fmt::format("{}: is an input ({}); {} has to be another file",
                                                output.path, input->option, output.option));
    }
    const auto [other, is_new] = output_paths.emplace(path, &output);
    if (!is_new) {
      throw Error(
          ExitCode::usage,
          fmt::format("{}: named twice as an output, by {} and by {} {}; name another file",
                      output.path, output.option, other->second->option, other->second->path));
    }
  }
}

}  // namespace ssdo
