// SPDX-License-Identifier: Apache-2.0
#include "io/exr/deep_reader.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "error.h"
#include "io/exr/chunks/chunk_sizes.h"
#include "io/exr/chunks/deep_chunks.h"
#include "io/exr/chunks/exr_chunks.h"
#include "io/exr/chunks/packed_chunks.h"
#include "io/exr/file/exr_parts.h"
#include "io/size_guard.h"

namespace ssdo {
namespace {

/// A channel to read, and where it goes in a DeepSample.
struct Target {
  std::string name;
  float DeepSample::*member;
};

/// Reads one deep part of a file. Pixels of missing chunks have no samples.
class DeepPartReader {
 public:
  DeepPartReader(const ExrReader& file, int part)
      : file_(file), part_(file.parts()[std::size_t(part)]) {
    // The table of sample counts takes four bytes per pixel, also outside the image in a tile that
    // crosses its border; OpenEXR counts the bytes of a chunk's table in an int.
    const double tile = 4.0 * pixels_per_chunk(part_),
                 table = std::max(4.0 * double(part_.data_window.area()), tile);
    const bool overflows = tile > std::numeric_limits<int>::max();
    check_decoded_size(file_.path(), file_.input().bytes(), table, table,
                       overflows ? 0 : largest_ratio(part_));
    counts_.resize(part_.data_window.area());
    find_windows();
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
  /// Before it reads samples, OpenEXR reads the counts again, and writes as many samples as the new
  /// counts say: they must be the same.
  void read(Imf::DeepFrameBuffer buffer, bool samples) {
    const std::vector<unsigned> known = samples ? counts_ : std::vector<unsigned>();
    buffer.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, at_origin(counts_.data(), part_.data_window), sizeof(unsigned),
                   sizeof(unsigned) * std::size_t(part_.data_window.width())));
    try {
      if (!samples) check_chunk_sizes(file_, part_, part_.data_window, file_.missing(part_.index));
      DeepChunks chunks(file_, part_, buffer);
      for (const Window& window : windows_) chunks.read_counts(window);
      if (!samples) return;
      check_same_counts(known);
      for (const Window& window : windows_) chunks.read_samples(window);
    } catch (const std::exception& error) {
      throw_damaged(file_, part_, error);
    }
  }

  /// Plans to read the whole data window or, where chunks are missing, each sound chunk alone.
  void find_windows() {
    windows_ = {part_.data_window};
    const MissingChunks& missing = file_.missing(part_.index);
    if (missing.windows.empty()) return;
    const PackedChunks chunks(file_, part_);
    windows_.clear();
    for (std::size_t i = 0; i < chunks.count(); ++i)
      if (!is_missing(missing, chunks.window(i))) windows_.push_back(chunks.window(i));
    if (windows_.empty())
      throw_damaged(file_, part_, std::runtime_error("none of its chunks can be read"));
  }

  void check_same_counts(const std::vector<unsigned>& known) const {
    if (counts_ != known)
      throw std::runtime_error("its counts of samples changed while it was read");
  }

  const ExrReader& file_;
  const ExrPart& part_;
  std::vector<unsigned> counts_;
  std::vector<Window> windows_;  ///< to read, one after another
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
  check_decoded_size(file.path(), file.input().bytes(), values,
                     values + double(sizeof(DeepSample)) * count + pointers, largest_ratio(part));
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
