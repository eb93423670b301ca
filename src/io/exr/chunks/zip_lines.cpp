// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/zip_lines.h"

#include <ImfChannelList.h>
#include <half.h>
#include <libdeflate.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "error.h"
#include "io/exr/chunks/packed_chunks.h"
#include "io/exr/chunks/zip_chunk.h"
#include "io/exr/file/exr_parts.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Sums up the differences of consecutive bytes, eight at a time: the even and the odd bytes of a
/// word are four lanes of 16 bits each, and a product with ones has the sum of the first k of them
/// in its k-th lane.
void sum_differences(std::byte* bytes, std::size_t count) {
  constexpr std::uint64_t kLanes = 0x00ff00ff00ff00ff, kOnes = 0x0001000100010001,
                          kOffsets = 0x8080808080808080;
  std::uint64_t sum = 0x80;  // the first byte has no offset
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes + i, 8);
    word ^= kOffsets;  // modulo 256, as adding or subtracting 128
    const std::uint64_t even = (word & kLanes) * kOnes, odd = ((word >> 8) & kLanes) * kOnes,
                        before = sum * kOnes;
    const std::uint64_t sums =
        ((even + (odd << 16) + before) & kLanes) | (((even + odd + before) & kLanes) << 8);
    sum = (sum + ((even + odd) >> 48)) & 0xff;
    std::memcpy(bytes + i, &sums, 8);
  }
  for (; i < count; ++i) {
    sum += std::uint64_t(bytes[i]) ^ 0x80;
    bytes[i] = std::byte(sum & 0xff);
  }
}

/// Bytes of a chunk, in pixel order or with the even ones before the odd ones.
struct ChunkBytes {
  const std::byte* bytes;
  std::size_t count;
  bool split;

  /// Copies `length` bytes from `begin` on; both are even.
  void copy(std::size_t begin, std::size_t length, std::byte* to) const {
    if (!split) {
      std::memcpy(to, bytes + begin, length);
      return;
    }
    const std::byte *even = bytes + begin / 2, *odd = even + count / 2;
    for (std::size_t i = 0; i < length / 2; ++i) to[2 * i] = even[i], to[2 * i + 1] = odd[i];
  }
};

class ZipLines {
 public:
  ZipLines(const ExrFile& file, const ExrPart& part, const Window& rows,
           std::span<const ChannelRows> channels)
      : chunks_(file, part), rows_(rows), columns_(std::size_t(part.data_window.width())) {
    std::multimap<std::string_view, const ChannelRows*> wanted;
    for (const ChannelRows& rows_of : channels) wanted.emplace(rows_of.channel.name, &rows_of);
    for (const ExrChannel& channel : part.channels) {
      for (auto [it, end] = wanted.equal_range(channel.name); it != end; ++it)
        wanted_.push_back({*it->second, line_bytes_});
      line_bytes_ += bytes_of(channel.type) * columns_;
    }
  }

  bool read() {
    std::atomic<bool> sound = true;
    const std::size_t first = chunks_.first(rows_.y0), end = chunks_.end(rows_.y1);
    for_each_task(end - first, [&](std::size_t i) {
      if (sound && !read_chunk(first + i)) sound = false;
    });
    return sound;
  }

 private:
  struct Wanted {
    ChannelRows rows;
    std::size_t offset;  ///< in a line
  };

  /// False for a chunk that is missing or damaged.
  bool read_chunk(std::size_t chunk) const {
    const Window window = chunks_.window(chunk);
    const std::size_t size = std::size_t(window.height()) * line_bytes_;
    std::vector<std::byte> packed;
    try {
      packed = chunks_.read(chunk, size);
    } catch (const Error&) {
      throw;  // the disk failed, not the file
    } catch (const std::runtime_error&) {
      return false;
    }
    if (packed.size() == size) {
      unpack({packed.data(), size, false}, window);
      return true;
    }
    const auto inflated = std::make_unique_for_overwrite<std::byte[]>(size);
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
        libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
    if (!inflate || libdeflate_zlib_decompress(inflate.get(), packed.data(), packed.size(),
                                               inflated.get(), size, nullptr) != LIBDEFLATE_SUCCESS)
      return false;
    sum_differences(inflated.get(), size);
    unpack({inflated.get(), size, true}, window);
    return true;
  }

  void unpack(const ChunkBytes& chunk, const Window& window) const {
    std::vector<half> halves(columns_);
    const int first = std::max(window.y0, rows_.y0), end = std::min(window.y1, rows_.y1);
    for (int row = first; row < end; ++row) {
      for (const auto& [to, offset] : wanted_) {
        const std::size_t begin = std::size_t(row - window.y0) * line_bytes_ + offset,
                          stored = bytes_of(to.channel.type) * columns_,
                          line = std::size_t(row - rows_.y0);
        if (to.channel.type == Imf::HALF && to.as_float) {
          chunk.copy(begin, stored, reinterpret_cast<std::byte*>(halves.data()));
          std::copy(halves.begin(), halves.end(),
                    reinterpret_cast<float*>(to.pixels) + line * columns_);
        } else {
          chunk.copy(begin, stored, to.pixels + line * stored);
        }
      }
    }
  }

  const PackedChunks chunks_;
  const Window rows_;
  const std::size_t columns_;
  std::size_t line_bytes_ = 0;  ///< of all channels
  std::vector<Wanted> wanted_;
};

/// Whether chunks are as in io/exr/chunks/zip_chunk.h, and at most half has to become float.
bool is_readable(const ExrPart& part, std::span<const ChannelRows> channels) {
  return is_zip(part.header.compression()) && !part.deep && !is_tiled(part) &&
         std::all_of(part.channels.begin(), part.channels.end(),
                     [](const ExrChannel& c) { return c.x_sampling == 1 && c.y_sampling == 1; }) &&
         std::none_of(channels.begin(), channels.end(), [](const ChannelRows& to) {
           return to.as_float && to.channel.type == Imf::UINT;
         });
}

}  // namespace

bool read_zip_lines(const ExrFile& file, const ExrPart& part, const Window& rows,
                    std::span<const ChannelRows> channels) {
  return is_readable(part, channels) && ZipLines(file, part, rows, channels).read();
}

}  // namespace ssdo
