// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>

#include "io/files/safe_file.h"

namespace ssdo {

/// The temporary of a SafeFile, open for writing, with every write checked up to the last: a full
/// disk often shows only when the buffers are flushed. The first failure is final: every later call
/// reports it again, also to a caller whose library swallowed it.
/// Errors: ExitCode::output, naming the target.
class CheckedFile {
 public:
  explicit CheckedFile(const SafeFile& file);
  ~CheckedFile();
  CheckedFile(const CheckedFile&) = delete;
  CheckedFile& operator=(const CheckedFile&) = delete;

  void write(const void* bytes, std::size_t size);
  void seek(std::uint64_t position);
  std::uint64_t position() const { return position_; }

  /// Whether an earlier call has thrown.
  bool failed() const { return failure_ != 0; }

  /// Writes what is still buffered and closes.
  void close();

 private:
  void check(bool succeeded);

  std::string target_;
  std::FILE* file_ = nullptr;
  std::uint64_t position_ = 0;
  int failure_ = 0;  ///< errno of the first failure
};

}  // namespace ssdo
