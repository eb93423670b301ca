// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "io/exr/exr_output.h"
#include "io/files/safe_file.h"

namespace ssdo {

/// An output EXR on its way into the temporary of a SafeFile, which the caller commits. Its pixels
/// are written from the top to the bottom, any number of rows at a time; how many does not change
/// the file. Between two calls it holds 255 rows of the planes at most, and the kept channels.
///
/// Compression levels are libdeflate's where ZipOutput writes the file. OpenEXR writes all other
/// files, such as those of tiles or several parts, and packs levels above 9 as 9.
///
/// Planes go into one part of an input, or into several, such as those of its views. The header of
/// such a part is kept: windows, pixel aspect, view, chromaticities and all other attributes,
/// except those that describe the old file's storage, Cryptomattes that are not in the output, or a
/// preview of another picture. A data window may be larger than the input's: kept channels are 0
/// around it. Without `keep_channels` the file has these parts alone, in scanlines and flat. With
/// it, their other channels keep type and bits (a tiled part keeps its full-resolution level; deep
/// channels are dropped), and the other parts are copied without being decoded.
///
/// With `crop` the data window of a part is cut to the display window. Other flat parts that reach
/// beyond are decoded and written in scanlines; the pixels that stay keep their bits. Deep parts
/// are copied whole.
///
/// With `downsampling` the windows and the kept channels become smaller. Colours (R, G, B, A and a
/// Y alone) are filtered. All other channels (those in `geometry`, whole numbers, Cryptomattes)
/// take the value next to the middle of a pixel, at the same place in all. Other parts are decoded
/// and written in scanlines.
///
/// A kept channel whose name a plane takes moves to "input.NAME", or to "input.input.NAME" where
/// the input has a channel of that name. An earlier product of this tool is dropped instead of
/// moved; see EarlierProducts.
///
/// Errors of all: ExitCode::output if the disk is full or the file cannot be written;
/// ExitCode::input if what is kept of the input cannot be read, or cannot be cropped: a part that
/// lies outside of the display window, a channel whose subsampling does not divide it; or cannot be
/// downsampled: a deep part, a channel that is subsampled. After an error the object is of no use.
class ExrWriter {
 public:
  /// Writes the headers. `parts` are different parts of one input in its order, and agree in all
  /// but planes, geometry and attributes. Only names and types of the planes are used, no pixels.
  ExrWriter(const SafeFile& file, std::vector<ExrOutput> parts);
  ~ExrWriter();

  /// Writes the next rows: one view for each plane of a part, in their order, all of the same
  /// height and as wide as the part before it is cropped. Rows that are cropped away are to be
  /// given too. After the last row of a part come those of the next. Half values beyond ±65504 are
  /// clamped. Returns how many were.
  std::size_t write(std::span<const ChannelView> planes);

  /// Completes the file. If the writer is destroyed without this, the file must not be committed.
  void finish();

 private:
  class File;
  std::unique_ptr<File> file_;
};

/// Writes all of `parts` with an ExrWriter. Returns how many values were clamped.
std::size_t write_exr(const SafeFile& file, const std::vector<ExrOutput>& parts);

}  // namespace ssdo
