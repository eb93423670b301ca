// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunk_sizes.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>

#include "io/exr/exr_chunks.h"
#include "io/exr/exr_parts.h"
#include "io/exr/packed_chunks.h"
#include "io/exr/zip_chunk.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

using Bytes = std::span<const std::byte>;

/// How many whole numbers from `begin` on and before `end` are multiples of `step`.
std::size_t multiples(std::int64_t begin, std::int64_t end, std::int64_t step) {
  const auto floor = [step](std::int64_t n) { return n >= 0 ? n / step : ~(~n / step); };
  return std::size_t(floor(end - 1) - floor(begin - 1));
}

/// What a chunk of a flat part unpacks to.
std::size_t pixel_bytes(const ExrPart& part, const Window& chunk) {
  std::size_t bytes = 0;
  for (const ExrChannel& c : part.channels) {
    bytes += multiples(chunk.x0, chunk.x1, c.x_sampling) *
             multiples(chunk.y0, chunk.y1, c.y_sampling) * bytes_of(c.type);
  }
  return bytes;
}

/// `most` for bytes that are damaged or inflate to more: OpenEXR has messages for them.
std::size_t inflated_bytes(Bytes packed, std::size_t most) {
  const auto inflated = std::make_unique_for_overwrite<std::byte[]>(most);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!inflate) throw std::bad_alloc();
  std::size_t size = 0;
  const libdeflate_result result = libdeflate_zlib_decompress(
      inflate.get(), packed.data(), packed.size(), inflated.get(), most, &size);
  return result == LIBDEFLATE_SUCCESS ? size : most;
}

/// Of runs: a count n >= 0 and a byte that stands n + 1 times, or -n and n bytes.
std::size_t bytes_of_runs(Bytes packed) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < packed.size();) {
    const int count = static_cast<signed char>(packed[i]);
    bytes += std::size_t(count < 0 ? -count : count + 1);
    i += std::size_t(count < 0 ? 1 - count : 2);
  }
  return bytes;
}

/// Little endian, from `place` on.
std::uint64_t number_at(Bytes bytes, std::size_t place, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = size; i-- > 0;) number = number << 8 | std::uint64_t(bytes[place + i]);
  return number;
}

/// Whether a chunk of DWAA or DWAB holds its pixels. It begins with eleven numbers of eight bytes:
/// the second is the bytes of channels that are deflated, the third what these are packed to, the
/// eighth the bytes of channels that are stored as runs, and the tenth counts the first
/// coefficients of channels that are transformed in blocks of 8 x 8. Rules say which channel is
/// which; all of them together have to be there. From version 2 on the rules come next, with their
/// size before them, and then what is deflated. OpenEXR checks runs and coefficients only.
/// Source: OpenEXR 3.1, ImfDwaCompressor.h, DataSizesSingle.
bool holds_dwa_pixels(const ExrPart& part, const Window& chunk, Bytes packed) {
  constexpr std::size_t kNumbers = 11 * 8;
  if (packed.size() < kNumbers + 2) return false;
  const std::size_t all = pixel_bytes(part, chunk), deflated = number_at(packed, 8, 8),
                    deflated_to = number_at(packed, 16, 8), runs = number_at(packed, 56, 8),
                    coefficients = number_at(packed, 72, 8),
                    blocks = std::size_t((chunk.width() + 7) / 8) *
                             std::size_t((chunk.height() + 7) / 8),
                    transformed = coefficients / blocks,
                    rules = number_at(packed, 0, 8) < 2 ? 0 : number_at(packed, kNumbers, 2);
  if (coefficients % blocks != 0 || transformed > part.channels.size() || deflated > all ||
      kNumbers + rules > packed.size() || deflated_to > packed.size() - kNumbers - rules)
    return false;
  const auto is_all = [&](std::size_t halves) {  // of those that are transformed
    return deflated + runs + chunk.area() * (4 * transformed - 2 * halves) == all;
  };
  std::size_t halves = 0;
  while (halves <= transformed && !is_all(halves)) ++halves;
  return halves <= transformed &&
         (deflated == 0 ||
          inflated_bytes(packed.subspan(kNumbers + rules, deflated_to), deflated) == deflated);
}

bool is_sampled_everywhere(const ExrPart& part) {
  return std::ranges::all_of(part.channels, [](const ExrChannel& channel) {
    return channel.x_sampling == 1 && channel.y_sampling == 1;
  });
}

/// What the bytes of a chunk unpack to, as far as OpenEXR does not check that itself: it has an
/// error for PXR24 and B44, and decodes PIZ to as many values as there are pixels.
std::size_t unpacked_bytes(const ExrPart& part, const Window& chunk, Bytes packed,
                           std::size_t most) {
  if (packed.empty() || packed.size() >= most) return packed.size();
  switch (part.header.compression()) {
    case Imf::NO_COMPRESSION:
      return packed.size();
    case Imf::RLE_COMPRESSION:
      return bytes_of_runs(packed);
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
      return inflated_bytes(packed, most);
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return !is_sampled_everywhere(part) || holds_dwa_pixels(part, chunk, packed) ? most : 0;
    default:
      return most;
  }
}

}  // namespace

void check_chunk_size(const ExrPart& part, const PackedChunks& chunks, std::size_t chunk) {
  const auto bytes_of_chunk = [&](const Window& window) {
    return part.deep ? sizeof(std::uint32_t) * window.area() : pixel_bytes(part, window);
  };
  const Window window = chunks.window(chunk);
  // The table of a deep tile at the border may be that of a whole one.
  const std::size_t most = bytes_of_chunk(part.deep ? chunks.window(0) : window);
  const auto packed = chunks.read(chunk, most);
  // The same words for every chunk, whichever thread comes first.
  if (packed && unpacked_bytes(part, window, *packed, most) < bytes_of_chunk(window))
    throw std::runtime_error("a chunk holds fewer bytes than its pixels take");
}

void check_chunk_sizes(const ExrReader& file, const ExrPart& part, const Window& rows,
                       const MissingChunks& missing) {
  const PackedChunks chunks(file, part);
  const std::size_t first = chunks.first(rows.y0);
  for_each_task(chunks.end(rows.y1) - first, [&](std::size_t i) {
    if (!is_missing(missing, chunks.window(first + i))) check_chunk_size(part, chunks, first + i);
  });
}

}  // namespace ssdo
