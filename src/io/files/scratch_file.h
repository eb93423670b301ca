// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace ssdo {

/// Bytes that a run keeps on disk for itself: a file without a name in the folder for temporary
/// files (TMPDIR), which is gone with the object or the process.
/// Errors of all calls: ExitCode::failed, as where the disk is full.
class ScratchFile {
 public:
  ScratchFile();
  ~ScratchFile();
  ScratchFile(ScratchFile&& from) noexcept;
  ScratchFile& operator=(ScratchFile&&) = delete;

  /// Appends bytes.
  void write(const void* bytes, std::size_t count);

  /// Reads bytes from the place `from` on.
  void read(std::size_t from, void* bytes, std::size_t count) const;

 private:
  int file_;
};

}  // namespace ssdo
