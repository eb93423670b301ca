// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace ssdo::test {

/// Sets $SSDO_ISA while it lives.
class ChosenIsa {
 public:
  explicit ChosenIsa(const char* name);
  ~ChosenIsa();
  ChosenIsa(const ChosenIsa&) = delete;
  ChosenIsa& operator=(const ChosenIsa&) = delete;

 private:
  std::optional<std::string> before_;
};

/// Whether this machine has an instruction set.
bool has_isa(const char* name);

}  // namespace ssdo::test
