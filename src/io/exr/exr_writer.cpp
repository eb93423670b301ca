// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_writer.h"

#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <fmt/format.h>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "error.h"
#include "io/exr/exr_copy.h"
#include "io/exr/exr_headers.h"
#include "io/exr/exr_strips.h"
#include "io/exr/file/exr_stream.h"
#include "io/exr/kept_channels.h"
#include "io/exr/zip_output.h"
#include "io/files/checked_file.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

std::vector<std::vector<KeptChannel>> check_and_keep(const std::vector<ExrOutput>& parts) {
  for (const ExrPart& part : parts.front().input->parts()) check_downsampling(parts.front(), part);
  std::vector<std::vector<KeptChannel>> kept;
  for (const ExrOutput& part : parts) kept.push_back(kept_channels(part));
  return kept;
}

}  // namespace

class ExrWriter::File {
 public:
  File(const SafeFile& file, std::vector<ExrOutput> parts)
      : parts_(std::move(parts)),
        kept_(check_and_keep(parts_)),
        target_(file.target().string()),
        checked_(file),
        stream_(checked_, file.temporary().string()) {
    attempt([&] { open(); });
  }

  std::size_t write(std::span<const ChannelView> planes) {
    std::size_t clamped = 0;
    attempt([&] {
      clamped = strips_->write(planes);
      if (strips_->is_complete() && current_ + 1 < parts_.size()) begin_part(current_ + 1);
    });
    return clamped;
  }

  void finish() {
    attempt([&] {
      strips_->finish();
      if (zip_)
        zip_->finish();
      else
        copy_parts(std::size_t(parts_.back().part) + 1, input().parts().size());
      part_.reset();
      exr_.reset();
    });
    // Reports also what OpenEXR's destructors, which write the offset tables, have swallowed.
    checked_.close();
  }

 private:
  const ExrReader& input() const { return *parts_.front().input; }

  /// Takes a step; what OpenEXR says becomes an error of ours.
  void attempt(const std::function<void()>& step) {
    try {
      step();
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      if (checked_.failed()) checked_.close();
      throw Error(ExitCode::output, fmt::format("{}: cannot be written as EXR ({})", target_,
                                                one_line(error.what())));
    }
  }

  void open() {
    const std::vector<Imf::Header> headers = headers_for(parts_, kept_);
    if (headers.size() == 1 && ZipOutput::takes(headers.front())) return open_zip(headers.front());
    exr_ = std::make_unique<Imf::MultiPartOutputFile>(stream_, headers.data(), int(headers.size()));
    begin_part(0);
  }

  void open_zip(const Imf::Header& header) {
    const auto level = level_for(parts_.front(), header.compression());
    zip_.emplace(stream_, header, level.value_or(ZipOutput::kDefaultLevel));
    take_strips([this](const Imf::FrameBuffer& rows, int count) { zip_->write(rows, count); });
  }

  /// Has OpenEXR write the next part with planes, after those of the input before it.
  void begin_part(std::size_t next) {
    const bool keeps = parts_[next].keep_channels;
    const std::size_t first = next == 0 ? 0 : std::size_t(parts_[next - 1].part) + 1;
    current_ = next;
    copy_parts(first, std::size_t(parts_[next].part));
    part_.emplace(*exr_, keeps ? parts_[next].part : int(next));
    take_strips([this](const Imf::FrameBuffer& rows, int count) {
      part_->setFrameBuffer(rows);
      part_->writePixels(count);
    });
  }

  void take_strips(ExrStrips::WriteRows write_rows) {
    const ExrOutput& part = parts_[current_];
    strips_.emplace(part, slices_of(kept_[current_], known_window(part, part_of(part))),
                    std::move(write_rows));
  }

  /// Parts of the input that are kept beside those with planes, from `first` to `last`.
  void copy_parts(std::size_t first, std::size_t last) {
    for (std::size_t i = first; parts_.front().keep_channels && i < last; ++i) {
      const ExrPart& part = input().parts()[i];
      if (is_changed(parts_.front(), part))
        write_anew(part);
      else
        copy_part(input(), part, *exr_);
    }
  }

  void write_anew(const ExrPart& part) {
    const ExrOutput& how = parts_.front();
    const std::vector<KeptChannel> channels = all_channels(how, part);
    Imf::OutputPart out(*exr_, part.index);
    out.setFrameBuffer(slices_of(channels, known_window(how, part)));
    out.writePixels(written_window(how, part).height());
  }

  const std::vector<ExrOutput> parts_;  ///< those with planes
  const std::vector<std::vector<KeptChannel>> kept_;
  const std::string target_;
  CheckedFile checked_;
  ExrStream stream_;
  std::optional<ZipOutput> zip_;                   ///< writes the files that it takes
  std::unique_ptr<Imf::MultiPartOutputFile> exr_;  ///< writes all others
  std::size_t current_ = 0;                        ///< of `parts_`, the one being written
  std::optional<Imf::OutputPart> part_;            ///< of `exr_`, the same
  std::optional<ExrStrips> strips_;
};

ExrWriter::ExrWriter(const SafeFile& file, std::vector<ExrOutput> parts)
    : file_(std::make_unique<File>(file, std::move(parts))) {}

ExrWriter::~ExrWriter() = default;

std::size_t ExrWriter::write(std::span<const ChannelView> planes) { return file_->write(planes); }

void ExrWriter::finish() { file_->finish(); }

std::size_t write_exr(const SafeFile& file, const std::vector<ExrOutput>& parts) {
  ExrWriter writer(file, parts);
  std::size_t clamped = 0;
  for (const ExrOutput& part : parts) {
    std::vector<ChannelView> pixels;
    for (const ExrPlane& plane : part.planes) pixels.push_back(plane.pixels);
    clamped += writer.write(pixels);
  }
  writer.finish();
  return clamped;
}

}  // namespace ssdo
