// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/input_file.h"
#include "math/pixel_grid.h"
#include "math/plane.h"

namespace OPENEXR_IMF_INTERNAL_NAMESPACE {
class MultiPartInputFile;
}  // namespace OPENEXR_IMF_INTERNAL_NAMESPACE

namespace ssdo {

class ChunkTables;
class ExrInputStream;

/// One channel as the header declares it.
struct ExrChannel {
  std::string name;  ///< full name as stored, "ViewLayer.Position.X"
  Imf::PixelType type = Imf::FLOAT;
  int x_sampling = 1, y_sampling = 1;
};

/// One part: its header untouched, and what the header says, unpacked.
struct ExrPart {
  int index = 0;
  std::string name;  ///< empty in a single-part file without a name
  std::string view;  ///< the part's `view` attribute, or empty
  bool deep = false;
  Window data_window, display_window;
  std::vector<ExrChannel> channels;  ///< in the order of the header (sorted by name)
  Imf::Header header;
};

/// A string attribute of a header; empty where there is none of this name.
std::string string_attribute(const Imf::Header& header, const std::string& name);

/// An integer attribute of a header; 0 where there is none of this name.
int int_attribute(const Imf::Header& header, const std::string& name);

/// The views of a multi-view part, the default one first; empty where it has none.
std::vector<std::string> views_of(const Imf::Header& header);

/// The pixels of one channel in the type that the file stores, row by row over the data window.
struct StoredChannel {
  ExrChannel channel;
  std::vector<std::byte> pixels;
};

/// The chunks of a part that are cut off, were never written, or cannot be decoded.
struct MissingChunks {
  std::vector<Window> windows;  ///< the rows or full-resolution tiles, from the top left
  std::size_t count = 0;        ///< of all chunks, sound ones too
};

/// What becomes of flat parts with missing chunks.
enum class Salvage {
  none,     ///< they are errors
  offered,  ///< errors, which name --allow-partial
  done,     ///< their other chunks are read; a part without any is an error
};

/// An EXR of any kind that OpenEXR reads: scanline or tiled, one part or many, any windows.
/// Opening reads the headers only; pixels are read channel by channel when asked for, so that a
/// frame with a hundred AOVs costs the four that are used.
/// Errors: ExitCode::input for a file that is missing, is no EXR, or is damaged.
class ExrReader {
 public:
  explicit ExrReader(const std::filesystem::path& path, Salvage salvage = Salvage::none);
  ~ExrReader();
  ExrReader(ExrReader&&) noexcept;

  const InputFile& input() const { return *input_; }
  const std::filesystem::path& path() const { return input_->path(); }
  const std::vector<ExrPart>& parts() const { return parts_; }

  /// The named channels of a part as float planes over the part's data window; half and uint
  /// values are converted. Tiled parts give their full-resolution level. A deep part, a channel
  /// that does not exist or one that is subsampled is an error.
  /// Of `grid`, what it takes of the data window. Salvaged: missing pixels are NaN.
  std::vector<Plane<float>> read(int part, std::span<const std::string> channels,
                                 const PixelGrid& grid = {}) const;

  /// The named channels of a part, bit for bit as stored. Subsampled channels are allowed.
  /// Salvaged: missing pixels are 0.
  std::vector<StoredChannel> read_stored(int part, std::span<const std::string> channels) const;

  Salvage salvage() const { return salvage_; }

  /// What is missing of a flat part; nothing unless parts are salvaged. Looks at every chunk when
  /// it is first asked for.
  const MissingChunks& missing(int part) const;

  /// A line about each part of which something has been found missing so far.
  std::vector<std::string> losses() const;

  /// Makes the file readable again after a chunk that could not be read. No part may be open.
  void recover() const;

  /// Where the chunks of all parts stand. Looks for those whose places are missing when it is first
  /// asked for.
  const ChunkTables& chunk_tables() const;

  /// The open file, for copying whole parts without decoding them.
  Imf::MultiPartInputFile& file() const { return *file_; }

 private:
  std::unique_ptr<InputFile> input_;
  std::uint64_t tables_;  ///< where the headers end and the tables of chunks begin, in bytes
  Salvage salvage_;
  std::unique_ptr<ExrInputStream> stream_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::vector<ExrPart> parts_;
  mutable std::unique_ptr<ChunkTables> chunk_tables_;
  mutable std::map<int, MissingChunks> missing_;  ///< of the parts that were looked at
};

}  // namespace ssdo
