// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <IexBaseExc.h>
#include <ImfIO.h>

#include <cstdint>

#include "io/files/checked_file.h"
#include "io/files/input_file.h"

namespace ssdo {

/// OpenEXR's view of an InputFile.
class ExrInputStream : public Imf::IStream {
 public:
  explicit ExrInputStream(const InputFile& file)
      : Imf::IStream(file.path().c_str()), stream_(file) {}

  bool read(char bytes[], int size) override {
    if (!stream_.read(bytes, size)) throw Iex::InputExc("Unexpected end of file.");
    const bool is_more = stream_.peek() != std::istream::traits_type::eof();
    if (!is_more) stream_.clear();  // no bytes may be read next
    return is_more;
  }
  std::uint64_t tellg() override { return std::uint64_t(stream_.tellg()); }
  void seekg(std::uint64_t position) override {
    stream_.clear();
    if (!stream_.seekg(std::streamoff(position))) throw Iex::InputExc("No such place in the file.");
  }
  void clear() override { stream_.clear(); }

 private:
  InputStream stream_;
};

/// OpenEXR's view of a CheckedFile. Its own streams do not notice when the last buffer, written on
/// closing, does not fit on the disk.
class ExrStream : public Imf::OStream {
 public:
  ExrStream(CheckedFile& file, const std::string& name) : Imf::OStream(name.c_str()), file_(file) {}

  void write(const char bytes[], int size) override { file_.write(bytes, std::size_t(size)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  CheckedFile& file_;
};

}  // namespace ssdo
