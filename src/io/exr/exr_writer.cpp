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
#include "io/checked_file.h"
#include "io/exr/exr_copy.h"
#include "io/exr/exr_headers.h"
#include "io/exr/exr_stream.h"
#include "io/exr/exr_strips.h"
#include "io/exr/kept_channels.h"
#include "io/exr/zip_output.h"
#include "io/one_line.h"

namespace ssdo {
namespace {

std::vector<KeptChannel> check_and_keep(const ExrOutput& output) {
  for (const ExrPart& part : output.input->parts()) check_downsampling(output, part);
  return kept_channels(output);
}

}  // namespace

class ExrWriter::File {
 public:
  File(const SafeFile& file, const ExrOutput& output)
      : output_(output),
        kept_(check_and_keep(output)),
        target_(file.target().string()),
        checked_(file),
        stream_(checked_, file.temporary().string()) {
    attempt([&] { open(); });
  }

  std::size_t write(std::span<const ChannelView> planes) {
    std::size_t clamped = 0;
    attempt([&] { clamped = strips_->write(planes); });
    return clamped;
  }

  void finish() {
    attempt([&] {
      strips_->finish();
      if (zip_)
        zip_->finish();
      else
        copy_parts(std::size_t(output_.part) + 1, output_.input->parts().size());
      part_.reset();
      exr_.reset();
    });
    // Reports also what OpenEXR's destructors, which write the offset tables, have swallowed.
    checked_.close();
  }

 private:
  /// Takes a step; what OpenEXR says becomes an error of ours.
  void attempt(const std::function<void()>& step) {
    try {
      step();
    } catch (const Error&) {
      throw;
    } catch (const std::exception& error) {
      if (checked_.failed()) checked_.close();
      throw Error(ExitCode::output, fmt::format("{}: cannot be written as EXR ({})", target_,
                                                one_line(error.what())));
    }
  }

  void open() {
    const std::vector<Imf::Header> headers = headers_for(output_, kept_);
    if (headers.size() == 1 && ZipOutput::takes(headers.front()))
      open_zip(headers.front());
    else
      open_parts(headers);
  }

  void open_zip(const Imf::Header& header) {
    const auto level = level_for(output_, header.compression());
    zip_.emplace(stream_, header, level.value_or(ZipOutput::kDefaultLevel));
    take_strips([this](const Imf::FrameBuffer& rows, int count) { zip_->write(rows, count); });
  }

  /// Has OpenEXR write the file. It holds the parts in their order.
  void open_parts(const std::vector<Imf::Header>& headers) {
    exr_ = std::make_unique<Imf::MultiPartOutputFile>(stream_, headers.data(), int(headers.size()));
    copy_parts(0, std::size_t(output_.part));
    part_.emplace(*exr_, output_.keep_channels ? output_.part : 0);
    take_strips([this](const Imf::FrameBuffer& rows, int count) {
      part_->setFrameBuffer(rows);
      part_->writePixels(count);
    });
  }

  void take_strips(ExrStrips::WriteRows write_rows) {
    const Window known = known_window(output_, part_of(output_));
    strips_.emplace(output_, slices_of(kept_, known), std::move(write_rows));
  }

  /// Parts of the input that are kept beside the one with the planes, from `first` to `last`.
  void copy_parts(std::size_t first, std::size_t last) {
    for (std::size_t i = first; output_.keep_channels && i < last; ++i) {
      const ExrPart& part = output_.input->parts()[i];
      if (is_changed(output_, part))
        write_anew(part);
      else
        copy_part(*output_.input, part, *exr_);
    }
  }

  void write_anew(const ExrPart& part) {
    const std::vector<KeptChannel> channels = all_channels(output_, part);
    Imf::OutputPart out(*exr_, part.index);
    out.setFrameBuffer(slices_of(channels, known_window(output_, part)));
    out.writePixels(written_window(output_, part).height());
  }

  const ExrOutput output_;
  const std::vector<KeptChannel> kept_;
  const std::string target_;
  CheckedFile checked_;
  ExrStream stream_;
  std::optional<ZipOutput> zip_;                   ///< writes the files that it takes
  std::unique_ptr<Imf::MultiPartOutputFile> exr_;  ///< writes all others
  std::optional<Imf::OutputPart> part_;            ///< of them, that with the planes
  std::optional<ExrStrips> strips_;
};

ExrWriter::ExrWriter(const SafeFile& file, const ExrOutput& output)
    : file_(std::make_unique<File>(file, output)) {}

ExrWriter::~ExrWriter() = default;

std::size_t ExrWriter::write(std::span<const ChannelView> planes) { return file_->write(planes); }

void ExrWriter::finish() { file_->finish(); }

std::size_t write_exr(const SafeFile& file, const ExrOutput& output) {
  std::vector<ChannelView> pixels;
  for (const ExrPlane& plane : output.planes) pixels.push_back(plane.pixels);
  ExrWriter writer(file, output);
  const std::size_t clamped = writer.write(pixels);
  writer.finish();
  return clamped;
}

}  // namespace ssdo
