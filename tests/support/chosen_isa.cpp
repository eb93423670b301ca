// SPDX-License-Identifier: Apache-2.0
#include "support/chosen_isa.h"

#include <cstdlib>

#include "error.h"
#include "simd/isa.h"

namespace ssdo::test {

ChosenIsa::ChosenIsa(const char* name) {
  if (const char* before = std::getenv("SSDO_ISA")) before_ = before;
  setenv("SSDO_ISA", name, 1);
}

ChosenIsa::~ChosenIsa() {
  before_ ? setenv("SSDO_ISA", before_->c_str(), 1) : unsetenv("SSDO_ISA");
  choose_isa();
}

bool has_isa(const char* name) {
  const ChosenIsa isa(name);
  try {
    return choose_isa() == name;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace ssdo::test
