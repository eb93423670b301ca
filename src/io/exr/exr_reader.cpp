// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_reader.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>

#include "error.h"
#include "io/exr/exr_parts.h"
#include "io/exr/zip_lines.h"
#include "io/one_line.h"
#include "io/size_guard.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

using Names = std::span<const std::string>;

[[noreturn]] void fail(const ExrReader& reader, std::string_view what) {
  throw Error(ExitCode::input, fmt::format("{}: {}", reader.path().string(), what));
}

const ExrPart& flat_part(const ExrReader& reader, int index) {
  const int count = int(reader.parts().size());
  if (index < 0 || index >= count) {
    fail(reader, fmt::format("has no part {}; its parts are 0 to {}", index, count - 1));
  }
  const ExrPart& part = reader.parts()[std::size_t(index)];
  if (part.deep) {
    fail(reader, fmt::format("is a deep image ({}); ssdo reads flat images: flatten it first, for "
                             "example with oiiotool --flatten",
                             label(part)));
  }
  return part;
}

const ExrChannel& find_channel(const ExrReader& reader, const ExrPart& part,
                               const std::string& name) {
  const auto found = std::find_if(part.channels.begin(), part.channels.end(),
                                  [&](const ExrChannel& c) { return c.name == name; });
  if (found != part.channels.end()) return *found;
  fail(reader,
       fmt::format("has no channel '{}' in {}; ssdo info lists what it has", name, label(part)));
}

std::size_t stored_bytes(const ExrPart& part, const ExrChannel& channel) {
  // OpenEXR allows sampling only where it divides the size of the window.
  return std::size_t(part.data_window.width() / channel.x_sampling) *
         std::size_t(part.data_window.height() / channel.y_sampling) *
         (channel.type == Imf::HALF ? 2 : 4);
}

/// `grid` is what is read of the part.
void check_size(const ExrReader& reader, const ExrPart& part, std::size_t channels,
                const PixelGrid& grid = {}) {
  constexpr double kLargeTiles = 1 << 28;  // bytes; below, a tile may well be larger than its image
  const double value_bytes = 4.0 * double(channels), tiles = tile_row_bytes(part),
               pixels = double(part.data_window.area()) * value_bytes;
  check_decoded_size(reader.path(), tiles > kLargeTiles ? std::max(pixels, tiles) : pixels,
                     double(grid.of(part.data_window).area()) * value_bytes + decoder_bytes(part),
                     largest_ratio(part));
}

void read_lines(Imf::MultiPartInputFile& file, const ExrPart& part, const Window& rows,
                const Imf::FrameBuffer& frame_buffer) {
  Imf::InputPart lines(file, part.index);
  lines.setFrameBuffer(frame_buffer);
  lines.readPixels(rows.y0, rows.y1 - 1);
}

/// `rows` is the data window, or some rows of it. OpenEXR keeps one reader for each part of an open
/// file and takes it for whatever is asked for later, so the lines of a part whose tiles are read
/// too come from a file of their own.
void read_pixels(const ExrReader& reader, const ExrPart& part, const Window& rows,
                 const Imf::FrameBuffer& frame_buffer) {
  if (!is_tiled(part)) return read_lines(reader.file(), part, rows, frame_buffer);
  if (rows != part.data_window) {
    Imf::MultiPartInputFile again(reader.path().c_str());
    return read_lines(again, part, rows, frame_buffer);
  }
  Imf::TiledInputPart tiles(reader.file(), part.index);
  tiles.setFrameBuffer(frame_buffer);
  tiles.readTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);
}

void read_or_fail(const ExrReader& reader, const ExrPart& part, const Window& rows,
                  std::span<const ChannelRows> channels) {
  if (rows.area() == 0) return;
  try {
    if (read_zip_lines(reader.file(), part, rows, channels)) return;
    Imf::FrameBuffer frame_buffer;
    const Imath::Box2i box({rows.x0, rows.y0}, {rows.x1 - 1, rows.y1 - 1});
    for (const auto& [channel, pixels, as_float] : channels) {
      frame_buffer.insert(channel.name,
                          Imf::Slice::Make(as_float ? Imf::FLOAT : channel.type, pixels, box, 0, 0,
                                           channel.x_sampling, channel.y_sampling));
    }
    read_pixels(reader, part, rows, frame_buffer);
  } catch (const std::exception& error) {
    throw_damaged(reader, part, error);
  }
}

/// A frame buffer holds one slice per name, so a channel that is asked for twice was read into its
/// last place only: copies it to the others.
template <class Pixels>
void fill_repeated(Names names, std::vector<Pixels>& read) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto last = std::find(names.rbegin(), names.rend(), names[i]);
    const std::size_t place = std::size_t(names.rend() - last) - 1;
    if (place != i) read[i] = read[place];
  }
}

/// Some rows of a part's data window, or all, as float.
std::vector<Plane<float>> read_rows(const ExrReader& reader, const ExrPart& part, Names names,
                                    const Window& window) {
  std::vector<Plane<float>> planes;
  std::vector<ChannelRows> rows;
  for (const std::string& name : names) {
    planes.emplace_back(window.width(), window.height());
    rows.push_back({find_channel(reader, part, name),
                    reinterpret_cast<std::byte*>(planes.back().pixels.data()), true});
  }
  read_or_fail(reader, part, window, rows);
  fill_repeated(names, planes);
  return planes;
}

/// The middle pixels of blocks, from strips of a part that are read one after another.
std::vector<Plane<float>> read_blocks(const ExrReader& reader, const ExrPart& part, Names names,
                                      const PixelGrid& grid) {
  constexpr int kBlocksOfStrip = 64;
  const Window &from = part.data_window, to = grid.of(from);
  std::vector<Plane<float>> planes(names.size(), Plane<float>(to.width(), to.height()));
  for (int block = to.y0; block < to.y1; block += kBlocksOfStrip) {
    const int end = std::min(block + kBlocksOfStrip, to.y1);
    const Window strip{from.x0, grid.middle_y(block), from.x1, grid.middle_y(end - 1) + 1};
    const std::vector<Plane<float>> rows = read_rows(reader, part, names, strip);
    for_each_row(end - block, [&](int row) {
      for (std::size_t i = 0; i < planes.size(); ++i) {
        for (int x = to.x0; x < to.x1; ++x)
          planes[i](x - to.x0, block + row - to.y0) =
              rows[i](grid.middle_x(x) - from.x0, row * grid.stride);
      }
    });
  }
  return planes;
}

}  // namespace

ExrReader::ExrReader(std::filesystem::path path) : path_(std::move(path)) {
  check_is_exr(path_);
  try {
    file_ = std::make_unique<Imf::MultiPartInputFile>(path_.c_str());
    for (int i = 0; i < file_->parts(); ++i) parts_.push_back(describe_part(*file_, i));
  } catch (const std::exception& error) {
    fail(*this, fmt::format("is damaged or cut short in its header ({}); render or copy it again",
                            one_line(error.what())));
  }
}

ExrReader::~ExrReader() = default;
ExrReader::ExrReader(ExrReader&&) noexcept = default;

std::vector<Plane<float>> ExrReader::read(int index, Names names, const PixelGrid& grid) const {
  const ExrPart& part = flat_part(*this, index);
  check_size(*this, part, names.size(), grid);
  for (const std::string& name : names) {
    const ExrChannel& channel = find_channel(*this, part, name);
    if (channel.x_sampling != 1 || channel.y_sampling != 1) {
      fail(*this, fmt::format("channel '{}' of {} is subsampled {}x{}; ssdo needs a value in every "
                              "pixel: resample it first",
                              name, label(part), channel.x_sampling, channel.y_sampling));
    }
  }
  return grid.is_coarse() ? read_blocks(*this, part, names, grid)
                          : read_rows(*this, part, names, grid.rows_of(part.data_window));
}

std::vector<StoredChannel> ExrReader::read_stored(int index, Names names) const {
  const ExrPart& part = flat_part(*this, index);
  check_size(*this, part, names.size());
  std::vector<StoredChannel> stored;
  std::vector<ChannelRows> rows;
  for (const std::string& name : names) {
    const ExrChannel& channel = find_channel(*this, part, name);
    stored.push_back({channel, std::vector<std::byte>(stored_bytes(part, channel))});
    rows.push_back({channel, stored.back().pixels.data(), false});
  }
  read_or_fail(*this, part, part.data_window, rows);
  fill_repeated(names, stored);
  return stored;
}

std::string string_attribute(const Imf::Header& header, const std::string& name) {
  const auto* found = header.findTypedAttribute<Imf::StringAttribute>(name);
  return found ? found->value() : "";
}

int int_attribute(const Imf::Header& header, const std::string& name) {
  const auto* found = header.findTypedAttribute<Imf::IntAttribute>(name);
  return found ? found->value() : 0;
}

std::vector<std::string> views_of(const Imf::Header& header) {
  return Imf::hasMultiView(header) ? Imf::multiView(header) : std::vector<std::string>();
}

}  // namespace ssdo
