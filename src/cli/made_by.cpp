// SPDX-License-Identifier: Apache-2.0
#include "cli/made_by.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <array>

#include "bench/command.h"

namespace ssdo {
namespace {

/// The name behind the effective user id: variables such as $USER survive sudo, or are missing on
/// farms.
std::string user_name() {
  passwd entry{};
  passwd* found = nullptr;
  std::array<char, 4096> text{};
  getpwuid_r(geteuid(), &entry, text.data(), text.size(), &found);
  return found ? found->pw_name : "unknown";
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 && name[0] ? name.data() : "unknown";
}

}  // namespace

std::string made_by(std::span<const char* const> command_line) {
  std::string out = fmt::format("{}@{}:", user_name(), host_name());
  for (const char* word : command_line) out += " " + shell_word(word);
  return out;
}

}  // namespace ssdo
