// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/deep_chunks.h"

#include <numeric>
#include <stdexcept>
#include <vector>

#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

/// The first and last of the tiles of a part that a window covers.
struct TileRange {
  int x0, x1, y0, y1;

  TileRange(const ExrPart& part, const Window& window) {
    const Imf::TileDescription& tile = part.header.tileDescription();
    const auto number = [](int place, int begin, unsigned side) {
      return int((std::int64_t(place) - begin) / side);
    };
    x0 = number(window.x0, part.data_window.x0, tile.xSize);
    x1 = number(window.x1 - 1, part.data_window.x0, tile.xSize);
    y0 = number(window.y0, part.data_window.y0, tile.ySize);
    y1 = number(window.y1 - 1, part.data_window.y0, tile.ySize);
  }
};

}  // namespace

DeepChunks::DeepChunks(const ExrFile& file, const ExrPart& part, const Imf::DeepFrameBuffer& buffer)
    : part_(part) {
  if (is_tiled(part))
    tiles_.emplace(file.file(), part.index).setFrameBuffer(buffer);
  else
    lines_.emplace(file.file(), part.index).setFrameBuffer(buffer);
}

void DeepChunks::read_counts(const Window& window) {
  if (lines_) return lines_->readPixelSampleCounts(window.y0, window.y1 - 1);
  const TileRange tiles(part_, window);
  tiles_->readPixelSampleCounts(tiles.x0, tiles.x1, tiles.y0, tiles.y1);
}

void DeepChunks::read_samples(const Window& window) {
  if (lines_) return lines_->readPixels(window.y0, window.y1 - 1);
  const TileRange tiles(part_, window);
  tiles_->readTiles(tiles.x0, tiles.x1, tiles.y0, tiles.y1);
}

void try_deep_chunk(const ExrFile& file, const ExrPart& part, const Window& chunk) {
  std::vector<unsigned> counts(chunk.area());
  std::vector<char*> places(chunk.area());
  const std::size_t width = std::size_t(chunk.width());
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, at_origin(counts.data(), chunk),
                                           sizeof(unsigned), width * sizeof(unsigned)));
  buffer.insert(part.channels[0].name,
                Imf::DeepSlice(Imf::FLOAT, at_origin(places.data(), chunk), sizeof(char*),
                               width * sizeof(char*), sizeof(float)));
  DeepChunks chunks(file, part, buffer);
  chunks.read_counts(chunk);
  const auto count = std::accumulate(counts.begin(), counts.end(), std::size_t(0));
  if (double(count) * sizeof(float) > double(file.input().bytes()) * largest_ratio(part))
    throw std::runtime_error("a chunk claims more samples than the file can hold");
  std::vector<float> samples(count);
  for (std::size_t i = 0, first = 0; i < counts.size(); first += counts[i++])
    places[i] = reinterpret_cast<char*>(samples.data() + first);
  chunks.read_samples(chunk);
}

}  // namespace ssdo
