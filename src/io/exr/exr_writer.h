// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>
#include <ImfPixelType.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/exr/exr_reader.h"
#include "io/safe_file.h"
#include "math/channel_view.h"
#include "math/downsampling.h"

namespace ssdo {

/// A channel to write: float pixels over the data window, rounded to `type` (half or float).
struct ExrPlane {
  std::string name;
  Imf::PixelType type = Imf::HALF;
  ChannelView pixels;
};

/// A channel of a part of the input.
struct ChannelOfPart {
  int part = 0;
  std::string channel;

  bool operator==(const ChannelOfPart&) const = default;
};

/// What goes into an output EXR.
struct ExrOutput {
  const ExrReader* input = nullptr;  ///< whose headers are kept
  int part = 0;                      ///< the part of the input that the planes were made from
  std::vector<ExrPlane> planes;    ///< all over the data window of that part, at the output's size
  bool keep_channels = false;      ///< pass the other channels and parts through unchanged
  bool crop = false;               ///< of every flat part, write the display window only
  Downsampling downsampling = {};  ///< from the input's windows to the output's
  std::vector<ChannelOfPart> geometry;  ///< those that cannot be filtered, whatever their names
  std::optional<Imf::Compression> compression;  ///< the input's where not given
  std::optional<int> compression_level;  ///< of `compression`: ZIP and ZIPS 1 (fast) to 12 (small),
                                         ///< DWAA and DWAB 1 (exact) to 100000 (small), others
                                         ///< none; its own default where not given
  std::vector<std::pair<std::string, std::string>> attributes;  ///< string attributes to add
};

/// What the written part is compressed with. A compression that the input brings along is kept if
/// it is lossless: one that is lossy suits pictures, not positions and visibilities, so ZIP takes
/// its place. A lossy `output.compression` is used, except where channels of the input are kept:
/// they keep their bits, ids above all, so ZIP takes its place there too.
Imf::Compression compression_for(const ExrOutput& output);

/// Writes `output` to the temporary of `file`; the caller commits it.
///
/// Levels are libdeflate's where ZipOutput writes the file. OpenEXR, which writes tiles, files of
/// several parts and all else, packs levels above 9 as 9.
///
/// The header of the input's part is kept: windows, pixel aspect, view, chromaticities and every
/// attribute that does not describe the old file's storage. Without `keep_channels` the file has
/// that one part, in scanlines and flat. With it, the part's other channels keep type and bits (of
/// a tiled part, its full-resolution level; those of a deep one are dropped), and the other parts
/// are copied without being decoded.
///
/// With `crop` the data window of a part is what the display window shows of it. Other flat parts
/// that reach beyond are decoded and come in scanlines, with the same bits in the pixels that stay.
/// Deep parts are copied whole.
///
/// With `downsampling` the windows become smaller, and kept channels with them. Colours (R, G, B, A
/// and a Y alone) are filtered. All others, those of `geometry`, whole numbers and Cryptomattes
/// have the value next to the middle of a pixel, all of the same place. Other parts are decoded and
/// come in scanlines.
///
/// A kept channel whose name a plane takes moves to "input.NAME". If the input has an "input.NAME"
/// already, it is an earlier output of this tool: its "input.NAME" stays, and its NAME, an earlier
/// product, is dropped.
///
/// Half values beyond ±65504 are clamped. Returns how many were.
/// Errors: ExitCode::output if the disk is full or the file cannot be written; ExitCode::input if
/// what is kept of the input cannot be read, or cannot be cropped: a part that lies outside of the
/// display window, a channel whose subsampling does not divide it; or cannot be downsampled: a deep
/// part, a channel that is subsampled.
std::size_t write_exr(const SafeFile& file, const ExrOutput& output);

}  // namespace ssdo
