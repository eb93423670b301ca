// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace ssdo {

/// Wall time in milliseconds, lap by lap.
class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> elapsed = now - start_;
    start_ = now;
    return elapsed.count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace ssdo
