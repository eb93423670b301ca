// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test {

/// A small frame in a folder of its own, and a made-up truth of each product.
struct BenchFrame {
  static constexpr int kSky = 6;  ///< rows of background

  TempDir folder;
  std::string frame, truth;

  /// The name of the frame is one that a shell and a page have to be careful with.
  BenchFrame();

  /// Three methods with all products under the sky.
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}) const;
};

}  // namespace ssdo::test
