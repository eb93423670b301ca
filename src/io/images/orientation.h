// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <utility>

#include "math/plane.h"

namespace ssdo {

/// How the rows that a file stores lie in the picture that it shows.
struct Orientation {
  bool transposed = false;        ///< rows are columns of the picture
  bool rows_reversed = false;     ///< the first row is at the bottom, or at the right
  bool columns_reversed = false;  ///< rows begin at the right, or at the bottom

  bool operator==(const Orientation&) const = default;
};

/// By the numbers 1 to 8 of TIFF 6.0 (tag 274) and EXIF; as stored for others.
Orientation orientation_of_tiff(int number);

/// By the resolution string of a Radiance file, such as "-Y 512 +X 1024"; nothing for other files.
/// Source: Radiance, "File Formats". OpenImageIO 2.4 exchanges two of the eight.
std::optional<Orientation> orientation_of_radiance(const std::filesystem::path& file);

/// The picture that a file shows, from what it stores.
template <class T>
Plane<T> upright(Plane<T> stored, const Orientation& o) {
  if (stored.empty() || o == Orientation{}) return stored;
  Plane<T> out = Plane<T>::like(stored);
  if (o.transposed) std::swap(out.width, out.height);
  for (int row = 0; row < stored.height; ++row) {
    for (int column = 0; column < stored.width; ++column) {
      const int across = o.columns_reversed ? stored.width - 1 - column : column,
                down = o.rows_reversed ? stored.height - 1 - row : row;
      out(o.transposed ? down : across, o.transposed ? across : down) = stored(column, row);
    }
  }
  return out;
}

}  // namespace ssdo
