// SPDX-License-Identifier: Apache-2.0
#include "io/files/safe_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <set>
#include <system_error>

#include "error.h"
#include "io/files/output_path.h"
#include "io/files/temporary_table.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

[[noreturn]] void fail(const fs::path& output, std::string_view what) {
  throw Error(ExitCode::output, fmt::format("{}: {}", output.string(), what));
}

std::string reason(int error) { return std::generic_category().message(error); }

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// A dangling link may lead to any folder: the file that it names is made only on request.
void check_dangling(const fs::path& path, const OutputPolicy& policy) {
  std::error_code ignored;
  if (policy.overwrite || !fs::is_symlink(path, ignored)) return;
  fail(path,
       fmt::format("is a symbolic link to '{}', which does not exist; give --overwrite to make "
                   "that file, or name another output",
                   fs::read_symlink(path, ignored).string()));
}

void check_existing(const fs::path& path, const OutputPolicy& policy) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return check_dangling(path, policy);
  if (!fs::status_known(status)) {
    fail(path, fmt::format("cannot be used: {}; name another output", error.message()));
  }
  if (fs::is_directory(status)) fail(path, "is a folder; name a file in it");
  if (!fs::is_regular_file(status)) {
    fail(path, "is a device, pipe or socket; outputs are renamed into place, so name a file");
  }
  if (!policy.overwrite) fail(path, "exists; give --overwrite to replace it");
  // The rename would succeed, but whoever protects a published frame means it.
  if (access(path.c_str(), W_OK) != 0) {
    fail(path, fmt::format("cannot be replaced: {}; change its permissions or name another output",
                           reason(errno)));
  }
}

void check_folder(const fs::path& path, const OutputPolicy& policy) {
  fs::path folder = folder_of(follow_links(path));
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) {
    if (!policy.create_dirs) {
      fail(path, fmt::format("its folder '{}' does not exist; make it or give --create-dirs",
                             folder.string()));
    }
    while (!fs::exists(folder, ignored)) folder = folder_of(folder);
  }
  if (!fs::is_directory(folder, ignored)) {
    fail(path, fmt::format("'{}' is a file, not a folder; name another output", folder.string()));
  }
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    fail(path, fmt::format("its folder '{}' cannot be written to: {}; change its permissions or "
                           "name another output",
                           folder.string(), reason(errno)));
  }
}

void create_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(folder_of(follow_links(path)), error);
  if (error) {
    fail(path, fmt::format("its folder cannot be made: {}; name another output", error.message()));
  }
}

// To the disk before the rename: after a power cut, the name must not stand for an empty file.
void flush_to_disk(const fs::path& file, const fs::path& target) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool flushed = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!flushed) {
    fail(target, fmt::format("cannot be written: {}; write elsewhere", reason(error)));
  }
}

// Best effort: not every network file system can flush a folder, and the data is safe already.
void flush_folder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

// Renames without replacing, in one step. Returns 0 or errno.
int rename_new(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // Network file systems lack that flag, but have hard links, which never replace either.
  if (link(from.c_str(), to.c_str()) != 0) return errno;
  unlink(from.c_str());
  return 0;
}

int rename_over(const fs::path& from, const fs::path& to) {
  return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

}  // namespace

void check_output(const fs::path& path, const OutputPolicy& policy) {
  if (!path.has_filename()) fail(path, "has no file name; name a file in the folder");
  check_existing(path, policy);
  check_folder(path, policy);
}

SafeFile::SafeFile(fs::path target, const OutputPolicy& policy)
    : target_(std::move(target)), policy_(policy) {
  check_output(target_, policy_);
  if (policy_.create_dirs) create_folder(target_);
  destination_ = follow_links(target_);
  temporary_ = temporary_beside(destination_);
  const TableInUse in_use;
  slot_ = enter_temporary(temporary_.c_str(), in_use);
  if (slot_ < 0)
    fail(target_, "cannot be opened: too many outputs are open, or its path is too long");
  const int descriptor = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int error = errno;
    leave_temporary(slot_, in_use);
    fail(target_, fmt::format("cannot be written: {}; write elsewhere", reason(error)));
  }
  close(descriptor);
}

SafeFile::~SafeFile() {
  if (!committed_) unlink(temporary_.c_str());
  leave_temporary(slot_, TableInUse());
}

void SafeFile::flush() {
  if (!flushed_) flush_to_disk(temporary_, target_);
  flushed_ = true;
}

void SafeFile::rename_into_place() {
  const int error = policy_.overwrite ? rename_over(temporary_, destination_)
                                      : rename_new(temporary_, destination_);
  if (error == EEXIST) {
    fail(target_, "appeared while it was being made; give --overwrite to replace it");
  }
  if (error) fail(target_, fmt::format("cannot be written: {}; write elsewhere", reason(error)));
  committed_ = true;
}

void SafeFile::commit() {
  flush();
  rename_into_place();
  flush_folder(folder_of(destination_));
}

void commit_all(const std::vector<std::unique_ptr<SafeFile>>& files) {
  for (const auto& file : files) file->flush();
  std::set<fs::path> folders;
  for (const auto& file : files) {
    file->rename_into_place();
    folders.insert(folder_of(file->destination_));
  }
  for (const fs::path& folder : folders) flush_folder(folder);
}

}  // namespace ssdo
