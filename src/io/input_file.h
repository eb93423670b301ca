// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

namespace ssdo {

/// A file that is read in several places: it stays the same one where its path is given to another
/// file, or removed, in the meantime.
class InputFile {
 public:
  /// Sets errno where the file cannot be opened.
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(InputFile&&) noexcept;

  bool is_open() const { return descriptor_ >= 0; }
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t bytes() const;

  /// The bytes from the first on, with a position of its own. Fails where the file cannot be read.
  std::ifstream stream() const;

 private:
  std::filesystem::path path_;
  int descriptor_;  ///< negative: not open
};

}  // namespace ssdo
