// SPDX-License-Identifier: Apache-2.0
#include "io/exr/zip_output.h"

#include <ImfChannelList.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "io/exr/chunks/zip_chunk.h"
#include "io/exr/file/exr_parts.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

template <class Number>
void write_number(Imf::OStream& stream, Number number) {
  stream.write(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Puts the bytes with even places before the others, as differences: see
/// io/exr/chunks/zip_chunk.h.
void split_into_differences(const std::vector<std::byte>& bytes, std::vector<std::byte>& out) {
  const std::size_t evens = (bytes.size() + 1) / 2;
  std::vector<std::byte> split(bytes.size());
  for (std::size_t i = 0; i < bytes.size() / 2; ++i)
    split[i] = bytes[2 * i], split[evens + i] = bytes[2 * i + 1];
  out.resize(bytes.size());
  out[0] = split[0];
  for (std::size_t i = 1; i < bytes.size(); ++i)
    out[i] = std::byte(unsigned(split[i]) - unsigned(split[i - 1]) + 128);
}

}  // namespace

bool ZipOutput::takes(const Imf::Header& header) {
  bool full = true;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    full = full && c.channel().xSampling == 1 && c.channel().ySampling == 1;
  return full && is_zip(header.compression()) &&
         (!header.hasType() || header.type() == Imf::SCANLINEIMAGE) &&
         header.lineOrder() == Imf::INCREASING_Y;
}

ZipOutput::ZipOutput(Imf::OStream& stream, const Imf::Header& header, int level)
    : stream_(stream),
      header_(header),
      level_(level),
      chunk_rows_(lines_per_chunk(header.compression())),
      y_(header.dataWindow().min.y) {
  // OpenEXR writes the header and a table of chunks, which finish() fills.
  { const Imf::MultiPartOutputFile empty(stream, &header, 1); }
  const Imath::Box2i& window = header.dataWindow();
  const auto chunks = std::uint64_t((window.max.y - window.min.y) / chunk_rows_ + 1);
  table_ = stream.tellp() - chunks * sizeof(std::uint64_t);
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    line_bytes_ += bytes_of(c.channel().type) * std::size_t(window.max.x - window.min.x + 1);
}

void ZipOutput::write(const Imf::FrameBuffer& frame_buffer, int rows) {
  std::vector<std::vector<std::byte>> chunks(std::size_t((rows + chunk_rows_ - 1) / chunk_rows_));
  for_each_task(chunks.size(), [&](std::size_t k) {
    const int first = int(k) * chunk_rows_;
    chunks[k] = pack(frame_buffer, y_ + first, std::min(chunk_rows_, rows - first));
  });
  for (const std::vector<std::byte>& chunk : chunks) {
    offsets_.push_back(stream_.tellp());
    write_number(stream_, std::int32_t(y_));
    write_number(stream_, std::int32_t(chunk.size()));
    stream_.write(reinterpret_cast<const char*>(chunk.data()), int(chunk.size()));
    y_ += std::min(chunk_rows_, rows);
    rows -= chunk_rows_;
  }
}

std::vector<std::byte> ZipOutput::pack(const Imf::FrameBuffer& frame_buffer, int y,
                                       int rows) const {
  const Imath::Box2i& window = header_.dataWindow();
  std::vector<std::byte> bytes(std::size_t(rows) * line_bytes_);
  std::byte* to = bytes.data();
  for (int row = y; row < y + rows; ++row) {
    for (auto c = header_.channels().begin(); c != header_.channels().end(); ++c) {
      const Imf::Slice& slice = frame_buffer[c.name()];
      const std::size_t size = bytes_of(slice.type) * std::size_t(window.max.x - window.min.x + 1);
      const char* from = slice.base + std::ptrdiff_t(slice.xStride) * window.min.x +
                         std::ptrdiff_t(slice.yStride) * row;
      std::memcpy(to, from, size);
      to += size;
    }
  }
  std::vector<std::byte> differences;
  split_into_differences(bytes, differences);
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> deflate(
      libdeflate_alloc_compressor(level_), libdeflate_free_compressor);
  if (!deflate) throw std::bad_alloc();
  // The buffer is too small for a chunk that does not shrink, which is then stored unpacked.
  std::vector<std::byte> packed(bytes.size() - 1);
  packed.resize(libdeflate_zlib_compress(deflate.get(), differences.data(), differences.size(),
                                         packed.data(), packed.size()));
  return packed.empty() ? bytes : packed;
}

void ZipOutput::finish() {
  const std::uint64_t end = stream_.tellp();
  stream_.seekp(table_);
  for (const std::uint64_t offset : offsets_) write_number(stream_, offset);
  stream_.seekp(end);
}

}  // namespace ssdo
