// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImathBox.h>
#include <ImfCompression.h>
#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstddef>
#include <string>
#include <vector>

#include "math/pixel_grid.h"

namespace OPENEXR_IMF_INTERNAL_NAMESPACE {
class MultiPartInputFile;
}  // namespace OPENEXR_IMF_INTERNAL_NAMESPACE

namespace ssdo {

/// One channel as the header declares it.
struct ExrChannel {
  std::string name;  ///< full name as stored, "ViewLayer.Position.X"
  Imf::PixelType type = Imf::FLOAT;
  int x_sampling = 1, y_sampling = 1;
};

/// One part: its header untouched, and what the header says, unpacked.
struct ExrPart {
  int index = 0;
  std::string name;  ///< empty in a single-part file without a name
  std::string view;  ///< the part's `view` attribute, or empty
  bool deep = false;
  Window data_window, display_window;
  std::vector<ExrChannel> channels;  ///< in the order of the header (sorted by name)
  Imf::Header header;
};

/// A string attribute of a header; empty where there is none of this name.
std::string string_attribute(const Imf::Header& header, const std::string& name);

/// An integer attribute of a header; 0 where there is none of this name.
int int_attribute(const Imf::Header& header, const std::string& name);

/// The views of a multi-view part, the default one first; empty where it has none.
std::vector<std::string> views_of(const Imf::Header& header);

/// The pixels of one channel in the type that the file stores, row by row over the data window.
struct StoredChannel {
  ExrChannel channel;
  std::vector<std::byte> pixels;
};

/// Unpacks the header of a part.
ExrPart describe_part(const Imf::MultiPartInputFile& file, int index);

/// How messages name a part: "part 2 'normals'".
std::string label(const ExrPart& part);

bool is_tiled(const ExrPart& part);

/// A window as OpenEXR has it, with its last pixel.
Window window_of(const Imath::Box2i& box);

/// Scanlines that are packed together.
int lines_per_chunk(Imf::Compression compression);

/// The bytes of a value in files.
constexpr std::size_t bytes_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

/// The bytes of a pixel that has a value of every channel.
double bytes_per_pixel(const ExrPart& part);

/// Pixels of a tile, or of the scanlines that are packed together.
double pixels_per_chunk(const ExrPart& part);

/// How many bytes of float pixels a byte of the part's chunks can hold at best.
double largest_ratio(const ExrPart& part);

/// The memory in which OpenEXR decodes the chunks of a part: every channel of a chunk, two chunks
/// for each of its threads.
double decoder_bytes(const ExrPart& part);

/// Bytes per pixel of a channel stored as float: 4, or less if it is subsampled.
double float_bytes(const ExrChannel& channel);

/// The bytes that a header claims for a part: `value_bytes` for each pixel, or those of a row of
/// its tiles where these are large and take more.
double claimed_bytes(const ExrPart& part, double value_bytes);

/// Takes an attribute out of a header, if it is there. Header::erase() of OpenEXR 3.4 frees it, and
/// that of 3.1 does not: the others are copied instead.
void take_out(Imf::Header& header, const std::string& name);

/// A window by its first and last pixel, as headers have it: "0,0 to 575,323".
std::string text_of(const Window& window);

}  // namespace ssdo
