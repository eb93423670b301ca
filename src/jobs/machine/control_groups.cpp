// SPDX-License-Identifier: Apache-2.0
//
// /proc/self/cgroup has a line ID:CONTROLLERS:GROUP for each hierarchy, without controllers for
// that of version 2; a group is a folder of /sys/fs/cgroup or, in version 1, of its folder for the
// controller (cgroups(7)). A container may show its own group there as the topmost one, so that the
// folder of the group that /proc names does not exist.
#include "jobs/machine/control_groups.h"

#include <fstream>

namespace ssdo {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// The group of this process, as a path from "/" on; "/" where none is named.
fs::path own_group(const std::string& controller, const fs::path& root) {
  std::ifstream in(root / "proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    if (controllers.find("," + controller + ",") != std::string::npos)
      return fs::path(line.substr(second + 1)).lexically_normal();
  }
  return "/";
}

}  // namespace

std::vector<std::string> lines_of_control_groups(const std::string& controller,
                                                 const std::string& file, const fs::path& root) {
  const fs::path hierarchy = root / "sys/fs/cgroup" / controller;
  std::vector<std::string> lines;
  for (fs::path group = own_group(controller, root);; group = group.parent_path()) {
    if (const std::string line = first_line(hierarchy / group.relative_path() / file);
        !line.empty())
      lines.push_back(line);
    if (group == group.root_path()) return lines;
  }
}

}  // namespace ssdo
