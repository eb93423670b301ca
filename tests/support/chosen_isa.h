// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error.h"
#include "simd/isa.h"

namespace ssdo::test {

/// Has vector loops run on an instruction set while it lives, and on the best one afterwards, as
/// they do in a test that chooses none.
class ChosenIsa {
 public:
  /// Errors: those of choose_isa().
  explicit ChosenIsa(const char* name) { choose_isa(name); }
  ~ChosenIsa() { choose_isa(""); }
  ChosenIsa(const ChosenIsa&) = delete;
  ChosenIsa& operator=(const ChosenIsa&) = delete;
};

/// Whether this processor has it. Ends what a ChosenIsa has chosen.
inline bool has_isa(const char* name) {
  try {
    const ChosenIsa isa(name);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace ssdo::test
