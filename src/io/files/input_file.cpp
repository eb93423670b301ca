// SPDX-License-Identifier: Apache-2.0
#include "io/files/input_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>
#include <utility>

#include "error.h"

namespace ssdo {

/// Does not block where a pipe has taken the place of a file.
InputFile::InputFile(std::filesystem::path path)
    : path_(std::move(path)), descriptor_(open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}

InputFile::~InputFile() {
  if (is_open()) close(descriptor_);
}

std::uint64_t InputFile::bytes() const {
  struct stat status = {};
  return fstat(descriptor_, &status) == 0 ? std::uint64_t(status.st_size) : 0;
}

std::size_t InputFile::read(std::uint64_t place, std::span<std::byte> to) const {
  constexpr auto kEnd = std::uint64_t(std::numeric_limits<off_t>::max());  // of the largest file
  to = to.first(std::min(to.size(), kEnd - std::min(place, kEnd)));
  std::size_t done = 0;
  while (done < to.size()) {
    const ssize_t count =
        pread(descriptor_, to.data() + done, to.size() - done, off_t(place + done));
    if (count == 0) break;
    if (count > 0) {
      done += std::size_t(count);
    } else if (errno != EINTR) {
      throw Error(
          ExitCode::input,
          fmt::format("{}: cannot be read at byte {}: {}; check its disk or network",
                      path_.string(), place + done, std::generic_category().message(errno)));
    }
  }
  return done;
}

InputStream::Buffer::int_type InputStream::Buffer::underflow() {
  const std::size_t count = file_.read(next_, std::as_writable_bytes(std::span(bytes_)));
  next_ += count;
  setg(bytes_.data(), bytes_.data(), bytes_.data() + count);
  return count == 0 ? traits_type::eof() : traits_type::to_int_type(bytes_[0]);
}

/// After the bytes in the buffer, a large read goes directly into `to`.
std::streamsize InputStream::Buffer::xsgetn(char* to, std::streamsize count) {
  const auto here = std::min(count, std::streamsize(egptr() - gptr()));
  std::copy_n(gptr(), here, to);
  setg(eback(), gptr() + here, egptr());
  if (count - here < std::streamsize(bytes_.size()))
    return count == here ? here : here + std::streambuf::xsgetn(to + here, count - here);
  setg(nullptr, nullptr, nullptr);
  const std::size_t more =
      file_.read(next_, std::as_writable_bytes(std::span(to + here, std::size_t(count - here))));
  next_ += more;
  return here + std::streamsize(more);
}

InputStream::Buffer::pos_type InputStream::Buffer::seekoff(off_type by, std::ios::seekdir from,
                                                           std::ios::openmode mode) {
  const auto here = off_type(next_) - off_type(egptr() - gptr());
  if (from == std::ios::cur && by == 0) return here;
  const off_type start = from == std::ios::beg   ? 0
                         : from == std::ios::cur ? here
                                                 : off_type(file_.bytes());
  return seekpos(start + by, mode);
}

InputStream::Buffer::pos_type InputStream::Buffer::seekpos(pos_type to, std::ios::openmode) {
  if (to < 0) return off_type(-1);
  const off_type back = off_type(next_) - off_type(to);
  if (back >= 0 && back <= egptr() - eback()) {
    setg(eback(), egptr() - back, egptr());
  } else {
    setg(nullptr, nullptr, nullptr);
    next_ = std::uint64_t(off_type(to));
  }
  return to;
}

}  // namespace ssdo
