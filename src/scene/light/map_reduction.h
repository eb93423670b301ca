// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "math/plane.h"

namespace ssdo {

/// Averages a lat-long map by solid angle, some rows at a time, down to the size that light is
/// modelled in. The light of every direction is kept, and that of a sun stays within its texels. A
/// map of less than twice that size stays as it is, to the bit.
class MapReduction {
 public:
  /// Texels of 0.18 degrees: half of the patches of which suns consist.
  static constexpr int kColumns = 2048;

  /// The size of the map that is to come. Rows that never come are black.
  MapReduction(int width, int height, int columns = kColumns);

  /// Columns and rows of the result.
  static glm::ivec2 size(int width, int height, int columns = kColumns);

  /// The next rows, which begin at row `first` of the map.
  void add(int first, const Plane<glm::vec3>& rows);

  Plane<glm::vec3> take() { return std::move(out_); }

 private:
  /// Where a column of the map goes: the first column of the result that it touches, and the share
  /// of it that lies there. The rest is in the next one.
  struct Place {
    int column;
    float share;
  };

  bool is_identity() const { return out_.width == width_; }
  void add_row(int y, const glm::vec3* texels, int to);

  const int width_, height_;
  Plane<glm::vec3> out_;
  std::vector<Place> places_;
};

}  // namespace ssdo
