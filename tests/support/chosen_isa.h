// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include "error.h"
#include "simd/isa.h"

namespace ssdo::test {

/// Sets $SSDO_ISA while it lives.
class ChosenIsa {
 public:
  explicit ChosenIsa(const char* name) {
    if (const char* before = std::getenv("SSDO_ISA")) before_ = before;
    setenv("SSDO_ISA", name, 1);
  }
  ~ChosenIsa() {
    before_ ? setenv("SSDO_ISA", before_->c_str(), 1) : unsetenv("SSDO_ISA");
    choose_isa();
  }
  ChosenIsa(const ChosenIsa&) = delete;
  ChosenIsa& operator=(const ChosenIsa&) = delete;

 private:
  std::optional<std::string> before_;
};

inline bool has_isa(const char* name) {
  const ChosenIsa isa(name);
  try {
    return choose_isa() == name;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace ssdo::test
