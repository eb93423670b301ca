// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace ssdo {

/// Rows [y0, y1) and columns [x0, x1) that one task works on.
struct Tile {
  int x0, y0, x1, y1;
};

/// Told after each finished tile or band how many there are and how many are done. May be called
/// from any thread, never from two at once.
using Progress = std::function<void(std::size_t done, std::size_t count)>;

/// Calls `work` once for each tile of a picture, from as many threads as ThreadLimit allows. What
/// a tile writes must depend on its pixels alone, never on the order of tiles.
void for_each_tile(int width, int height, const std::function<void(const Tile&)>& work,
                   const Progress& progress = {});

/// Calls `work(y0, y1)` once for each band of rows, as for_each_tile() does for tiles: for loops
/// that are at their best along whole rows.
void for_each_band(int height, const std::function<void(int y0, int y1)>& work,
                   const Progress& progress = {});

/// Calls `work(i)` once for each i from 0 to count - 1, in the same way.
void for_each_task(std::size_t count, const std::function<void(std::size_t)>& work,
                   const Progress& progress = {});

/// Calls `work` once for each row.
void for_each_row(int height, const std::function<void(int y)>& work);

/// The sum of what `count_in` says of each row.
std::size_t count_over_rows(int height, const std::function<std::size_t(int y)>& count_in);

/// Holds for_each_tile() and its like to `count` threads while it lives, in the whole process.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  Control* control_;
};

}  // namespace ssdo
