// SPDX-License-Identifier: Apache-2.0
#include "jobs/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "io/one_line.h"

namespace ssdo {

ProgressLine::ProgressLine(ProgressStyle style, bool quiet) : style_(style) {
  bar_ = style == ProgressStyle::automatic && !quiet && isatty(STDERR_FILENO);
}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::tell(double done, const std::string& what) {
  const int percent = std::clamp(int(100 * done + 0.5), 0, 100);
  if (percent <= last_percent_) return;
  last_percent_ = percent;
  std::string line;
  switch (style_) {
    case ProgressStyle::automatic:
      if (bar_) draw(percent, what);
      return;
    case ProgressStyle::none:
      return;
    case ProgressStyle::tractor:
      line = fmt::format("TR_PROGRESS {:03d}%\n", percent);
      break;
    case ProgressStyle::alfred:
      line = fmt::format("ALF_PROGRESS {}%\n", percent);
      break;
    case ProgressStyle::openjd:
      line = fmt::format("openjd_progress: {}\n", percent);
      break;
  }
  std::fputs(line.c_str(), stdout);
  std::fflush(stdout);
}

void ProgressLine::draw(int percent, const std::string& what) {
  const std::string filled(std::size_t(percent / 4), '#');
  std::fputs(fmt::format("\r\033[K[{:<25}] {:3d}% {}", filled, percent, printable(what)).c_str(),
             stderr);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressLine::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

}  // namespace ssdo
