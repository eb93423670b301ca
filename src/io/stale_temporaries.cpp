// SPDX-License-Identifier: Apache-2.0
#include "io/stale_temporaries.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <string>
#include <system_error>

#include "io/output_path.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

bool is_temporary(const fs::path& file, const std::string& mark) {
  const std::string name = file.filename().string();
  return name.starts_with('.') && name.find(mark + '-') != std::string::npos &&
         file.stem().extension() == ".tmp";
}

/// Removes a file that can be locked: whoever made it no longer lives.
bool remove_unlocked(const fs::path& file) {
  // Network file systems lock only what is open for writing; a pipe of that name must not block.
  const int descriptor = open(file.c_str(), O_RDWR | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool removed = flock(descriptor, LOCK_EX | LOCK_NB) == 0 && unlink(file.c_str()) == 0;
  close(descriptor);
  return removed;
}

}  // namespace

std::vector<fs::path> remove_stale_temporaries(const fs::path& folder) {
  std::vector<fs::path> removed;
  const std::string mark = mark_of_machine();
  if (mark.empty()) return removed;
  std::error_code error;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
       it.increment(error)) {
    if (is_temporary(it->path(), mark) && remove_unlocked(it->path()))
      removed.push_back(it->path());
  }
  return removed;
}

}  // namespace ssdo
