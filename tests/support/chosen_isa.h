// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo::test {

/// The instruction sets other than one lane; a processor has some of them.
inline constexpr const char* kVectorIsas[] = {"neon", "avx2", "avx512"};
inline constexpr const char* kIsas[] = {"scalar", "neon", "avx2", "avx512"};

/// Has vector loops run on an instruction set while it lives, and on the best one afterwards, as
/// they do in a test that chooses none.
class ChosenIsa {
 public:
  /// Errors: those of choose_isa().
  explicit ChosenIsa(const char* name);
  ~ChosenIsa();
  ChosenIsa(const ChosenIsa&) = delete;
  ChosenIsa& operator=(const ChosenIsa&) = delete;
};

/// Whether this processor has it. Ends what a ChosenIsa has chosen.
bool has_isa(const char* name);

}  // namespace ssdo::test
