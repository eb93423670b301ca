// SPDX-License-Identifier: Apache-2.0
#include "bench/report_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

#include "error.h"
#include "io/files/checked_file.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

std::string ending(const std::string& path) {
  std::string text = fs::path(path).extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

}  // namespace

bool wants_page(const std::vector<std::string>& paths) {
  return std::any_of(paths.begin(), paths.end(),
                     [](const std::string& path) { return ending(path) == ".html"; });
}

void check_report_files(const std::vector<std::string>& paths, std::vector<RunFile> inputs,
                        const OutputPolicy& policy) {
  RunFiles files{std::move(inputs), {}};
  for (const std::string& path : paths) {
    const std::string kind = ending(path);
    if (kind != ".html" && kind != ".csv" && kind != ".json") {
      throw Error(ExitCode::usage,
                  fmt::format("--report {}: unknown kind; use .html, .csv or .json", path));
    }
    files.outputs.push_back({"--report", path});
  }
  check_run_files(files);
  for (const std::string& path : paths) check_output(path, policy);
}

void write_reports(const std::function<std::string(const std::string& ending)>& text_of,
                   const std::vector<std::string>& paths, const OutputPolicy& policy) {
  std::vector<std::unique_ptr<SafeFile>> files;
  for (const std::string& path : paths) {
    const std::string text = text_of(ending(path));
    files.push_back(std::make_unique<SafeFile>(path, policy));
    CheckedFile checked(*files.back());
    checked.write(text.data(), text.size());
    checked.close();
  }
  commit_all(files);
}

}  // namespace ssdo
