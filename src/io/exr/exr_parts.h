// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImathBox.h>
#include <ImfCompression.h>

#include <filesystem>
#include <string>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// Throws ExitCode::input, saying what `file` is instead, unless it is a readable EXR by its first
/// bytes. OpenEXR's own messages do not tell a missing file from a folder.
std::unique_ptr<InputFile> open_exr(const std::filesystem::path& file);

/// Whether `file` is a plain file that begins as an EXR does, whatever its name.
bool begins_as_exr(const std::filesystem::path& file);

/// Throws `error` itself where nothing is wrong with the file: of memory, or of its disk.
void throw_unless_of_file(const std::exception& error);

/// Throws ExitCode::input for a part whose pixels could not be read.
[[noreturn]] void throw_damaged(const ExrReader& file, const ExrPart& part,
                                const std::exception& error);

/// Unpacks the header of a part.
ExrPart describe_part(const Imf::MultiPartInputFile& file, int index);

/// How messages name a part: "part 2 'normals'".
std::string label(const ExrPart& part);

bool is_tiled(const ExrPart& part);

/// A window as OpenEXR has it, with its last pixel.
Window window_of(const Imath::Box2i& box);

/// Scanlines that are packed together.
int lines_per_chunk(Imf::Compression compression);

/// What a pixel takes that has a value of every channel.
double bytes_per_pixel(const ExrPart& part);

/// Pixels of a tile, or of the scanlines that are packed together.
double pixels_per_chunk(const ExrPart& part);

/// How many bytes of float pixels a byte of the part's chunks can hold at best.
double largest_ratio(const ExrPart& part);

/// The memory in which OpenEXR decodes the chunks of a part: every channel of a chunk, two chunks
/// for each of its threads.
double decoder_bytes(const ExrPart& part);

/// What all channels of a row of tiles take, of which OpenEXR makes room for all, also where the
/// image is smaller than a tile. 0 for scanlines.
double tile_row_bytes(const ExrPart& part);

/// What a channel takes of each pixel as float.
double float_bytes(const ExrChannel& channel);

/// What a header claims of a part: its pixels with `value_bytes` of each, or a row of its tiles
/// where these are large.
double claimed_bytes(const ExrPart& part, double value_bytes);

/// Takes an attribute out of a header, if it is there. OpenEXR's Header::erase() does not free it.
void take_out(Imf::Header& header, const std::string& name);

/// A window by its first and last pixel, as headers have it: "0,0 to 575,323".
std::string text_of(const Window& window);

}  // namespace ssdo
