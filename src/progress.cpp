// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace ssdo {

Progress::Progress(ProgressStyle style, bool quiet) : style_(style) {
  bar_ = style == ProgressStyle::automatic && !quiet && isatty(STDERR_FILENO);
}

Progress::~Progress() { clear(); }

void Progress::tell(double done, const std::string& what) {
  const int percent = std::clamp(int(100 * done + 0.5), 0, 100);
  if (percent == last_percent_) return;
  last_percent_ = percent;
  switch (style_) {
    case ProgressStyle::automatic:
      if (!bar_) return;
      fmt::print(stderr, "\r\033[K[{:<25}] {:3d}% {}", std::string(std::size_t(percent / 4), '#'),
                 percent, what);
      std::fflush(stderr);
      drawn_ = true;
      return;
    case ProgressStyle::none:
      return;
    case ProgressStyle::tractor:
      fmt::print("TR_PROGRESS {:03d}%\n", percent);
      break;
    case ProgressStyle::alfred:
      fmt::print("ALF_PROGRESS {}%\n", percent);
      break;
    case ProgressStyle::openjd:
      fmt::print("openjd_progress: {}\n", percent);
      break;
  }
  std::fflush(stdout);
}

void Progress::clear() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace ssdo
