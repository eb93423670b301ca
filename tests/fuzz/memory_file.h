// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace ssdo::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// A file without a disk, for functions that take a path.
class MemoryFile {
 public:
  /// Errors: aborts where the system gives none.
  MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile();

  /// Replaces all that it holds.
  void hold(Bytes bytes);

  const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

}  // namespace ssdo::fuzz
