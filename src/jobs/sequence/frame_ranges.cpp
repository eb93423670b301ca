// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/frame_ranges.h"

#include <fmt/format.h>

#include <iterator>

namespace ssdo {

std::string text_of(const FramesByPlace& frames) {
  constexpr std::size_t kMostRanges = 8;
  std::string text = frames.size() > 1 ? "frames " : "frame ";
  std::size_t ranges = 0, left = frames.size();
  for (auto first = frames.begin(); first != frames.end();) {
    auto last = first, next = std::next(first);
    while (next != frames.end() && next->first == last->first + 1) last = next++;
    if (++ranges > kMostRanges) return text + fmt::format(" and {} more", left);
    left -= std::size_t(std::distance(first, next));
    text += fmt::format("{}{}", ranges > 1 ? ", " : "", first->second);
    if (last != first) text += fmt::format(" to {}", last->second);
    first = next;
  }
  return text;
}

}  // namespace ssdo
