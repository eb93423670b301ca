// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>
#include <ImfPixelType.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/exr/exr_reader.h"
#include "math/channel_view.h"
#include "math/downsampling.h"

namespace ssdo {

/// A channel to write: float pixels over the data window, rounded to `type` (half or float).
struct ExrPlane {
  std::string name;
  Imf::PixelType type = Imf::HALF;
  ChannelView pixels;
  float background = 0;  ///< the value of pixels that show nothing
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
  std::vector<ExrPlane> planes;      ///< all over `window`, at the output's size
  std::optional<Window> window;      ///< in pixels of the input; the data window of the part, which
                                     ///< it holds, where not given
  bool keep_channels = false;        ///< pass the other channels and parts through unchanged
  bool crop = false;                 ///< of every flat part, write the display window only
  Downsampling downsampling = {};    ///< from the input's windows to the output's
  std::vector<ChannelOfPart> geometry;          ///< not to be filtered, whatever their names
  std::optional<Imf::Compression> compression;  ///< the input's where not given
  std::optional<int> compression_level;  ///< of `compression`: ZIP and ZIPS 1 (fast) to 12 (small),
                                         ///< DWAA and DWAB 1 (exact) to 100000 (small), others
                                         ///< none; its own default where not given
  std::vector<std::pair<std::string, std::string>> attributes;  ///< string attributes to add
};

/// The part of the input that the planes were made from.
const ExrPart& part_of(const ExrOutput& output);

/// The pixels of a part that are known, at the output's size.
Window known_window(const ExrOutput& output, const ExrPart& part);

/// The pixels that are written. Area 0 for a part that is cropped to nothing.
Window written_window(const ExrOutput& output, const ExrPart& part);

/// Whether the pixels of a part without planes have to be written anew, because they are cropped or
/// downsampled, or some are missing.
bool is_changed(const ExrOutput& output, const ExrPart& part);

/// What the written part is compressed with. A compression that the input brings along is kept if
/// it is lossless: one that is lossy suits pictures, not positions and visibilities, so ZIP takes
/// its place. A lossy `output.compression` is used, except where channels of the input are kept:
/// they keep their bits, ids above all, so ZIP takes its place there too.
Imf::Compression compression_for(const ExrOutput& output);

/// The level for what is written with `compression`, which may have taken the place of another.
std::optional<int> level_for(const ExrOutput& output, Imf::Compression compression);

}  // namespace ssdo
