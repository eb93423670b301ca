// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace ssdo {

/// What an output may do to the file system.
struct OutputPolicy {
  bool overwrite = false;    ///< replace a file that exists
  bool create_dirs = false;  ///< make the folders of an output that has none
};

/// Throws ExitCode::output if `path` may not be written under `policy`: it exists, its folder
/// does not, it is a folder, or it cannot be written to. Called before any work is done.
void check_output(const std::filesystem::path& path, const OutputPolicy& policy);

/// A file that appears complete or not at all. It is written under a temporary name in the folder
/// of its target (same file system, so that the rename is atomic) and renamed by `commit`. Without
/// a commit the temporary is removed, also when SIGINT or SIGTERM ends the process.
class SafeFile {
 public:
  SafeFile(std::filesystem::path target, const OutputPolicy& policy);
  ~SafeFile();
  SafeFile(const SafeFile&) = delete;
  SafeFile& operator=(const SafeFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Flushes the temporary to disk and gives it the target's name. Without `overwrite` a target
  /// that has appeared in the meantime is not replaced. Errors: ExitCode::output.
  void commit();

 private:
  std::filesystem::path target_, temporary_;
  OutputPolicy policy_;
  int slot_ = -1;
  bool committed_ = false;
};

/// Installs handlers for SIGINT and SIGTERM that remove every open temporary and end the process
/// with 130 or 143, and ignores SIGXFSZ and SIGPIPE so that a full disk arrives as a write error.
void remove_temporaries_on_signals();

}  // namespace ssdo
