// SPDX-License-Identifier: Apache-2.0
#include "io/files/checked_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "error.h"

namespace ssdo {

CheckedFile::CheckedFile(const SafeFile& file)
    : target_(file.target().string()), file_(std::fopen(file.temporary().c_str(), "wb")) {
  check(file_ != nullptr);
}

CheckedFile::~CheckedFile() {
  if (file_) std::fclose(file_);
}

void CheckedFile::write(const void* bytes, std::size_t size) {
  check(!failure_ && std::fwrite(bytes, 1, size, file_) == size);
  position_ += size;
}

void CheckedFile::seek(std::uint64_t position) {
  check(!failure_ && fseeko(file_, off_t(position), SEEK_SET) == 0);
  position_ = position;
}

void CheckedFile::close() {
  check(!failure_ && std::fflush(file_) == 0);
  check(std::fclose(std::exchange(file_, nullptr)) == 0);
}

void CheckedFile::check(bool succeeded) {
  if (!succeeded && !failure_) failure_ = errno ? errno : EIO;
  if (!failure_) return;
  throw Error(ExitCode::output,
              fmt::format("{}: cannot be written: {}; make room there or write elsewhere", target_,
                          std::generic_category().message(failure_)));
}

}  // namespace ssdo
