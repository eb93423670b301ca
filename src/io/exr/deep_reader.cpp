// SPDX-License-Identifier: Apache-2.0
#include "io/exr/deep_reader.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputPart.h>
#include <ImfDeepTiledInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "error.h"
#include "io/exr/chunk_sizes.h"
#include "io/exr/exr_parts.h"
#include "io/size_guard.h"

namespace ssdo {
namespace {

/// A channel to read, and where it goes in a DeepSample.
struct Target {
  std::string name;
  float DeepSample::*member;
};

/// The address that (0, 0) of the display window has in a plane over `window`.
template <class T>
char* at_origin(T* first, const Window& window) {
  const std::ptrdiff_t offset = std::ptrdiff_t(window.y0) * window.width() + window.x0;
  return reinterpret_cast<char*>(reinterpret_cast<std::uintptr_t>(first) -
                                 std::uintptr_t(offset) * sizeof(T));
}

/// Reads one deep part of a file.
class DeepPartReader {
 public:
  DeepPartReader(const ExrReader& file, int part)
      : file_(file), part_(file.parts()[std::size_t(part)]) {
    // The table of counts takes four bytes of each pixel, also in those of a tile that lie outside;
    // OpenEXR counts these in an int.
    const double tile = 4.0 * pixels_per_chunk(part_),
                 table = std::max(4.0 * double(part_.data_window.area()), tile);
    const bool overflows = tile > std::numeric_limits<int>::max();
    check_decoded_size(file_.path(), table, table, overflows ? 0 : largest_ratio(part_));
    counts_.resize(part_.data_window.area());
  }

  /// The first sample of each pixel, and the end.
  std::vector<std::size_t> read_counts() {
    read({}, false);
    std::vector<std::size_t> first(counts_.size() + 1, 0);
    for (std::size_t i = 0; i < counts_.size(); ++i) first[i + 1] = first[i] + counts_[i];
    return first;
  }

  /// Reads channels of the samples that read_counts() has counted.
  void read_samples(const std::vector<Target>& targets, const std::vector<std::size_t>& first,
                    std::vector<DeepSample>& samples) {
    std::vector<std::vector<char*>> places(targets.size());
    Imf::DeepFrameBuffer buffer;
    const std::size_t row = sizeof(char*) * std::size_t(part_.data_window.width());
    for (std::size_t t = 0; t < targets.size(); ++t) {
      places[t].resize(counts_.size());
      for (std::size_t i = 0; i < counts_.size(); ++i) {
        if (counts_[i] > 0)
          places[t][i] = reinterpret_cast<char*>(&(samples[first[i]].*targets[t].member));
      }
      buffer.insert(targets[t].name,
                    Imf::DeepSlice(Imf::FLOAT, at_origin(places[t].data(), part_.data_window),
                                   sizeof(char*), row, sizeof(DeepSample)));
    }
    read(buffer, true);
  }

  const ExrPart& part() const { return part_; }

 private:
  /// OpenEXR reads the counts again before it reads samples, and writes as many as they say then.
  void read(Imf::DeepFrameBuffer buffer, bool samples) {
    const std::vector<unsigned> known = samples ? counts_ : std::vector<unsigned>();
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, at_origin(counts_.data(), part_.data_window), sizeof(unsigned),
                   sizeof(unsigned) * std::size_t(part_.data_window.width())));
    try {
      if (!samples) check_chunk_sizes(file_, part_, part_.data_window);
      if (is_tiled(part_)) {
        Imf::DeepTiledInputPart tiles(file_.file(), part_.index);
        tiles.setFrameBuffer(buffer);
        const int x = tiles.numXTiles() - 1, y = tiles.numYTiles() - 1;
        tiles.readPixelSampleCounts(0, x, 0, y);
        if (!samples) return;
        check_same_counts(known);
        tiles.readTiles(0, x, 0, y);
      } else {
        Imf::DeepScanLineInputPart lines(file_.file(), part_.index);
        lines.setFrameBuffer(buffer);
        const int y = part_.data_window.y0, last = part_.data_window.y1 - 1;
        lines.readPixelSampleCounts(y, last);
        if (!samples) return;
        check_same_counts(known);
        lines.readPixels(y, last);
      }
    } catch (const std::exception& error) {
      throw_damaged(file_, part_, error);
    }
  }

  void check_same_counts(const std::vector<unsigned>& known) const {
    if (counts_ != known)
      throw std::runtime_error("its counts of samples changed while it was read");
  }

  const ExrReader& file_;
  const ExrPart& part_;
  std::vector<unsigned> counts_;
};

}  // namespace

DeepImage read_deep(const ExrReader& file, const DeepChannels& channels) {
  DeepPartReader lead(file, channels.front.part);
  const ExrPart& part = lead.part();
  const Imf::Channel* depth = part.header.channels().findChannel(channels.front.name);
  DeepImage image{file.path().string(), part.data_window,
                  part.display_window,  depth && depth->type == Imf::HALF,
                  lead.read_counts(),   {}};
  const std::pair<DeepChannel, float DeepSample::*> more[] = {{channels.back, &DeepSample::back},
                                                              {channels.alpha, &DeepSample::alpha}};
  std::vector<Target> targets = {{channels.front.name, &DeepSample::front}};
  for (const auto& [channel, member] : more) {
    if (!channel.name.empty() && channel.part == part.index)
      targets.push_back({channel.name, member});
  }
  const double count = double(image.first.back()), values = 4.0 * double(targets.size()) * count,
               pointers = double(sizeof(char*) * targets.size()) * double(part.data_window.area());
  check_decoded_size(file.path(), values, values + double(sizeof(DeepSample)) * count + pointers,
                     largest_ratio(part));
  image.samples.resize(image.first.back());
  lead.read_samples(targets, image.first, image.samples);
  for (const auto& [channel, member] : more) {
    if (channel.name.empty() || channel.part == part.index) continue;
    DeepPartReader other(file, channel.part);
    if (!(other.part().data_window == image.window) || other.read_counts() != image.first) {
      throw Error(ExitCode::input,
                  fmt::format("{}: {} and {} do not hold the same samples; write depth and alpha "
                              "into one part",
                              file.path().string(), label(part), label(other.part())));
    }
    other.read_samples({{channel.name, member}}, image.first, image.samples);
  }
  if (channels.back.name.empty()) {
    for (DeepSample& s : image.samples) s.back = s.front;
  }
  return image;
}

}  // namespace ssdo
