// SPDX-License-Identifier: Apache-2.0
#include "io/files/scratch_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "error.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

/// The folder that TMPDIR names, whether it exists or not.
fs::path folder() {
  std::error_code missing;
  const fs::path found = fs::temp_directory_path(missing);
  if (!missing) return found;
  const char* named = std::getenv("TMPDIR");
  return named ? named : "/tmp";
}

[[noreturn]] void fail(const std::string& what, int error) {
  throw Error(ExitCode::failed,
              fmt::format("{}: {} what frames of the shot have found ({}); set TMPDIR to a folder "
                          "on a disk with more room, or raise --mem-limit",
                          folder().string(), what, std::strerror(error)));
}

}  // namespace

ScratchFile::ScratchFile() {
  std::string name = folder() / "ssdo_scratch_XXXXXX";
  file_ = mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0) fail("cannot keep", errno);
  unlink(name.c_str());
}

ScratchFile::~ScratchFile() {
  if (file_ >= 0) close(file_);
}

ScratchFile::ScratchFile(ScratchFile&& from) noexcept : file_(std::exchange(from.file_, -1)) {}

void ScratchFile::write(const void* bytes, std::size_t count) {
  const auto* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t done = ::write(file_, at, count);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail("cannot keep", done < 0 ? errno : ENOSPC);
    at += done, count -= std::size_t(done);
  }
}

void ScratchFile::read(std::size_t from, void* bytes, std::size_t count) const {
  auto* to = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t done = pread(file_, to, count, off_t(from));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail("cannot read back", done < 0 ? errno : EIO);
    to += done, from += std::size_t(done), count -= std::size_t(done);
  }
}

}  // namespace ssdo
