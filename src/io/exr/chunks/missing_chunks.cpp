// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/missing_chunks.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace ssdo {
namespace {

/// The order in which a part's chunks are searched, and in which those that are missing stand.
bool comes_before(const Window& a, const Window& b) {
  return std::tie(a.y0, a.x0) < std::tie(b.y0, b.x0);
}

}  // namespace

bool is_missing(const MissingChunks& missing, const Window& chunk) {
  return std::ranges::binary_search(missing.windows, chunk, comes_before);
}

std::string describe(const MissingChunks& missing, const ExrPart& part) {
  int rows = 0, first = part.data_window.y1, end = part.data_window.y0;
  for (const Window& chunk : missing.windows) {
    rows += chunk.height();
    first = std::min(first, chunk.y0);
    end = std::max(end, chunk.y1);
  }
  const std::string count =
      is_tiled(part) ? fmt::format("{} of {} tiles", missing.windows.size(), missing.count)
                     : fmt::format("{} of {} rows", rows, part.data_window.height());
  return fmt::format("{} are missing or damaged, between rows {} and {}", count, first, end - 1);
}

}  // namespace ssdo
