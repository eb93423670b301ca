// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "io/exr/chunks/missing_chunks.h"
#include "io/exr/file/exr_file.h"
#include "math/pixel_grid.h"
#include "math/plane.h"

namespace ssdo {

/// An EXR of any kind that OpenEXR reads: scanline or tiled, one part or many, any windows.
/// Opening reads the headers only; pixels are read channel by channel when asked for, so that a
/// frame with a hundred AOVs costs the four that are used.
/// Errors: ExitCode::input for a file that is missing, is no EXR, or is damaged.
class ExrReader : public ExrFile {
 public:
  using ExrFile::ExrFile;

  /// The named channels of a part as float planes over the part's data window; half and uint
  /// values are converted. Tiled parts give their full-resolution level. A deep part, a channel
  /// that does not exist or one that is subsampled is an error.
  /// Planes cover the part of `grid` in the data window. In a salvaged file, missing pixels are
  /// NaN.
  std::vector<Plane<float>> read(int part, std::span<const std::string> channels,
                                 const PixelGrid& grid = {}) const;

  /// The named channels of a part, bit for bit as stored. Subsampled channels are allowed.
  /// Salvaged: missing pixels are 0.
  std::vector<StoredChannel> read_stored(int part, std::span<const std::string> channels) const;

  /// What is missing of a flat part; nothing unless parts are salvaged. Looks at every chunk when
  /// it is first asked for.
  const MissingChunks& missing(int part) const;

  /// A line about each part of which something has been found missing so far.
  std::vector<std::string> losses() const;

 private:
  mutable std::map<int, MissingChunks> missing_;  ///< of the parts that were looked at
};

}  // namespace ssdo
