// SPDX-License-Identifier: Apache-2.0
#include "support/chosen_isa.h"

#include "error.h"
#include "simd/isa.h"

namespace ssdo::test {

ChosenIsa::ChosenIsa(const char* name) { choose_isa(name); }

ChosenIsa::~ChosenIsa() { choose_isa(""); }

bool has_isa(const char* name) {
  try {
    const ChosenIsa isa(name);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace ssdo::test
