// SPDX-License-Identifier: Apache-2.0
#include "io/files/stale_temporaries.h"

#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <optional>
#include <string>
#include <system_error>

#include "io/files/output_path.h"

namespace fs = std::filesystem;

namespace ssdo {
namespace {

/// The process that made a temporary with the mark of this machine; none for other files.
std::optional<pid_t> owner_of(const fs::path& file, const std::string& mark) {
  const std::string name = file.filename().string();
  const std::size_t place = name.find(mark + '-');
  if (!name.starts_with('.') || place == std::string::npos || file.stem().extension() != ".tmp")
    return std::nullopt;
  pid_t owner = 0;
  const char* digits = name.data() + place + mark.size() + 1;
  const auto [end, error] = std::from_chars(digits, name.data() + name.size(), owner);
  return error == std::errc() && *end == '-' && owner > 0 ? std::optional(owner) : std::nullopt;
}

bool is_gone(pid_t process) { return kill(process, 0) != 0 && errno == ESRCH; }

}  // namespace

std::vector<fs::path> remove_stale_temporaries(const fs::path& folder) {
  std::vector<fs::path> removed;
  const std::string mark = mark_of_machine();
  if (mark.empty()) return removed;
  std::error_code error;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end;
       it.increment(error)) {
    const auto owner = owner_of(it->path(), mark);
    if (owner && is_gone(*owner) && unlink(it->path().c_str()) == 0) removed.push_back(it->path());
  }
  return removed;
}

}  // namespace ssdo
