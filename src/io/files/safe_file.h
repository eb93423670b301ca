// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ssdo {

/// What an output may do to the file system.
struct OutputPolicy {
  bool overwrite = false;    ///< replace a file that exists
  bool create_dirs = false;  ///< make the folders of an output that has none
};

/// Throws ExitCode::output if `path` may not be written under `policy`: it exists, its folder
/// does not, it is a folder, or it cannot be written to. A symbolic link is written through, but
/// only under `overwrite`, also where it leads to nothing. Called before any work is done.
void check_output(const std::filesystem::path& path, const OutputPolicy& policy);

/// A file that appears complete or not at all. It is written under a temporary name in the folder
/// of its target (same file system, so that the rename is atomic) and renamed by `commit`. Without
/// a commit the temporary is removed, also when a signal that can be caught ends the process.
class SafeFile {
 public:
  SafeFile(std::filesystem::path target, const OutputPolicy& policy);
  ~SafeFile();
  SafeFile(const SafeFile&) = delete;
  SafeFile& operator=(const SafeFile&) = delete;

  const std::filesystem::path& target() const { return target_; }
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Flushes the temporary to disk. Errors: ExitCode::output; a full disk may show only now.
  void flush();

  /// Flushes the temporary, once, and gives it the target's name. Without `overwrite` a target
  /// that has appeared in the meantime is not replaced. Errors: ExitCode::output.
  void commit();

 private:
  friend void commit_all(const std::vector<std::unique_ptr<SafeFile>>& files);
  void rename_into_place();

  std::filesystem::path target_;
  std::filesystem::path destination_;  ///< the file that a link at `target_` led to at the start
  std::filesystem::path temporary_;
  OutputPolicy policy_;
  int slot_ = -1;
  bool flushed_ = false, committed_ = false;
};

/// Commits files that belong together. All are flushed to disk before the first is renamed, and no
/// rename waits for a disk: a process that is killed leaves all or none, but for an instant.
void commit_all(const std::vector<std::unique_ptr<SafeFile>>& files);

}  // namespace ssdo
