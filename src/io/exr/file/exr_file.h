// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <vector>

#include "io/exr/file/exr_parts.h"
#include "io/files/input_file.h"

// OpenEXR's C library, OpenEXRCore 3.1.5 of Debian 12, cannot take the place of its C++ reader and
// of what keeps that from crashing (attribute_sizes, chunk_tables, packed_chunks, chunk_sizes).
// It reads 10,000 files that tests/fuzz changes without a crash, and finds chunks whose places are
// missing, but
// - it does not decode DWAA and DWAB;
// - it mixes up the channels of B44 and B44A where all are float or uint: it takes a chunk that did
//   not get smaller, and is stored as it was, for a packed one;
// - it refuses files that have flat parts beside deep ones: the flat ones lack `version`;
// - it overlooks the size of an uncompressed chunk: bytes of the next one become pixels;
// - it does not find the tiles of rip maps where their places are missing.
// These, and copying parts, would need the C++ reader and its guards as before.

namespace ssdo {

class ChunkTables;
class ExrInputStream;

/// What becomes of flat parts with missing chunks.
enum class Salvage {
  none,     ///< they are errors
  offered,  ///< errors, which name --allow-partial
  done,     ///< their other chunks are read; a part without any is an error
};

/// An EXR that is open, of which the headers have been read.
class ExrFile {
 public:
  /// Errors: ExitCode::input for a file that is missing, is no EXR, or is damaged in its header.
  explicit ExrFile(const std::filesystem::path& path, Salvage salvage = Salvage::none);
  ~ExrFile();

  const InputFile& input() const { return *input_; }
  const std::filesystem::path& path() const { return input_->path(); }
  const std::vector<ExrPart>& parts() const { return parts_; }
  Salvage salvage() const { return salvage_; }

  /// Makes the file readable again after a chunk that could not be read. No part may be open.
  void recover() const;

  /// Where the chunks of all parts stand. Looks for those whose places are missing when it is first
  /// asked for.
  const ChunkTables& chunk_tables() const;

  /// OpenEXR's file, for reading chunks, and for copying whole parts without decoding them.
  Imf::MultiPartInputFile& file() const { return *file_; }

 private:
  std::unique_ptr<InputFile> input_;
  std::uint64_t tables_;  ///< where the headers end and the tables of chunks begin, in bytes
  Salvage salvage_;
  std::unique_ptr<ExrInputStream> stream_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::vector<ExrPart> parts_;
  mutable std::unique_ptr<ChunkTables> chunk_tables_;
};

/// Whether `file` is a plain file that begins as an EXR does, whatever its name.
bool begins_as_exr(const std::filesystem::path& file);

/// Throws `error` itself where the file is not at fault: errors of memory and of the disk.
void throw_unless_of_file(const std::exception& error);

/// Throws ExitCode::input for a part whose pixels could not be read.
[[noreturn]] void throw_damaged(const ExrFile& file, const ExrPart& part,
                                const std::exception& error);

}  // namespace ssdo
