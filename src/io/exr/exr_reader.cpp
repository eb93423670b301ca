// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_reader.h"

#include <ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "error.h"
#include "io/exr/chunks/exr_chunks.h"
#include "io/exr/chunks/zip_lines.h"
#include "io/exr/file/exr_parts.h"
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
  const Imf::Header& header = part.header;
  if (header.hasType() && !Imf::isSupportedType(header.type())) {
    fail(reader, fmt::format("{} is of the type '{}', which no EXR of pixels has; render or copy "
                             "it again",
                             label(part), printable(header.type())));
  }
  return part;
}

const ExrChannel& find_channel(const ExrReader& reader, const ExrPart& part,
                               const std::string& name) {
  const auto found = std::ranges::lower_bound(part.channels, name, {}, &ExrChannel::name);
  if (found != part.channels.end() && found->name == name) return *found;
  fail(reader,
       fmt::format("has no channel '{}' in {}; ssdo info lists what it has", name, label(part)));
}

std::size_t stored_bytes(const ExrPart& part, const ExrChannel& channel) {
  // OpenEXR allows sampling only where it divides the size of the window.
  return std::size_t(part.data_window.width() / channel.x_sampling) *
         std::size_t(part.data_window.height() / channel.y_sampling) * bytes_of(channel.type);
}

/// The least size of a file with missing chunks that is still read, as a share of a whole file.
constexpr double kLeastShare = 1.0 / 64;

/// Blocks of a coarse grid whose rows are in memory at a time.
constexpr int kBlocksOfStrip = 64;

/// The pixels in memory while `grid` of a part is read: the result, and one strip of the part,
/// counted twice where the strip is cut from tiles.
double pixels_in_memory(const ExrPart& part, const PixelGrid& grid) {
  const Window& all = part.data_window;
  const double own = double(grid.of(all).area());
  if (!grid.is_coarse()) return own;
  const int rows = std::min(all.height(), kBlocksOfStrip * grid.stride);
  return own + double(all.width()) * rows * (is_tiled(part) ? 2 : 1);
}

/// Refuses a part that claims too much. Only `grid` of the part is read.
void check_size(const ExrReader& reader, const ExrPart& part, Names names,
                const PixelGrid& grid = {}) {
  double value_bytes = 0;  // of a pixel
  for (const std::string& name : names)
    value_bytes += float_bytes(find_channel(reader, part, name));
  const double ratio = largest_ratio(part),
               with_gaps = std::min(kLargestRatio, ratio / kLeastShare);
  check_decoded_size(reader.path(), reader.input().bytes(), claimed_bytes(part, value_bytes),
                     pixels_in_memory(part, grid) * value_bytes + decoder_bytes(part),
                     reader.salvage() == Salvage::none ? ratio : with_gaps);
}

/// Fills `rows` as missing chunks are read: with NaN, which is no surface, or with 0 if as stored.
void clear(const ExrPart& part, const Window& rows, const ChannelRows& to) {
  if (to.as_float)
    std::fill_n(reinterpret_cast<float*>(to.pixels), rows.area(), NAN);
  else
    std::fill_n(to.pixels, stored_bytes(part, to.channel), std::byte{0});
}

/// Reads what can be read, after `error`.
void salvage_or_fail(const ExrReader& reader, const ExrPart& part, const Window& rows,
                     std::span<const ChannelRows> channels, const std::exception& error) {
  reader.recover();
  const MissingChunks& missing = reader.missing(part.index);
  const std::size_t lost = missing.windows.size();
  if (lost == 0 || lost == missing.count) throw_damaged(reader, part, error);
  for (const ChannelRows& to : channels) clear(part, rows, to);
  try {
    read_chunks(reader, part, rows, channels, missing);
  } catch (const std::exception& another) {
    throw_damaged(reader, part, another);
  }
}

/// `rows` is the data window, or some rows of it.
void read_or_fail(const ExrReader& reader, const ExrPart& part, const Window& rows,
                  std::span<const ChannelRows> channels) {
  if (rows.area() == 0) return;
  try {
    if (!read_zip_lines(reader, part, rows, channels)) read_chunks(reader, part, rows, channels);
  } catch (const std::exception& error) {
    throw_unless_of_file(error);
    salvage_or_fail(reader, part, rows, channels, error);
  }
}

/// A frame buffer has one slice per name, so a channel that is asked for twice was read into its
/// last place only. Copies it to the other places.
template <class Pixels>
void fill_repeated(Names names, std::vector<Pixels>& read) {
  std::map<std::string_view, std::size_t> last;
  for (std::size_t i = 0; i < names.size(); ++i) last[names[i]] = i;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (last[names[i]] != i) read[i] = read[last[names[i]]];
}

/// Some rows of a part's data window, or all, as float.
std::vector<Plane<float>> read_rows(const ExrReader& reader, const ExrPart& part, Names names,
                                    const Window& window) {
  std::vector<Plane<float>> planes;
  std::vector<ChannelRows> rows;
  for (const std::string& name : names) {
    planes.push_back(Plane<float>::unset(window.width(), window.height()));
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

std::vector<Plane<float>> ExrReader::read(int index, Names names, const PixelGrid& grid) const {
  const ExrPart& part = flat_part(*this, index);
  check_size(*this, part, names, grid);
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
  check_size(*this, part, names);
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

const MissingChunks& ExrReader::missing(int index) const {
  const auto known = missing_.find(index);
  if (known != missing_.end()) return known->second;
  const ExrPart& part = parts()[std::size_t(index)];
  const bool looks = salvage() == Salvage::done;
  return missing_[index] = looks ? find_missing_chunks(*this, part) : MissingChunks();
}

std::vector<std::string> ExrReader::losses() const {
  std::vector<std::string> lines;
  for (const auto& [index, missing] : missing_) {
    if (missing.windows.empty()) continue;
    const ExrPart& part = parts()[std::size_t(index)];
    lines.push_back(
        fmt::format("{}: {}: {}", path().string(), label(part), describe(missing, part)));
  }
  return lines;
}

}  // namespace ssdo
