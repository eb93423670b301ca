// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfIO.h>

#include <cstdint>

#include "io/checked_file.h"
#include "io/exr/exr_reader.h"

namespace ssdo {

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
