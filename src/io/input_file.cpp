// SPDX-License-Identifier: Apache-2.0
#include "io/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <utility>

namespace ssdo {

InputFile::InputFile(std::filesystem::path path)
    : path_(std::move(path)), descriptor_(open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {}

InputFile::~InputFile() {
  if (is_open()) close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

std::uint64_t InputFile::bytes() const {
  struct stat status = {};
  return fstat(descriptor_, &status) == 0 ? std::uint64_t(status.st_size) : 0;
}

/// Linux opens what is open once more by the name of its descriptor.
std::ifstream InputFile::stream() const {
  std::ifstream stream(fmt::format("/proc/self/fd/{}", descriptor_), std::ios::binary);
  if (!stream && is_open()) stream = std::ifstream(path_, std::ios::binary);  // no /proc is mounted
  return stream;
}

}  // namespace ssdo
