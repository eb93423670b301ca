// SPDX-License-Identifier: Apache-2.0
#include "bench/machine.h"

#include <fstream>
#include <thread>

namespace ssdo {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const auto colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

int processor_count() { return int(std::thread::hardware_concurrency()); }

}  // namespace ssdo
