// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <span>
#include <streambuf>

namespace ssdo {

/// A file that is opened once and read in several places: it stays the same one where its path is
/// given to another file, or removed, in the meantime.
class InputFile {
 public:
  /// Sets errno where the file cannot be opened.
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  bool is_open() const { return descriptor_ >= 0; }
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t bytes() const;

  /// Reads the bytes from `place` on. Returns how many there are: fewer only where the file ends.
  /// From any thread. Errors: ExitCode::input where the system cannot read them.
  std::size_t read(std::uint64_t place, std::span<std::byte> to) const;

 private:
  std::filesystem::path path_;
  int descriptor_;  ///< negative: not open
};

/// The bytes of an InputFile, which has to live as long, with a position and a buffer of its own.
/// What the system cannot read is an error, as of InputFile::read(); the end of the file is not.
class InputStream : public std::istream {
 public:
  explicit InputStream(const InputFile& file) : std::istream(&buffer_), buffer_(file) {
    exceptions(std::ios::badbit);
  }

 private:
  class Buffer : public std::streambuf {
   public:
    explicit Buffer(const InputFile& file) : file_(file) {}

   protected:
    int_type underflow() override;
    std::streamsize xsgetn(char* to, std::streamsize count) override;
    pos_type seekoff(off_type by, std::ios::seekdir from, std::ios::openmode) override;
    pos_type seekpos(pos_type to, std::ios::openmode) override;

   private:
    const InputFile& file_;
    std::uint64_t next_ = 0;  ///< behind what is in the buffer
    std::array<char, 8192> bytes_;
  };
  Buffer buffer_;
};

}  // namespace ssdo
