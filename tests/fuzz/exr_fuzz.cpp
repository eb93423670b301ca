// SPDX-License-Identifier: Apache-2.0
//
// Flat EXRs, and flat parts beside deep ones: every channel, as float and as stored, and what the
// names of layers say.
// ZIP chunks that our own code takes have to give what OpenEXR gives. Some files are written again.
// The last two bytes choose which, and which are salvaged.
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include <algorithm>
#include <iterator>

#include "fuzz/exr_mutation.h"
#include "fuzz/real_files.h"
#include "fuzz/target.h"
#include "fuzz/written_back.h"
#include "io/exr/chunks/zip_chunk.h"
#include "io/exr/exr_reader.h"
#include "io/exr/file/exr_parts.h"
#include "io/exr/header_numbers.h"
#include "scene/layers/groups.h"
#include "scene/layers/layers.h"

namespace ssdo::fuzz {
namespace {

/// What OpenEXR's own reader gives.
std::vector<StoredChannel> by_openexr(const ExrReader& file, const ExrPart& part,
                                      std::vector<StoredChannel> like) {
  const Window& window = part.data_window;
  const Imath::Box2i box({window.x0, window.y0}, {window.x1 - 1, window.y1 - 1});
  Imf::FrameBuffer buffer;
  for (auto& [channel, pixels] : like) {
    std::fill(pixels.begin(), pixels.end(), std::byte(0));
    buffer.insert(channel.name, Imf::Slice::Make(channel.type, pixels.data(), box, 0, 0));
  }
  Imf::InputPart lines(file.file(), part.index);
  lines.setFrameBuffer(buffer);
  lines.readPixels(window.y0, window.y1 - 1);
  return like;
}

void compare(const ExrReader& file, const ExrPart& part, const std::vector<StoredChannel>& ours) {
  const std::vector<StoredChannel> theirs = by_openexr(file, part, ours);
  for (std::size_t i = 0; i < ours.size(); ++i)
    require(ours[i].pixels == theirs[i].pixels, "the ZIP code and OpenEXR read other pixels");
}

/// Whether a file can be written in some seconds: headers may claim a thousand times its bytes.
bool is_small(const ExrReader& file) {
  constexpr std::size_t kMostPixels = 1 << 20;
  return std::ranges::all_of(file.parts(), [](const ExrPart& part) {
    return part.data_window.area() * part.channels.size() <= kMostPixels;
  });
}

void read_part(const ExrReader& file, const ExrPart& part, unsigned choices) {
  std::vector<std::string> full, all;
  for (const ExrChannel& channel : part.channels) {
    all.push_back(channel.name);
    if (channel.x_sampling == 1 && channel.y_sampling == 1) full.push_back(channel.name);
  }
  may_refuse([&] { file.read(part.index, full); });
  may_refuse([&] { file.read(part.index, full, PixelGrid{.stride = kOverviewStride}); });
  may_refuse([&] {
    const std::vector<StoredChannel> stored = file.read_stored(part.index, all);
    const bool is_whole = file.salvage() == Salvage::none;
    if (is_whole && is_zip(part.header.compression()) && !is_tiled(part) && all == full)
      compare(file, part, stored);
    if (choices % 4 == 3 && is_small(file)) write_back(file, part, choices / 4);
  });
}

}  // namespace

void read_input(Bytes input) {
  static MemoryFile memory;
  memory.hold(input);
  const unsigned choices = tail_of(input);
  may_refuse([&] {
    const ExrReader file(memory.path(), choices % 4 == 3 ? Salvage::done : Salvage::none);
    for (const ExrPart& part : file.parts()) {
      read_part(file, part, choices / 4);
      header_numbers(file, part.index);
      is_by_blender(part.header);
    }
    views_of(group_channels(file, 0));
    find_layers({&file}, {}, "");
  });
}

namespace {

std::vector<ExrKind> kinds() {
  std::vector<ExrKind> all = flat_kinds();
  std::ranges::copy(mixed_kinds(), std::back_inserter(all));
  return all;
}

}  // namespace

std::vector<std::string> seeds() { return joined(exr_samples(kinds()), real_frames()); }

}  // namespace ssdo::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return ssdo::fuzz::mutate_exr(data, size, most, ssdo::fuzz::kinds(), seed);
}
