// SPDX-License-Identifier: Apache-2.0
#include "io/files/output_path.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <fstream>
#include <random>

#include "error.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

// Shortens UTF-8 text without cutting through a character, which some file systems refuse.
std::string shortened(std::string text, std::size_t size) {
  if (text.size() <= size) return text;
  while (size > 0 && (text[size] & 0xC0) == 0x80) --size;
  text.resize(size);
  return text;
}

}  // namespace

fs::path follow_links(fs::path path) {
  const std::string asked_for = path.string();
  for (int links = 0; links < kMostLinks; ++links) {
    std::error_code ignored;
    if (!fs::is_symlink(path, ignored)) return path;
    path = path.parent_path() / fs::read_symlink(path, ignored);
  }
  throw Error(ExitCode::output, fmt::format("{}: is a symbolic link that leads to itself; remove "
                                            "it or name another output",
                                            asked_for));
}

fs::path temporary_beside(const fs::path& target) {
  // The random part keeps apart the machines of a farm, whose process ids may be equal.
  const std::string extension = shortened(target.extension().string(), 16);
  const std::string mark = mark_of_machine();
  const std::string ending = fmt::format("{}-{}-{:08x}.tmp{}", mark.empty() ? ".ssdo" : mark,
                                         getpid(), std::random_device{}(), extension);
  const std::string stem = shortened(target.stem().string(), NAME_MAX - 1 - ending.size());
  return target.parent_path() / fmt::format(".{}{}", stem, ending);
}

std::string mark_of_machine() {
  std::string id;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), id);
  struct stat processes = {};
  if (id.size() < 8 || stat("/proc/self/ns/pid", &processes) != 0) return "";
  return fmt::format(".ssdo-{}{:08x}", id.substr(0, 8), processes.st_ino);
}

}  // namespace ssdo
