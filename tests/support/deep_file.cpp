// SPDX-License-Identifier: Apache-2.0
#include "support/deep_file.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>

#include <cstring>

namespace ssdo::test {
namespace {

/// The values of one channel as stored, and where each pixel's begin.
struct StoredSamples {
  std::vector<char> bytes;
  std::vector<char*> places;

  StoredSamples(const DeepPart& part, float DeepSample::*member) {
    const std::size_t size = part.type == Imf::HALF ? 2 : 4;
    std::vector<std::size_t> begins;
    for (const auto& samples : part.pixels.samples) {
      begins.push_back(bytes.size());
      for (const DeepSample& s : samples) {
        const float value = s.*member;
        const half rounded(value);
        const char* from = size == 2 ? reinterpret_cast<const char*>(&rounded)
                                     : reinterpret_cast<const char*>(&value);
        bytes.insert(bytes.end(), from, from + size);
      }
    }
    for (const std::size_t begin : begins) places.push_back(bytes.data() + begin);
  }
};

/// The address of pixel (0, 0) in values over a window.
template <class T>
char* at_origin(std::vector<T>& values, const Window& w) {
  return reinterpret_cast<char*>(values.data()) -
         (std::ptrdiff_t(w.y0) * w.width() + w.x0) * std::ptrdiff_t(sizeof(T));
}

Imf::Header header_of(const DeepPart& part) {
  const Window& display = part.display.area() > 0 ? part.display : part.pixels.window;
  Imf::Header header(box_of(display), box_of(part.pixels.window));
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.setType(part.tiles ? Imf::DEEPTILE : Imf::DEEPSCANLINE);
  if (part.tiles) header.setTileDescription(Imf::TileDescription(16, 16));
  header.setName(part.name.empty() ? "deep" : part.name);
  for (const std::string& name : {part.front, part.back, part.alpha})
    if (!name.empty()) header.channels().insert(name, Imf::Channel(part.type));
  return header;
}

void write_part(Imf::MultiPartOutputFile& file, int index, const DeepPart& part) {
  const Window& w = part.pixels.window;
  std::vector<unsigned> counts;
  for (const auto& samples : part.pixels.samples) counts.push_back(unsigned(samples.size()));
  std::vector<StoredSamples> stored;
  stored.reserve(3);
  Imf::DeepFrameBuffer buffer;
  const auto row = std::size_t(w.width());
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, at_origin(counts, w), 4, 4 * row));
  for (const auto& [name, member] :
       {std::pair(part.front, &DeepSample::front), std::pair(part.back, &DeepSample::back),
        std::pair(part.alpha, &DeepSample::alpha)}) {
    if (name.empty()) continue;
    stored.emplace_back(part, member);
    buffer.insert(name, Imf::DeepSlice(part.type, at_origin(stored.back().places, w), sizeof(char*),
                                       sizeof(char*) * row, part.type == Imf::HALF ? 2 : 4));
  }
  if (part.tiles) {
    Imf::DeepTiledOutputPart out(file, index);
    out.setFrameBuffer(buffer);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
  } else {
    Imf::DeepScanLineOutputPart out(file, index);
    out.setFrameBuffer(buffer);
    out.writePixels(w.height());
  }
}

}  // namespace

void write_deep(const std::filesystem::path& path, const std::vector<DeepPart>& parts) {
  std::vector<Imf::Header> headers;
  for (const DeepPart& part : parts) headers.push_back(header_of(part));
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (std::size_t i = 0; i < parts.size(); ++i) write_part(file, int(i), parts[i]);
}

DeepImage image_of(const DeepPixels& pixels) {
  DeepImage image{"test", pixels.window, pixels.window, false, {0}, {}};
  for (const auto& samples : pixels.samples) {
    image.samples.insert(image.samples.end(), samples.begin(), samples.end());
    image.first.push_back(image.samples.size());
  }
  return image;
}

}  // namespace ssdo::test
